// Layers in the window, and controllers by themselves, without the window.
#include <gtest/gtest.h>
#include <QAbstractItemView>
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QMessageBox>
#include <QPushButton>
#include <QRegularExpression>
#include <QTabWidget>
#include <QtTest>

#include <atomic>
#include <cmath>
#include <set>
#include <stdexcept>

#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/isovalue_controls.hpp"
#include "apps/viewer/panel/layer_editor.hpp"
#include "apps/viewer/panel/layers_controls.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/edit_controller.hpp"
#include "apps/viewer/window/menus.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/recording_controller.hpp"
#include "palpate/io/sample_volume.hpp"
#include "support/scratch_folder.hpp"
#include "viewer/waiting.hpp"
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

/// Of the wheel: a whole notch of a narrow scene may go through the skin at once.
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
    EXPECT_EQ(window_->display().isovalue(), layers()->layers[0].level);
    const QImage image = window_->views().scene().picture();
    EXPECT_FALSE(image.isNull());
    save("head");
    EXPECT_FALSE(part<QWidget>("isovalue_box").isEnabled());
    pick("No layers: one surface");
    EXPECT_FALSE(layers());
    EXPECT_TRUE(part<QWidget>("isovalue_box").isEnabled());
    wait_until([&] { return window_->display().isovalue() == before; });
    EXPECT_EQ(window_->live()->isovalue(), before);
}

TEST_F(LayersInWindow, a_level_is_dragged_on_the_histogram_while_one_feels) {
    feel_ct();
    pick(ct_set);
    ASSERT_TRUE(layers());
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
    window_->recordings().start(scratch("a.csv"));
    ASSERT_TRUE(press_until([&] { return now().session.tick.layers.touched == 0; }, finely));
    window_->recordings().stop();
    window_->files().open_path(scratch("a.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_EQ(window_->playback()->different(), 0U);
    window_->playing().show_time(window_->playback()->end());
    // The words may still be those of the session before.
    wait_until([&] { return window_->display().isovalue() == -300; });
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

TEST_F(LayersInWindow, sets_that_do_not_suit_the_solid_side_cannot_be_picked) {
    feel_ct();
    auto& box = part<QComboBox>("layers");
    const auto possible = [&](const char* set) {
        return bool(box.model()->index(box.findText(set), 0).flags() & Qt::ItemIsEnabled);
    };
    EXPECT_TRUE(possible(ct_set));
    window_->run().use_field(Solid::below, Interpolation::cubic);
    EXPECT_FALSE(possible(ct_set));
}

TEST(PlaybackClock, plays_to_the_end_pauses_there_and_begins_again) {
    PlaybackClock clock(5, 7);
    clock.advance(1);
    EXPECT_EQ(clock.time(), 5) << "it is paused";
    clock.play(0.5);
    clock.advance(1);
    EXPECT_EQ(clock.time(), 5.5);
    clock.advance(10);
    EXPECT_EQ(clock.time(), 7);
    EXPECT_EQ(clock.speed(), 0);
    clock.play(1);
    EXPECT_EQ(clock.time(), 5);
}

TEST(PlaybackClock, wraps_around_in_a_loop) {
    PlaybackClock clock(5, 7);
    clock.set_loop(true);
    clock.play(4);
    clock.advance(0.625);
    EXPECT_DOUBLE_EQ(clock.time(), 5.5);
    EXPECT_EQ(clock.speed(), 4);
}

TEST(PlaybackClock, a_recording_of_one_tick_ends_at_once_even_in_a_loop) {
    PlaybackClock clock(3, 3);
    clock.set_loop(true);
    clock.play(1);
    clock.advance(0.1);
    EXPECT_EQ(clock.time(), 3);
    EXPECT_EQ(clock.speed(), 0);
}

TEST(PlaybackClock, seeks_within_the_recording_only) {
    PlaybackClock clock(5, 7);
    for (const auto& [asked, is] : {std::pair{6.0, 6.0}, {9.0, 7.0}, {-1.0, 5.0}}) {
        clock.seek(asked);
        EXPECT_EQ(clock.time(), is);
    }
    clock.seek(std::nan(""));
    EXPECT_EQ(clock.time(), 5);
}

class Controllers : public testing::Test {
  protected:
    Controllers() {
        QObject::connect(&messages, &Messages::done, [this](const QString& what) { done = what; });
    }
    /// Feels a synthetic volume, with the mouse as device.
    void feel(const std::string& volume) {
        run::Setup setup;
        setup.device = {"mouse", {}};
        setup.real_time = false;
        setup.field.isovalue = 100.0;
        content.start_run(std::make_shared<Opened>(open(run::source_named(volume), [](double) {})),
                          {setup});
    }

    QWidget parent;
    Messages messages{&parent};
    Content content;
    QString done;
    support::ScratchFolder scratch;
};

TEST_F(Controllers, a_background_task_hands_its_result_over_or_shows_its_error) {
    BackgroundTask task(messages);
    int result = 0, then = 0;
    task.start(
        "count", [&](const io::Progress&) { result = 3; }, [&] { then = result; });
    EXPECT_TRUE(task.busy());
    wait_until([&] { return !task.busy(); });
    EXPECT_EQ(then, 3);
    task.start(
        "fail", [](const io::Progress&) { throw std::runtime_error("no such thing"); },
        [&] { then = 0; });
    wait_until([&] { return !task.busy(); });
    EXPECT_EQ(then, 3);
    EXPECT_TRUE(messages.problem().contains("no such thing"));
    EXPECT_NE(parent.findChild<QMessageBox*>("problem"), nullptr);
}

TEST_F(Controllers, a_cancelled_background_task_has_no_result) {
    BackgroundTask task(messages);
    bool then = false;
    const Worker::Task endless = [](const io::Progress& progress) {
        for (;;) progress(0.5);
    };
    task.start("wait", endless, [&] { then = true; });
    task.cancel();
    wait_until([&] { return !task.busy(); });
    EXPECT_FALSE(then);
    EXPECT_TRUE(messages.problem().isEmpty());
}

TEST_F(Controllers, actions_follow_what_is_possible_and_on) {
    QMenu menu;
    Actions actions(&parent, messages);
    bool on = false, possible = false;
    QAction* action = actions.add_switch(
        &menu, "switch", "Switch", {}, [&](bool to) { on = to; }, [&] { return on; },
        [&] { return possible; });
    actions.refresh();
    EXPECT_FALSE(action->isEnabled());
    possible = true;
    actions.refresh();
    action->trigger();
    EXPECT_TRUE(on);
    on = false;
    actions.refresh();
    EXPECT_FALSE(action->isChecked());
    actions.add(&menu, "throws", "Throws", {}, [] { throw std::runtime_error("impossible"); });
    actions.find("throws")->trigger();
    EXPECT_TRUE(messages.problem().contains("impossible"));
}

TEST_F(Controllers, a_recording_ends_when_another_volume_is_opened_and_is_played_by_the_timeline) {
    Timeline timeline;
    RecordingController recordings(content, messages);
    TimelineController playing(content, timeline, messages);
    feel("synthetic:sphere:24x24x24");
    EXPECT_TRUE(timeline.isHidden());
    const auto file = scratch.path() / "a.csv";
    recordings.start(QString::fromStdString(file.string()));
    ASSERT_TRUE(recordings.recording());
    wait_until([&] { return content.live()->recording()->ticks() > 200; });
    const auto volume = content.volume();
    feel("synthetic:torus:24x24x12");
    EXPECT_FALSE(recordings.recording());
    EXPECT_EQ(recordings.exit_status(), 0);
    content.start_playback(volume, Playback::read_hands(file, volume->loaded, [](double) {}));
    EXPECT_TRUE(done.contains(QRegularExpression("^A recording of [0-9]+\\.[0-9] s")))
        << done.toStdString();
    EXPECT_FALSE(timeline.isHidden());
    EXPECT_EQ(content.time(), content.playback()->begin());
    playing.show_time(1e9);
    EXPECT_EQ(content.time(), content.playback()->end());
    timeline.toggle_playing();
    EXPECT_EQ(content.time(), content.playback()->begin()) << "it begins again";
    wait_until([&] {
        playing.advance();
        playing.observe();
        return content.time() > content.playback()->begin();
    });
    content.close();
    EXPECT_TRUE(timeline.isHidden());
}

TEST_F(Controllers, without_edits_nothing_is_unsaved_and_nothing_can_be_undone) {
    Panel panel(content.effect());
    EditController editing(content, panel, messages, &parent);
    EXPECT_TRUE(editing.may_lose_edits({}));
    editing.undo();
    EXPECT_TRUE(done.isEmpty()) << "nothing is open";
    feel("synthetic:sphere:24x24x24");
    EXPECT_EQ(editing.unsaved(), nullptr);
    EXPECT_TRUE(editing.may_lose_edits({}));
    editing.undo();
    EXPECT_EQ(done, "There is nothing to undo");
    const auto file = scratch.path() / "saved.nrrd";
    editing.save(QString::fromStdString(file.string()));
    EXPECT_FALSE(editing.may_lose_edits({})) << "it is being saved";
    wait_until([&] { return !editing.saving(); });
    EXPECT_TRUE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace palpate::viewer::test
