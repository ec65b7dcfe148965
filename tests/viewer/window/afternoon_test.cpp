// An afternoon with the window, by keys and mouse on the sample head: one session from the first
// touch to the exported mesh, with a picture of each step for people to look at. With a window
// manager: scripts/with_display.sh sh -c "openbox & PROGRAM --gtest_filter=DrawnAfternoon*".
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QToolButton>

#include "palpate/io/mesh_file.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/io/volume_file.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

/// A label map: 1 where the head is as dense as bone.
Volume bone_of(const Volume& head) {
    std::vector<std::uint8_t> labels;
    for (const std::uint8_t sample : head.samples<std::uint8_t>()) labels.push_back(sample > 100);
    return Volume(head.geometry(), labels);
}

class DrawnAfternoon : public InWindow {
  protected:
    /// A picture, numbered, of the whole window once it rests.
    void show(const char* step) {
        wait_until_settled();
        for (int i = 0; i < 8; ++i) window_->tick();  // numbers follow a few times a second
        handle_events();
        save(QString("%1-%2").arg(++steps_, 2, 10, QChar('0')).arg(step).toStdString());
    }
    void open(const QString& path) {
        type_in_dialog(Qt::Key_O, path);
        wait_until([&] { return !window_->files().loading(); });
    }
    void touch(const QPoint& from_middle) {
        Scene& scene = window_->views().scene();
        QTest::mouseClick(&scene, Qt::LeftButton, {}, scene.rect().center() + from_middle);
        wait_until([&] { return window_->probe().travelling(); });
        wait_until([&] { return !window_->probe().travelling(); });
        wait_for_hand();
    }
    void open_and_press_through();
    void drill();
    void save_and_reopen();
    void choose_layers_and_overlay();
    void record_and_replay();
    void export_mesh();
    QString head() const { return QString::fromStdString(io::sample_volume_path().string()); }
    run::EditState work() { return window_->live()->data().editor().state(); }

    int steps_ = 0;
};

void DrawnAfternoon::open_and_press_through() {
    open(head());
    wait_until([&] { return window_->live() && window_->live()->snapshot(); });
    show("opened");
    touch({0, 40});
    wait_until([&] { return force() > 0.1; });
    show("touched");
    QTest::mouseClick(&on_page<QCheckBox>("penetrability"), Qt::LeftButton);
    EXPECT_TRUE(press_until([&] { return now().session.tick.proxy.isovalue > 60; }, 40));
    show("pressed-through");
    QTest::mouseClick(&on_page<QCheckBox>("penetrability"), Qt::LeftButton);
}

void DrawnAfternoon::drill() {
    touch({-60, -40});
    press(Qt::Key_B);
    EXPECT_TRUE(press_until([&] { return work().version > 3; }, 40));
    show("drilled");
    press(Qt::Key_B);
    wait_for_ticks(20);
    const auto drilled = work().samples;
    press(Qt::Key_Z, Qt::ControlModifier);
    wait_until([&] { return work().samples != drilled; });
    show("undone");
    press(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    wait_until([&] { return work().redo_steps == 0; });
}

void DrawnAfternoon::save_and_reopen() {
    type_in_dialog(Qt::Key_S, scratch("drilled.nrrd"), Qt::ShiftModifier);
    wait_until([&] { return !window_->saver().saving(); });
    type_in_dialog(Qt::Key_S, scratch("afternoon.json"));
    show("saved");
    open(head());
    wait_until_settled();
    open(scratch("afternoon.json"));
    EXPECT_TRUE(window_->windowTitle().contains("drilled.nrrd"));
    show("reopened");
}

void DrawnAfternoon::choose_layers_and_overlay() {
    auto& sets = on_page<QComboBox>("layers");
    const int set = sets.findText("Skin and bone of the head that comes with Palpate");
    ASSERT_GE(set, 0);
    sets.setCurrentIndex(set);
    Q_EMIT sets.activated(set);
    touch({0, 40});
    show("layers");
    sets.setCurrentIndex(0);
    Q_EMIT sets.activated(0);
    window_->panel().overlay_controls().open(run::source_named(scratch("bone.nrrd").toStdString()));
    wait_until([&] { return window_->panel().overlay_controls().overlay() != nullptr; });
    on_page<QWidget>("open_overlay");
    show("overlay");
    part<QAction>("close_overlay_action").trigger();
}

void DrawnAfternoon::record_and_replay() {
    type_in_dialog(Qt::Key_R, scratch("stroke"));
    wait_until([&] { return window_->recordings().recording(); });
    touch({0, 40});
    Scene& scene = window_->views().scene();
    drag(scene, scene.rect().center() + QPoint(0, 40), scene.rect().center() + QPoint(70, 60));
    wait_until([&] { return part<QLabel>("recording_clock").isVisible(); });
    show("recording");
    press(Qt::Key_R, Qt::ControlModifier);
    wait_until([&] { return window_->recordings().settled(); });
    open(scratch("stroke.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_EQ(window_->playback()->different(), 0U);
    QTest::mouseClick(&part<QToolButton>("timeline_play"), Qt::LeftButton);
    wait_until([&] { return window_->content().time() > window_->playback()->begin() + 0.1; });
    window_->playing().show_time(window_->playback()->end());
    show("replayed");
    press(Qt::Key_Escape);
    wait_until([&] { return window_->live() != nullptr; });
    show("felt-again");
}

void DrawnAfternoon::export_mesh() {
    window_->saver().set_many_triangles(20000);
    answer(QMessageBox::Yes);
    typing(scratch("head.ply"), [&] { part<QAction>("save_surface").trigger(); });
    wait_until([&] { return !window_->saver().saving() && QFile::exists(scratch("head.ply")); });
    show("exported");
    EXPECT_LT(io::read_mesh(scratch("head.ply").toStdString()).triangles.size(), 21000U);
}

TEST_F(DrawnAfternoon, from_the_first_touch_to_the_exported_mesh) {
    // Before the first dialog, which lists the folder.
    io::write_volume(bone_of(io::read_volume(io::sample_volume_path()).volume),
                     scratch_.path() / "bone.nrrd");
    show("welcome");
    open_and_press_through();
    drill();
    save_and_reopen();
    choose_layers_and_overlay();
    record_and_replay();
    export_mesh();
}

}  // namespace
}  // namespace palpate::viewer::test
