// Layers in the window: choosing a set, feeling it in one stroke, changing it, saving it.
#include <QAbstractItemView>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QTabWidget>
#include <set>

#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/stroke_plot.hpp"
#include "apps/viewer/window/isovalue_controls.hpp"
#include "apps/viewer/window/layers_controls.hpp"
#include "apps/viewer/window/menus.hpp"
#include "palpate/io/sample_volume.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

constexpr const char* ct_set = "Soft tissue and bone (CT)";
constexpr const char* head_set = "Skin and bone of the head that comes with Palpate";

/// Soft tissue round bone, in air [HU].
Volume ct_ball() {
    constexpr int n = 48;
    Geometry geometry;
    geometry.size = {n, n, n};
    geometry.origin = Vec3::Constant(-0.5 * (n - 1));
    std::vector<std::int16_t> samples;
    for (int k = 0; k < n; ++k) {
        for (int j = 0; j < n; ++j) {
            for (int i = 0; i < n; ++i) {
                const double r = (Vec3(i, j, k) + geometry.origin).norm();
                const auto step = [r](double radius) {
                    return std::clamp(radius - r + 0.5, 0.0, 1.0);
                };
                samples.push_back(
                    static_cast<std::int16_t>(-1000 + 1040 * step(20) + 960 * step(12)));
            }
        }
    }
    return Volume(geometry, samples);
}

/// Step of the wheel: a whole notch of a narrow scene may go through the skin at once.
constexpr int finely = 40;

class LayersInWindow : public InWindow {
  protected:
    void feel_ct() {
        io::write_volume(ct_ball(), scratch_.path() / "ct.nrrd");
        feel((scratch_.path() / "ct.nrrd").string());
    }
    /// By mouse, from the list that drops down.
    void pick(const char* set) {
        auto& box = part<QComboBox>("layers");
        const int row = box.findText(set);
        ASSERT_GE(row, 0);
        // A list takes no click within this time after it dropped down.
        const int interval = QApplication::doubleClickInterval();
        QApplication::setDoubleClickInterval(0);
        QTest::mouseClick(&box, Qt::LeftButton);
        wait_until([&] { return box.view()->isVisible(); });
        QApplication::processEvents();
        const QRect at = box.view()->visualRect(box.model()->index(row, 0));
        QTest::mouseMove(box.view()->viewport(), at.center());
        QTest::mouseClick(box.view()->viewport(), Qt::LeftButton, {}, at.center());
        wait_until([&] { return !box.view()->isVisible(); });
        QApplication::setDoubleClickInterval(interval);
    }
    SharedLayers layers() { return window_->live()->settings().layers; }
    LayersControls& controls() { return window_->panel().layers_controls(); }
};

TEST_F(LayersInWindow, a_ct_is_opened_a_set_is_picked_and_both_layers_are_felt_in_one_stroke) {
    io::write_volume(ct_ball(), scratch_.path() / "ct.nrrd");
    type_in_dialog(Qt::Key_O, scratch("ct.nrrd"));
    wait_until([&] { return window_->live() && window_->settled(); });
    pick(ct_set);
    ASSERT_TRUE(layers());
    EXPECT_EQ(layers()->name, ct_set);
    EXPECT_TRUE(part<QLabel>("layers_note").text().contains("HU"))
        << "the file does not say its units";
    std::set<std::string> touched;
    EXPECT_TRUE(press_until(
        [&] {
            const LayersFelt felt = now().session.tick.layers;
            if (felt.touched >= 0) touched.insert(layers()->layers[std::size_t(felt.touched)].name);
            return felt.touched == 1 && force() > 0.3;
        },
        finely));
    EXPECT_EQ(touched, (std::set<std::string>{"skin", "bone"}));
    wait_until([&] {
        return part<QLabel>("touched_layers").text() == "on bone, in skin" &&
               part<QLabel>("readout").text().startsWith("on bone, in skin");
    });
    const auto& points = part<StrokePlot>("stroke_plot").stroke().points();
    std::set<int> plotted;
    for (const Stroke::Point& point : points) plotted.insert(point.layer);
    EXPECT_TRUE(plotted.count(0) && plotted.count(1));
    wait_until_settled();
    save("felt");
    QTest::mouseClick(&part<QPushButton>("clear_stroke"), Qt::LeftButton);
    EXPECT_LE(points.size(), 2U);
}

using DrawnLayers = LayersInWindow;

TEST_F(DrawnLayers, the_built_in_head_shows_skin_as_glass_over_bone) {
    feel(io::sample_volume_path().string());
    const double before = window_->live()->isovalue();
    pick(head_set);
    ASSERT_TRUE(layers());
    EXPECT_FALSE(part<QLabel>("layers_note").isVisible());
    wait_until_settled();
    EXPECT_EQ(window_->views().shown().isovalue, layers()->layers[0].level);
    const QImage image = window_->views().scene().picture();
    EXPECT_FALSE(image.isNull());
    save("head");
    EXPECT_FALSE(part<QWidget>("isovalue_box").isEnabled());
    pick("No layers: one surface");
    EXPECT_FALSE(layers());
    EXPECT_TRUE(part<QWidget>("isovalue_box").isEnabled());
    wait_until([&] { return window_->views().shown().isovalue == before; });
    EXPECT_EQ(window_->live()->isovalue(), before);
}

TEST_F(LayersInWindow, a_level_is_dragged_on_the_histogram_while_one_feels) {
    feel_ct();
    pick(ct_set);
    ASSERT_TRUE(layers());
    wait_until_settled();  // the list of layers needs room
    LevelChart& chart = window_->panel().isovalue_controls().chart();
    const LevelAxis axis = chart.axis();
    const double y = chart.strip().top() - 20;
    const auto at = [&](double level) { return QPointF(axis.x_of(level), y).toPoint(); };
    drag(chart, at(250), at(500));
    wait_until([&] { return std::abs(layers()->layers[1].level - 500) < 20; });
    EXPECT_EQ(layers()->layers[0].level, -300);
    EXPECT_EQ(part<QListWidget>("layer_list").currentRow(), 1) << "the one that was taken";
    drag(chart, at(layers()->layers[1].level), at(-900));
    wait_until([&] { return layers()->layers[1].level < 0; });
    EXPECT_GT(layers()->layers[1].level, -300) << "it cannot pass its neighbour";
    const auto order = layers();
    EXPECT_NO_THROW(check(*order, Solid::above));
    QTest::mouseClick(&part<QPushButton>("undo_layers"), Qt::LeftButton);
    EXPECT_NEAR(layers()->layers[1].level, 500, 20);
    QTest::mouseClick(&part<QPushButton>("undo_layers"), Qt::LeftButton);
    ASSERT_TRUE(layers());
    EXPECT_EQ(layers()->layers[1].level, 250);
    QTest::mouseClick(&part<QPushButton>("redo_layers"), Qt::LeftButton);
    EXPECT_NEAR(layers()->layers[1].level, 500, 20);
}

TEST_F(LayersInWindow, a_changed_set_goes_to_a_file_and_into_the_session_and_comes_back) {
    feel_ct();
    pick(ct_set);
    auto& name = part<QLineEdit>("layer_name");
    name.selectAll();
    QTest::keyClicks(&name, "hide");
    QTest::keyClick(&name, Qt::Key_Return);
    wait_until([&] { return layers()->layers[0].name == "hide"; });
    typing(scratch("own.json"),
           [&] { QTest::mouseClick(&part<QPushButton>("save_layers"), Qt::LeftButton); });
    const io::LayersFile file = io::read_layers(scratch("own.json").toStdString());
    EXPECT_EQ(file.layers.layers[0].name, "hide");
    EXPECT_FALSE(file.about.empty());
    window_->files().save_session(scratch("s.json"));
    const SharedLayers saved = layers();
    window_->files().open_path(QString::fromStdString((scratch_.path() / "ct.nrrd").string()));
    wait_until([&] { return window_->live() && !layers(); });
    wait_until_settled();
    window_->files().open_path(scratch("s.json"));
    wait_until([&] { return window_->live() && layers(); });
    EXPECT_TRUE(same(layers(), saved));
    wait_until_settled();
    EXPECT_EQ(part<QComboBox>("layers").currentText(), QString(ct_set) + " (changed)");
    pick("No layers: one surface");
    typing(scratch("own.json"),
           [&] { QTest::mouseClick(&part<QPushButton>("open_layers"), Qt::LeftButton); });
    wait_until([&] { return layers() != nullptr; });
    EXPECT_EQ(layers()->layers[0].name, "hide");
}

TEST_F(LayersInWindow, that_were_changed_are_not_lost_without_a_question) {
    feel_ct();
    pick(ct_set);
    wait_until_settled();
    EXPECT_FALSE(controls().unsaved()) << "the set is in a file";
    QTest::mouseClick(&part<QPushButton>("add_layer"), Qt::LeftButton);
    wait_until_settled();
    answer(QMessageBox::Cancel);
    EXPECT_FALSE(window_->close());
    answer(QMessageBox::Save);
    typing(scratch("case.json"), [&] { EXPECT_FALSE(window_->close()) << "it is saved first"; });
    wait_until([&] { return !window_->isVisible(); });
    EXPECT_EQ(read_session(scratch("case.json").toStdString()).settings->layers->layers.size(), 3U);
}

TEST_F(LayersInWindow, a_recording_names_the_layers_that_were_felt) {
    feel_ct();
    pick(ct_set);
    wait_until_settled();
    record("a.csv");
    ASSERT_TRUE(press_until([&] { return now().session.tick.layers.touched == 0; }, finely));
    stop_recording();
    window_->files().open_path(scratch("a.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_EQ(window_->playback()->different(), 0U);
    window_->playing().show_time(window_->playback()->end());
    // The words may still be those of the session before.
    wait_until([&] { return window_->views().shown().isovalue == -300; });
    wait_until([&] { return part<QLabel>("readout").text().contains("on skin"); });
    press(Qt::Key_Escape);
    wait_until([&] { return window_->live() && layers(); });  // felt again, with them
    EXPECT_EQ(part<QComboBox>("layers").currentText(), ct_set);
}

TEST_F(LayersInWindow, of_the_command_line_are_for_the_first_volume) {
    io::write_volume(ct_ball(), scratch_.path() / "ct.nrrd");
    run::Setup setup = setup_with("mouse");
    setup.render.layers = io::layers_named("ct-soft-tissue-and-bone");
    open_window(setup);
    feel((scratch_.path() / "ct.nrrd").string());
    ASSERT_TRUE(layers());
    EXPECT_EQ(part<QComboBox>("layers").currentText(), ct_set);
    feel("synthetic:sphere:48x48x48");
    wait_until([&] { return window_->live() && !layers(); });
}

TEST_F(LayersInWindow, for_ct_are_not_offered_for_data_that_look_like_none) {
    feel("synthetic:sphere:48x48x48");
    const auto& box = part<QComboBox>("layers");
    const int row = box.findText(ct_set);
    EXPECT_FALSE(box.model()->index(row, 0).flags() & Qt::ItemIsEnabled);
    EXPECT_TRUE(box.itemData(row, Qt::ToolTipRole).toString().contains("Hounsfield"));
}

TEST_F(LayersInWindow, sets_that_do_not_suit_the_solid_side_cannot_be_picked) {
    feel_ct();
    auto& box = part<QComboBox>("layers");
    const auto possible = [&](const char* set) {
        return bool(box.model()->index(box.findText(set), 0).flags() & Qt::ItemIsEnabled);
    };
    EXPECT_TRUE(possible(ct_set));
    window_->content().use_field(Solid::below, Interpolation::cubic);
    EXPECT_FALSE(possible(ct_set));
}

}  // namespace
}  // namespace palpate::viewer::test
