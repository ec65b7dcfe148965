// The whole window with changing data: the brush, undo, saving, sequences.
#include <QAction>
#include <QDir>
#include <QFile>
#include <QLabel>
#include <QMessageBox>
#include <QPushButton>
#include <QStatusBar>
#include <QTabWidget>
#include <QTimer>
#include <QToolButton>

#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "palpate/io/volume_file.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class ChangingData : public InWindow {
  protected:
    run::EditState work() { return window_->live()->data().editor().state(); }
    bool can(const char* action) { return part<QAction>(action).isEnabled(); }
    /// Presses, and carves until something is gone.
    void carve() {
        press_until_force();
        press(Qt::Key_B);
        wait_until([&] { return work().version > 0; });
        press(Qt::Key_B);
    }
};

TEST_F(ChangingData, the_brush_carves_what_is_felt_and_undo_and_redo_bring_it_back_and_forth) {
    feel("synthetic:sphere:48x48x48");
    save("before");
    const auto start = work().samples;
    EXPECT_FALSE(can("undo_action") || can("redo_action")) << "nothing was edited";
    carve();
    EXPECT_TRUE(work().changed);
    wait_until([&] { return can("undo_action"); });
    EXPECT_FALSE(can("redo_action"));
    wait_until_settled();
    save("carved");
    press(Qt::Key_Z, Qt::ControlModifier);
    wait_until([&] { return work().samples == start; });
    wait_until([&] { return now().session.version == 0; });
    wait_until([&] { return can("redo_action"); });
    EXPECT_FALSE(can("undo_action"));
    press(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    wait_until([&] { return work().samples != start; });
    wait_until([&] { return part<QPushButton>("undo").isEnabled(); });
    QTest::mouseClick(&part<QPushButton>("undo"), Qt::LeftButton);
    wait_until([&] { return work().samples == start; });
}

TEST_F(ChangingData, the_edited_volume_is_saved_by_a_dialog_and_can_be_opened) {
    feel("synthetic:sphere:48x48x48");
    carve();
    const auto carved = work().samples;
    type_in_dialog(Qt::Key_S, scratch("carved.nrrd"), Qt::ShiftModifier);
    wait_until([&] { return !work().changed; });
    const Volume saved = io::read_volume(scratch_.path() / "carved.nrrd").volume;
    const Volume felt = flattened(*carved);
    ASSERT_EQ(saved.bytes(), felt.bytes());
    EXPECT_EQ(std::memcmp(saved.data(), felt.data(), felt.bytes()), 0);
    feel(scratch("carved.nrrd").toStdString());
    EXPECT_EQ(work().version, 0U);
}

TEST_F(ChangingData, the_edited_volume_is_saved_as_zarr_and_then_read_as_it_is_felt) {
    feel("synthetic:sphere:48x48x48");
    carve();
    const Volume felt = flattened(*work().samples);
    type_in_dialog(Qt::Key_S, scratch("carved.zarr"), Qt::ShiftModifier);
    wait_until([&] { return !work().changed; });
    const auto store = stream::open_store((scratch_.path() / "carved.zarr").string());
    const Volume saved = stream::read_level(*store, 0);
    EXPECT_EQ(saved.geometry().origin, felt.geometry().origin);
    ASSERT_EQ(saved.bytes(), felt.bytes());
    EXPECT_EQ(std::memcmp(saved.data(), felt.data(), felt.bytes()), 0);
    feel(scratch("carved.zarr").toStdString());
    EXPECT_TRUE(window_->live()->data().is_streamed());
}

TEST_F(ChangingData, a_brush_that_is_on_is_seen_over_the_scene_on_every_page) {
    feel("synthetic:sphere:48x48x48");
    auto& words = part<QLabel>("brush_on");
    EXPECT_FALSE(words.isVisible());
    press(Qt::Key_B);
    auto& tabs = part<QTabWidget>("tabs");
    for (int page = 0; page < tabs.count(); ++page) {
        tabs.setCurrentIndex(page);
        wait_until([&] { return words.isVisible(); });
    }
    press(Qt::Key_F8);
    const QWidget& alone = *window_->views().alone();
    wait_until([&] { return alone.isVisible() && words.isVisible(); });
    EXPECT_EQ(words.parentWidget(), &alone);
    EXPECT_TRUE(alone.rect().contains(words.geometry()));
    press(Qt::Key_F5);
    wait_until([&] { return !alone.isVisible() || words.parentWidget() != &alone; });
    wait_until([&] { return words.isVisible(); });
    press(Qt::Key_B);
    wait_until([&] { return !words.isVisible(); });
}

TEST_F(ChangingData, a_hand_that_is_sent_elsewhere_edits_nothing_on_its_way) {
    feel("synthetic:sphere:48x48x48");
    press_until_force();
    turn_wheel(window_->views().scene(), 10);
    wait_for_hand();
    press(Qt::Key_B);
    Scene& scene = window_->views().scene();
    wait_until([&] { return can("undo_action"); });
    press(Qt::Key_Z, Qt::ControlModifier);
    wait_until([&] { return !work().changed; });
    QTest::mouseClick(&scene, Qt::LeftButton, {}, scene.rect().center() + QPoint(60, 0));
    wait_until([&] { return window_->live()->mouse()->aimed()[2] > 0 && force() == 0; });
    EXPECT_EQ(work().undo_steps, 0U) << "drawing back carved";
}

using DrawnChangingData = ChangingData;

TEST_F(DrawnChangingData, the_brush_is_outlined_in_scene_and_slices) {
    feel("synthetic:sphere:48x48x48");
    press_until_force();
    wait_until_settled();
    const auto orange = [](const QImage& image) {
        int count = 0;
        for (int y = 0; y < image.height(); ++y) {
            for (int x = 0; x < image.width(); ++x) {
                const QColor c = image.pixelColor(x, y);
                count += c.red() > 200 && c.green() > 120 && c.green() < 190 && c.blue() < 60;
            }
        }
        return count;
    };
    const auto scene = [&] { return orange(window_->views().scene().picture()); };
    const auto slice = [&] { return orange(window_->views().slice(2).grab().toImage()); };
    const int before_scene = scene(), before_slice = slice();
    press(Qt::Key_B);
    wait_until([&] { return scene() > before_scene + 50; });
    wait_until([&] { return slice() > before_slice + 20; });
    save("brush");
    press(Qt::Key_B);
    wait_until([&] { return scene() <= before_scene + 5; });
}

TEST_F(ChangingData, what_was_saved_is_what_is_open) {
    feel("synthetic:sphere:48x48x48");
    EXPECT_FALSE(window_->isWindowModified());
    carve();
    const auto carved = work().samples;
    wait_until([&] { return window_->isWindowModified(); });
    type_in_dialog(Qt::Key_S, scratch("carved.nrrd"), Qt::ShiftModifier);
    wait_until([&] { return !window_->saver().saving(); });
    wait_until([&] { return !window_->isWindowModified(); });
    EXPECT_TRUE(window_->windowTitle().startsWith("carved.nrrd[*]"));
    EXPECT_EQ(recent_files().value(0), scratch("carved.nrrd"));
    type_in_dialog(Qt::Key_S, scratch("case.json"));
    EXPECT_TRUE(window_->windowTitle().contains("(case.json)"));
    EXPECT_EQ(run::name_of(read_session(scratch("case.json").toStdString()).source),
              scratch("carved.nrrd").toStdString());
    // Opened here, where the volume of before the edits is still at hand.
    window_->files().open_path(scratch("case.json"));
    wait_until([&] { return window_->settled() && !window_->files().loading(); });
    EXPECT_EQ(work().version, 0U);
    EXPECT_TRUE(window_->windowTitle().contains("(case.json)"));
    const Volume felt = flattened(*work().samples), edited = flattened(*carved);
    EXPECT_EQ(std::memcmp(felt.data(), edited.data(), edited.bytes()), 0);
    // A session that has a name is saved under it without a question.
    QFile::remove(scratch("case.json"));
    press(Qt::Key_S, Qt::ControlModifier);
    EXPECT_TRUE(QFile::exists(scratch("case.json")));
}

TEST_F(ChangingData, closing_offers_to_save_and_closes_once_that_is_done) {
    feel("synthetic:sphere:48x48x48");
    carve();
    answer(QMessageBox::Save);
    typing(scratch("kept.nrrd"),
           [&] { EXPECT_FALSE(window_->close()) << "not before it is saved"; });
    wait_until([&] { return !window_->isVisible(); });
    EXPECT_TRUE(QFile::exists(scratch("kept.nrrd")));
}

TEST_F(ChangingData, a_session_of_a_volume_with_unsaved_edits_asks_first) {
    feel("synthetic:sphere:48x48x48");
    carve();
    answer(QMessageBox::Cancel);
    press(Qt::Key_S, Qt::ControlModifier);
    EXPECT_TRUE(work().changed);
    activate(*window_);
    answer(QMessageBox::Discard);
    type_in_dialog(Qt::Key_S, scratch("case.json"));
    EXPECT_TRUE(work().changed) << "the edits are not lost";
    EXPECT_EQ(run::name_of(read_session(scratch("case.json").toStdString()).source),
              "synthetic:sphere:48x48x48");
}

TEST_F(ChangingData, a_window_with_unsaved_edits_asks_before_it_closes) {
    feel("synthetic:sphere:48x48x48");
    carve();
    answer(QMessageBox::Cancel);
    EXPECT_FALSE(window_->close());
    ASSERT_NE(window_->live(), nullptr);
    answer(QMessageBox::Discard);
    EXPECT_TRUE(window_->close());
}

TEST_F(ChangingData, a_signal_ends_it_without_a_question_and_rescues_the_edits) {
    feel("synthetic:sphere:48x48x48");
    carve();
    const auto carved = work().samples;
    const QStringList before = QDir::temp().entryList({"palpate-edits-*"}, QDir::Dirs);
    window_->end();  // what main() does on a signal
    EXPECT_EQ(window_->live(), nullptr) << "forces are gone";
    QStringList kept = QDir::temp().entryList({"palpate-edits-*"}, QDir::Dirs);
    for (const QString& name : before) kept.removeAll(name);
    ASSERT_EQ(kept.size(), 1);
    QDir folder(QDir::temp().filePath(kept[0]));
    const Volume rescued = io::read_volume(folder.filePath("edits.nrrd").toStdString()).volume;
    folder.removeRecursively();
    const Volume felt = flattened(*carved);
    EXPECT_EQ(std::memcmp(rescued.data(), felt.data(), felt.bytes()), 0);
}

TEST_F(ChangingData, a_recording_of_edits_is_played_with_them) {
    feel("synthetic:sphere:48x48x48");
    record("carving.csv");
    carve();
    const auto carved = work().samples;
    wait_until([&] { return now().session.version == work().version; });  // it is recorded, then
    stop_recording();
    window_->files().open_path(scratch("carving.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_EQ(window_->playback()->different(), 0U);
    window_->playing().show_time(window_->playback()->end());
    Playback& playback = *window_->playback();
    const Volume seen = flattened(playback.field_at(playback.at(playback.end())).samples());
    const Volume felt = flattened(*carved);
    EXPECT_EQ(std::memcmp(seen.data(), felt.data(), felt.bytes()), 0);
    wait_until_settled();
    save("played");
}

TEST_F(ChangingData, a_sequence_plays_steps_and_is_sought_with_the_timeline) {
    // Not feel(): what plays does not settle.
    window_->files().open_path("synthetic:beating:32x32x32");
    wait_until([&] { return window_->live() && window_->live()->snapshot(); });
    EXPECT_TRUE(window_->timeline().isVisible());
    const double before = now().session.moment;
    wait_until([&] { return now().session.moment > before + 0.1; });  // it plays
    QTest::mouseClick(&part<QToolButton>("timeline_play"), Qt::LeftButton);
    wait_until([&] { return now().speed == 0; });
    QTest::mouseClick(&part<QToolButton>("timeline_forward"), Qt::LeftButton);
    wait_until([&] {
        const double frames = now().session.moment / 0.04;
        return std::abs(frames - std::round(frames)) < 1e-6;
    });
    wait_until_settled();
    save("beating");
    // The brush is not for sequences, and says so.
    press(Qt::Key_B);
    EXPECT_TRUE(window_->statusBar()->currentMessage().contains("cannot be edited"));
    EXPECT_TRUE(window_->statusBar()->toolTip().contains("cannot be edited"));
    EXPECT_FALSE(window_->panel().brush_controls().choice().on);
    const auto& shown = part<QAction>("brush_action");
    EXPECT_FALSE(shown.isChecked());
    press(Qt::Key_K);
    wait_until([&] { return now().speed == 1; });
    feel("synthetic:sphere:32x32x32");
    EXPECT_FALSE(window_->timeline().isVisible());
    EXPECT_TRUE(shown.isEnabled());
    press(Qt::Key_B);
    EXPECT_TRUE(shown.isChecked()) << "it is seen in the tool bar";
    QTest::mouseClick(&on_page<QAbstractButton>("brush"), Qt::LeftButton);
    wait_until([&] { return !shown.isChecked(); });
}

}  // namespace
}  // namespace palpate::viewer::test
