// Icons, and pictures of the panel for people to look at, with what must hold on any screen.
#include <gtest/gtest.h>
#include <QApplication>
#include <QDir>
#include <QImage>
#include <QPalette>

#include <filesystem>
#include <memory>
#include <set>
#include <vector>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "palpate/run/source.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

constexpr int count = static_cast<int>(Shape::whole) + 1;

QImage picture_of(Shape shape) {
    return icon_of(shape).pixmap(24, 24).toImage().convertToFormat(
        QImage::Format_ARGB32_Premultiplied);
}

TEST(Icons, are_all_different_and_neither_empty_nor_full) {
    std::set<std::vector<uchar>> pictures;
    for (int i = 0; i < count; ++i) {
        const QImage picture = picture_of(static_cast<Shape>(i));
        double covered = 0;
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) covered += qAlpha(picture.pixel(x, y)) > 128;
        }
        covered /= picture.width() * picture.height();
        EXPECT_GT(covered, 0.06) << i;
        EXPECT_LT(covered, 0.6) << i;
        pictures.emplace(picture.constBits(), picture.constBits() + picture.sizeInBytes());
    }
    EXPECT_EQ(pictures.size(), std::size_t{count});
}

/// In the left bar of the sign for a pause.
QColor colour_of(const QIcon& icon, QIcon::Mode mode) {
    const QImage picture = icon.pixmap(48, 48, mode).toImage();
    return picture.pixelColor(picture.width() * 3 / 10, picture.height() / 2);
}

TEST(Icons, have_the_colour_of_text_at_the_time_when_they_are_painted) {
    const QPalette before = QApplication::palette();
    const QIcon icon = icon_of(Shape::pause);
    for (const QColor& ink : {QColor(250, 250, 250), QColor(10, 20, 30)}) {
        QPalette palette = before;
        palette.setColor(QPalette::Active, QPalette::ButtonText, ink);
        palette.setColor(QPalette::Disabled, QPalette::ButtonText, Qt::red);
        QApplication::setPalette(palette);
        EXPECT_EQ(colour_of(icon, QIcon::Normal), ink);
        EXPECT_EQ(colour_of(icon, QIcon::Disabled), Qt::red);
    }
    QApplication::setPalette(before);
}

QPalette dark_palette() {
    QPalette dark;
    dark.setColor(QPalette::Window, QColor(45, 45, 48));
    dark.setColor(QPalette::WindowText, QColor(230, 230, 230));
    dark.setColor(QPalette::Base, QColor(28, 28, 30));
    dark.setColor(QPalette::AlternateBase, QColor(45, 45, 48));
    dark.setColor(QPalette::Text, QColor(230, 230, 230));
    dark.setColor(QPalette::Button, QColor(58, 58, 62));
    dark.setColor(QPalette::ButtonText, QColor(230, 230, 230));
    dark.setColor(QPalette::ToolTipBase, QColor(58, 58, 62));
    dark.setColor(QPalette::ToolTipText, QColor(230, 230, 230));
    dark.setColor(QPalette::PlaceholderText, QColor(150, 150, 150));
    dark.setColor(QPalette::Highlight, QColor(42, 130, 218));
    dark.setColor(QPalette::HighlightedText, Qt::white);
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText}) {
        dark.setColor(QPalette::Disabled, role, QColor(120, 120, 120));
    }
    return dark;
}

class Pictures : public PanelFixture {
  protected:
    Pictures() { usual_ = QApplication::palette(); }
    ~Pictures() override { QApplication::setPalette(usual_); }

    void full(Solid solid = Solid::above) {
        RendererSettings settings;
        const DensityRange ranges[] = {{-400, 150}, {700, 1500}};
        settings.penetrability = penetrability_ranges(1.5, ranges, solid);
        settings.proxy.friction = {0.4, 0.2};
        set(settings, 300, solid);
        Look look;
        look.transfer = preset("CT bone", histogram, field->volume());
        panel.look_controls().set_look(look);
        panel.device_controls().list(
            {{"simulated", true, "a haptic device and its hand, computed", "", "seed=1"},
             {"mouse", true, "pointer and keys", "", "speed=600 [mm/s]"},
             {"haply", false, "", "no Inverse Service at localhost:10001", "port=10001"}});
        Snapshot now;
        now.session.tick.force = Vec3(1.2, 0, 1);
        now.session.tick.proxy.isovalue = 820;
        now.session.tick.proxy.mode = Mode::constrained;
        now.session.tick.proxy.hip = Vec3(1, 0, 0);
        now.session.transform.scale = 1.8;
        now.session.device.status = DeviceStatus::ready;
        now.session.tick.force_flags = force_ramping;
        now.penetrability_on = true;
        effect.observe(now);
        ServoReport report;
        report.ticks = 20000;
        report.missed = 2;
        report.lateness = {20000, 11000, 45000, 120000, 2300000};
        report.compute = {20000, 900, 4100, 7000, 31000};
        report.worst = {77, 2300000, 30000, 21000, TickCause::machine};
        panel.loop_view().show_report(report, 999.8);
        QApplication::processEvents();
    }

    /// The whole panel, as high as it likes to be.
    QImage picture(const QString& name) {
        panel.resize(panel.width(), panel.sizeHint().height() + 10);
        QApplication::processEvents();
        const QImage image = panel.grab().toImage();
        QDir().mkpath(PALPATE_PICTURES);
        const QString scale = image.devicePixelRatio() > 1.5 ? "_2x" : "";
        EXPECT_TRUE(image.save(QString(PALPATE_PICTURES) + "/" + name + scale + ".png"));
        return image;
    }

  private:
    QPalette usual_;
};

TEST_F(Pictures, show_a_session_in_light_colours) {
    full();
    picture("panel_light");
}

TEST_F(Pictures, show_a_session_in_dark_colours) {
    QApplication::setPalette(dark_palette());
    full();
    picture("panel_dark");
}

TEST_F(Pictures, show_each_page) {
    full();
    auto& tabs = *find<QTabWidget>("tabs");
    for (int page = 0; page < tabs.count(); ++page) {
        tabs.setCurrentIndex(page);
        QApplication::processEvents();
        const QWidget& shown = *static_cast<QScrollArea*>(tabs.widget(page))->widget();
        EXPECT_LE(shown.minimumSizeHint().width(), tabs.width()) << page;
        picture(QString("panel_page_%1").arg(page + 1));
    }
}

TEST_F(Pictures, show_every_row_of_the_force) {
    const std::unique_ptr<Form> form(force_section(effect));
    QWidget& rows = *form;
    full();
    rows.findChild<Section*>("force_advanced")->set_open(true);
    rows.resize(440, rows.sizeHint().height());
    rows.show();
    QApplication::processEvents();
    rows.resize(440, rows.sizeHint().height());
    QDir().mkpath(PALPATE_PICTURES);
    EXPECT_TRUE(rows.grab().save(PALPATE_PICTURES "/force_rows.png"));
    for (const NumberBox* box : rows.findChildren<NumberBox*>()) {
        const int wanted = box->fontMetrics().horizontalAdvance(box->text());
        EXPECT_GT(box->width(), wanted) << box->objectName().toStdString();
    }
}

TEST_F(Pictures, show_a_narrow_panel_with_a_threshold_and_refusals) {
    full();
    type("stiffness_box", "99");
    DeviceInfo info = desktop_device();
    panel.device_controls().show_device(info, DeviceStatus::uncalibrated,
                                        "Put the handle into its holder once.");
    press("forces");
    panel.resize(panel.minimumSizeHint().width() + 4, 1700);
    EXPECT_LE(panel.minimumSizeHint().width(), 26 * panel.fontMetrics().height());
    QApplication::processEvents();
    picture("panel_narrow");
}

TEST_F(Pictures, real_volumes_get_a_preset_that_shows_something) {
    for (const std::string name : {"cthead_unc", "lobster", "daisy_pollen", "neuron_confocal"}) {
        SCOPED_TRACE(name);
        const std::string file = std::string(PALPATE_DATA_FOLDER) + "/" + name + ".nrrd";
        if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
        field.emplace(run::load(run::source_named(file)).volume);
        histogram = run::histogram_of(field->volume(), 256);
        const double isovalue = run::suggested_isovalues(histogram).front();
        begin(*field, isovalue);
        Look look;
        look.volume = true;
        look.transfer =
            preset(suggested_preset(histogram, field->volume()), histogram, field->volume());
        panel.look_controls().set_look(look);
        // Air is clear, the brightest is not.
        EXPECT_EQ(sampled(look.transfer, field->volume().minimum()).opacity, 0);
        EXPECT_GT(sampled(look.transfer, field->volume().maximum()).opacity, 0.3);
        picture("panel_" + QString::fromStdString(name));
    }
}

TEST_F(Pictures, show_a_panel_without_a_volume) {
    picture("panel_empty");
}

}  // namespace
}  // namespace palpate::viewer
