// Numbers that are typed into the window, with a decimal point or a decimal comma.
#include <QAbstractSpinBox>
#include <QDialog>
#include <QPushButton>
#include <QToolTip>

#include <limits>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/window/open_dialogs.hpp"
#include "apps/viewer/window/preferences.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

/// Types over what is there, and stays in the box.
void type_over(QWidget& box, const QString& text) {
    box.setFocus();
    QTest::keyClick(&box, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(&box, text);
}

class Numbers : public InWindow {
  protected:
    /// A volume whose file has no spacing.
    void feel_without_spacing() {
        std::ofstream out(scratch_.path() / "a.nrrd", std::ios::binary);
        out << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 20 24 28\nencoding: raw\n\n";
        for (int i = 0; i < 20 * 24 * 28; ++i) out.put(char(i % 20 * 6));
        out.close();
        feel(scratch("a.nrrd").toStdString());
    }
    /// All dialogs with numbers, which the window owns.
    void make_dialogs() {
        make_raw_dialog("/data/a.raw", window_.get(), {});
        make_grid_dialog({}, {}, window_.get(), {});
        make_store_dialog(std::nullopt, 0, window_.get(), {});
        make_preferences_dialog({}, window_.get(), [](const Preferences&) {});
    }
};

TEST_F(Numbers, with_a_decimal_comma_mean_what_they_say) {
    feel_without_spacing();
    for (const char* name : {"isovalue_box", "brush_radius_box", "scale"}) {
        auto& box = on_page<NumberBox>(name);
        type_over(box, "4,5");
        QTest::keyClick(&box, Qt::Key_Return);
        EXPECT_EQ(box.value(), 4.5) << name;
    }
    EXPECT_EQ(window_->content().effect().isovalue(), 4.5);
    QTest::mouseClick(&part<QPushButton>("missing_grid"), Qt::LeftButton);
    activate(part<QDialog>("grid"));
    auto& spacing = part<NumberBox>("grid_spacing_X");
    type_over(spacing, "0,5");
    QTest::keyClick(&spacing, Qt::Key_Tab);
    QTest::keyClick(&part<QDialog>("grid"), Qt::Key_Return);
    wait_until([&] { return window_->live() && window_->settled(); });
    wait_until([&] { return window_->live()->field().geometry().measured; });
    EXPECT_EQ(window_->live()->field().geometry().spacing, Vec3(0.5, 1, 1));
}

TEST_F(Numbers, that_may_be_thousands_or_decimals_are_refused_with_a_note) {
    feel("synthetic:sphere:24x24x24");
    auto& box = on_page<NumberBox>("isovalue_box");
    const double before = box.value();
    type_over(box, "1,250");
    QTest::keyClick(&box, Qt::Key_Return);
    EXPECT_EQ(box.value(), before);
    EXPECT_EQ(window_->content().effect().isovalue(), before);
    EXPECT_EQ(QToolTip::text(), "1,250 can be read in two ways: type 1250 or 1.250");
    type_over(box, "1.250");
    QTest::keyClick(&box, Qt::Key_Return);
    EXPECT_EQ(box.value(), 1.25);
}

TEST_F(Numbers, take_a_comma_and_no_groups_in_every_box_of_the_window) {
    feel("synthetic:sphere:24x24x24");
    make_dialogs();
    int typed = 0;
    for (auto* any : window_->findChildren<QAbstractSpinBox*>()) {
        SCOPED_TRACE(any->objectName().toStdString());
        auto* box = qobject_cast<NumberBox*>(any);
        ASSERT_NE(box, nullptr) << "another kind of box";
        if (!box->isEnabled()) continue;
        ++typed;
        const double before = box->value();
        type_over(*box, "0,25");
        EXPECT_TRUE(box->hasAcceptableInput());
        EXPECT_EQ(box->valueFromText(box->text()), 0.25);
        // A sign that is left out could make another number of the others.
        for (const char* text : {"1,234.5", "1.234,5", "1.2.3", "1,2,3"}) {
            type_over(*box, text);
            EXPECT_TRUE(box->text().startsWith(text)) << box->text().toStdString();
            EXPECT_FALSE(box->hasAcceptableInput()) << text;
        }
        box->interpretText();
        EXPECT_EQ(box->value(), before) << "what is no number changes nothing";
    }
    EXPECT_GT(typed, 12);
}

}  // namespace
}  // namespace palpate::viewer::test
