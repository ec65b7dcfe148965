// Controllers of the window by themselves, without the window.
#include <gtest/gtest.h>
#include <QAction>
#include <QMenu>
#include <QMessageBox>
#include <QRegularExpression>
#include <QtTest>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/stroke_plot.hpp"
#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/menus.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/recording_controller.hpp"
#include "apps/viewer/window/save_controller.hpp"
#include "apps/viewer/window/views.hpp"
#include "support/scratch_folder.hpp"
#include "viewer/undrawn.hpp"
#include "viewer/waiting.hpp"

namespace palpate::viewer::test {
namespace {

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
        const auto opened =
            std::make_shared<Opened>(open(run::source_named(volume), [](double) {}));
        content.start_run(opened, make_hands(*opened, {setup}));
    }

    QWidget parent;
    Messages messages{&parent};
    Content content;
    Views views{painter_of_test()};
    Timeline timeline;
    Desk desk{content, messages, views};
    Panel panel{desk};
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
    actions.add(&menu, {{"switch",
                         "Switch",
                         {},
                         [&](bool to) { on = to; },
                         [&] { return possible; },
                         [&] { return on; }},
                        {"throws", "Throws", {}, [] { throw std::runtime_error("impossible"); }}});
    QAction* action = actions.find("switch");
    actions.refresh();
    EXPECT_FALSE(action->isEnabled());
    possible = true;
    actions.refresh();
    action->trigger();
    EXPECT_TRUE(on);
    on = false;
    actions.refresh();
    EXPECT_FALSE(action->isChecked());
    actions.find("throws")->trigger();
    EXPECT_TRUE(messages.problem().contains("impossible"));
}

TEST_F(Controllers, a_recording_ends_when_another_volume_is_opened_and_is_played_by_the_timeline) {
    RecordingController recordings(desk);
    TimelineController playing(desk, timeline);
    feel("synthetic:sphere:24x24x24");
    EXPECT_TRUE(timeline.isHidden());
    const auto file = scratch.path() / "a.csv";
    recordings.start(QString::fromStdString(file.string()));
    wait_until([&] { return recordings.recording(); });
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
    SaveController editing(desk, panel);
    EXPECT_TRUE(editing.may_lose_edits({}));
    panel.brush_controls().undo();
    EXPECT_TRUE(done.isEmpty()) << "nothing is open";
    feel("synthetic:sphere:24x24x24");
    EXPECT_EQ(editing.unsaved(), nullptr);
    EXPECT_TRUE(editing.may_lose_edits({}));
    panel.brush_controls().undo();
    EXPECT_EQ(done, "There is nothing to undo");
    const auto file = scratch.path() / "saved.nrrd";
    editing.save(QString::fromStdString(file.string()));
    EXPECT_FALSE(editing.may_lose_edits({})) << "it is being saved";
    wait_until([&] { return !editing.saving(); });
    EXPECT_TRUE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace palpate::viewer::test
