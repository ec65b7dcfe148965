// The whole window: opening, feeling, recording, playing.
#include <Eigen/Geometry>

#include <QAbstractButton>
#include <QAction>
#include <QDoubleSpinBox>
#include <QElapsedTimer>
#include <QLabel>
#include <QMenu>
#include <QMessageBox>
#include <QPushButton>
#include <QRegularExpression>
#include <QScrollArea>
#include <QScrollBar>
#include <QSlider>
#include <QStatusBar>
#include <QTextBrowser>
#include <QToolButton>

#include "apps/viewer/model/probe_route.hpp"
#include "apps/viewer/window/welcome.hpp"
#include "palpate/io/sample_volume.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

using Window = InWindow;

constexpr const char* large_sphere = "synthetic:sphere:48x48x48";

TEST_F(Window, a_file_is_opened_through_the_dialog_by_keys) {
    const Volume ball = run::load(run::source_named(large_sphere)).volume;
    io::write_volume(ball, scratch_.path() / "ball.nrrd");
    type_in_dialog(Qt::Key_O, scratch("ball.nrrd"));
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_EQ(window_->live()->field().geometry().size, Index3(48, 48, 48));
    EXPECT_TRUE(window_->windowTitle().startsWith("ball.nrrd"));
    EXPECT_TRUE(QSettings().value("recent").toStringList().contains(scratch("ball.nrrd")));
}

TEST_F(Window, pressing_with_the_mouse_makes_force_and_letting_go_ends_it) {
    feel(large_sphere);
    EXPECT_EQ(force(), 0);
    press_until_force();
    save("pressed");
    EXPECT_EQ(now().session.tick.proxy.mode, Mode::constrained);
    turn_wheel(window_->views().scene(), -20);
    wait_until([&] { return force() == 0; });
}

TEST_F(Window, the_page_of_an_empty_window_can_be_seen_whole_at_any_size) {
    Welcome welcome;
    welcome.set_devices("No haptic device was found: the mouse is the hand.");
    welcome.show();
    auto* area = welcome.findChild<QScrollArea*>();
    ASSERT_NE(area, nullptr);
    for (const QSize& size : {QSize(900, 700), QSize(500, 560), QSize(300, 240)}) {
        welcome.resize(size);
        QApplication::processEvents();
        const QWidget& page = *area->widget();
        EXPECT_LE(page.width(), area->viewport()->width());
        EXPECT_EQ(area->verticalScrollBar()->maximum(),
                  std::max(0, page.height() - area->viewport()->height()));
        for (const QWidget* part : page.findChildren<QWidget*>()) {
            if (!part->isVisible()) continue;
            const QRect at(part->mapTo(&page, QPoint()), part->size());
            EXPECT_TRUE(page.rect().contains(at)) << size.width();
            const int needed = part->hasHeightForWidth() ? part->heightForWidth(part->width())
                                                         : part->minimumSizeHint().height();
            EXPECT_GE(part->height(), needed) << part->objectName().toStdString();
            EXPECT_GE(part->width(), part->minimumSizeHint().width());
        }
    }
}

TEST_F(Window, an_empty_window_welcomes_with_what_can_be_opened) {
    io::write_volume(run::load(run::source_named(large_sphere)).volume,
                     scratch_.path() / "ball.nrrd");
    QSettings().setValue("recent", QStringList{scratch("ball.nrrd")});
    open_window("mouse");
    auto& welcome = part<QWidget>("welcome");
    EXPECT_TRUE(welcome.isVisible());
    EXPECT_FALSE(window_->views().isVisible());
    const auto expect_menus = [this](bool enabled) {
        for (const char* name : {"measure", "cut", "layout"}) {
            EXPECT_EQ(window_->findChild<QMenu*>(name)->menuAction()->isEnabled(), enabled) << name;
        }
    };
    expect_menus(false);
    wait_until([&] { return part<QLabel>("welcome_devices").text().contains("mouse"); });
    save("welcome");
    QPushButton* recent = nullptr;
    for (auto* button : part<QWidget>("welcome_recent").findChildren<QPushButton*>()) {
        if (button->text() == "ball.nrrd") recent = button;
    }
    ASSERT_NE(recent, nullptr);
    QTest::mouseClick(recent, Qt::LeftButton);
    wait_until([&] { return window_->live() && window_->settled(); });
    EXPECT_FALSE(welcome.isVisible());
    EXPECT_TRUE(window_->views().isVisible());
    expect_menus(true);
}

TEST_F(Window, the_sample_volume_is_a_click_away) {
    QTest::mouseClick(&part<QAbstractButton>("welcome_sample"), Qt::LeftButton);
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_EQ(window_->live()->isovalue(), io::sample_volume_skin);
}

TEST_F(Window, at_the_start_the_probe_stands_just_off_the_first_surface_in_view) {
    feel(large_sphere);
    const Field& field = window_->live()->field();
    const Vec3 towards = axes_of(window_->views().scene().camera()).towards_viewer;
    const auto surface =
        surface_in_view(field, window_->live()->isovalue(), towards, Vec3::UnitY());
    ASSERT_TRUE(surface);
    const auto away = [&] { return (now().session.tick.proxy.hip - *surface).dot(towards); };
    EXPECT_NEAR(away(), 2 * field.geometry().spacing.maxCoeff(), 1);
    EXPECT_EQ(now().session.tick.proxy.mode, Mode::free);
    EXPECT_EQ(window_->views().shown().crosshair, physical_centre(field.geometry()));
    press_until_force();
    wait_until([&] {
        return window_->views().shown().crosshair != physical_centre(field.geometry());
    });  // from the first contact on it follows
}

TEST_F(Window, a_click_touches_the_surface_there_and_a_held_button_presses_deeper) {
    feel(large_sphere);
    Scene& scene = window_->views().scene();
    const QPoint at = scene.rect().center() + QPoint(70, -50);
    QTest::mousePress(&scene, Qt::LeftButton, {}, at);
    wait_until([&] { return !window_->probe().travelling(); });
    wait_until([&] { return force() > 0.1; });
    const auto contact = now().session.tick.proxy;
    EXPECT_EQ(contact.mode, Mode::constrained);
    const Pixel seen = pixel_of(scene.camera(), scene.view_size(), contact.hip);
    EXPECT_NEAR(seen.x, at.x(), 3);
    EXPECT_NEAR(seen.y, at.y(), 3);
    wait_until([&] { return part<QLabel>("depth").isVisible(); });
    EXPECT_TRUE(part<QLabel>("depth").text().contains("mm deep"));
    const double first = force();
    wait_until([&] { return force() > first + 0.2; });  // the button is held
    save("touched");
    QTest::mouseRelease(&scene, Qt::LeftButton, {}, at);
    const Vec3 aimed = window_->live()->mouse()->aimed();
    for (int i = 0; i < 30; ++i) window_->tick();
    EXPECT_EQ(window_->live()->mouse()->aimed(), aimed) << "the hand does not go on pressing";
    wait_for_hand();
    wait_for_ticks(2);
    EXPECT_GT(force(), 0.1) << "nor lets go";
}

TEST_F(Window, a_click_frees_a_probe_that_is_caught_in_a_closed_shell) {
    feel("synthetic:shell:48x48x48");
    const double level = window_->live()->isovalue();
    Scene& scene = window_->views().scene();
    const Vec3 towards = axes_of(scene.camera()).towards_viewer;
    const auto outer = surface_under(window_->live()->field(), level, Vec3::Zero(), towards);
    for (const bool presses : {false, true}) {
        // Into the shell while nothing is solid.
        window_->content().effect().request(command::Isovalue{1e9});
        wait_for_ticks(4);
        window_->probe().move_to(Vec3::Zero());
        wait_for_hand();
        window_->content().effect().request(command::Isovalue{level});
        wait_for_ticks(4);
        if (presses) {  // the inner wall at the back, below the point that is clicked
            window_->probe().move_by(-20 * towards);
            wait_until([&] { return now().session.tick.proxy.mode == Mode::constrained; });
            wait_for_hand();
        }
        QTest::mouseClick(&scene, Qt::LeftButton, {}, scene.rect().center());
        wait_until([&] { return !window_->probe().travelling(); });
        wait_for_hand();
        wait_until([&] { return force() > 0.1; });
        wait_until([&] { return (now().session.tick.proxy.scp - outer.value()).norm() < 0.3; });
        EXPECT_LT(force(), 0.6);
    }
}

TEST_F(Window, plus_and_minus_change_the_panel_too) {
    feel(large_sphere);
    const double before = window_->live()->isovalue();
    press(Qt::Key_Plus);
    wait_until([&] { return window_->live()->isovalue() > before; });
    const auto shown = [&] { return part<QDoubleSpinBox>("isovalue_box").value(); };
    EXPECT_NEAR(shown(), window_->live()->isovalue(), 1e-3);
    EXPECT_EQ(window_->content().effect().isovalue(), window_->live()->isovalue());
    press(Qt::Key_Minus);
    press(Qt::Key_Minus);
    wait_until([&] { return window_->live()->isovalue() < before; });
    EXPECT_NEAR(shown(), window_->live()->isovalue(), 1e-3);
}

TEST_F(Window, a_thin_stack_is_seen_face_on) {
    feel("synthetic:sphere:6x40x40");
    EXPECT_NEAR(std::abs(axes_of(window_->views().scene().camera()).towards_viewer[0]), 1, 1e-9);
}

TEST_F(Window, r_shows_the_whole_volume_from_the_same_side) {
    feel(large_sphere);
    Scene& scene = window_->views().scene();
    press(Qt::Key_3);
    drag(scene, scene.rect().center(), scene.rect().center() + QPoint(90, 40), Qt::RightButton);
    const pictures::Camera before = scene.camera();
    pictures::Camera away = before;
    away.half_height *= 0.2;
    away.focus += Vec3(5, 6, 7);
    scene.set_camera(away);
    press(Qt::Key_R);
    EXPECT_LT((scene.camera().towards_viewer - before.towards_viewer).norm(), 1e-9);
    EXPECT_LT((scene.camera().up - before.up).norm(), 1e-9);
    EXPECT_GT(scene.camera().half_height, 3 * away.half_height);
}

TEST_F(Window, the_wheel_does_not_carry_the_probe_out_at_the_far_side) {
    feel("synthetic:torus:48x48x24");
    Scene& scene = window_->views().scene();
    const Geometry& g = window_->live()->field().geometry();
    const Vec3 towards = axes_of(scene.camera()).towards_viewer;
    const Vec3 before = physical_centre(g) + 20 * towards;
    window_->probe().move_to(before);
    wait_until([&] { return (now().session.tick.proxy.hip - before).norm() < 0.5; });
    turn_wheel(scene, 60);
    const auto depth = [&] { return now().session.tick.proxy.hip.dot(towards); };
    const double back = extent_along(g, towards).back;
    wait_for_hand();
    EXPECT_NEAR(depth(), back, 0.5);
}

TEST_F(Window, forces_that_wait_say_so_where_the_eye_is) {
    feel(large_sphere);
    EXPECT_FALSE(part<QLabel>("hint").isVisible());
    ForceSettings force = window_->live()->settings().force;
    force.start_below = 0.3;
    window_->content().effect().request(force);
    press_until_force();
    turn_wheel(window_->views().scene(), 5);
    press(Qt::Key_Space);
    wait_until([&] { return part<QLabel>("hint").text().contains("space bar"); });
    press(Qt::Key_Space);
    wait_until([&] { return part<QLabel>("hint").text().contains("Withdraw"); });
    EXPECT_TRUE(part<QLabel>("hint").isVisible());
    const auto button = [&] { return part<QPushButton>("forces").text(); };
    wait_until([&] { return button().contains("WAIT"); });
    save("waiting");
    turn_wheel(window_->views().scene(), -15);
    wait_until([&] { return !part<QLabel>("hint").isVisible(); });
    wait_until([&] { return button().contains("ON"); });
}

TEST_F(Window, dragging_in_the_scene_moves_the_probe_in_the_plane_of_the_view) {
    feel(large_sphere);
    const Vec3 before = now().session.tick.proxy.hip;
    Scene& scene = window_->views().scene();
    const QPoint centre = scene.rect().center();
    drag(scene, centre, centre + QPoint(60, 0));
    wait_for_hand();
    const Vec3 way = now().session.tick.proxy.hip - before;
    const pictures::Camera camera = scene.camera();
    EXPECT_LT(std::abs(way.dot(camera.towards_viewer.normalized())), 1e-3 * way.norm());
    const Vec3 right = Vec3(camera.up.cross(camera.towards_viewer)).normalized();
    EXPECT_GT(way.dot(right), 0.99 * way.norm());
    const double mm_per_pixel = 2 * camera.half_height / scene.height();
    EXPECT_NEAR(way.norm(), 60 * mm_per_pixel, 2 * mm_per_pixel);
}

TEST_F(Window, keys_nudge_the_probe_by_a_voxel_in_the_view) {
    feel(large_sphere);
    const Vec3 before = now().session.tick.proxy.hip;
    window_->views().scene().setFocus();
    QTest::keyClick(&window_->views().scene(), Qt::Key_Right);
    const double voxel = window_->live()->field().geometry().spacing.minCoeff();
    wait_until([&] {
        return std::abs((now().session.tick.proxy.hip - before).norm() - voxel) < 0.01 * voxel;
    });
}

TEST_F(Window, dragging_the_slider_changes_the_level_that_is_felt_and_seen) {
    feel(large_sphere);
    auto& slider = part<QSlider>("isovalue_slider");
    const double before = window_->live()->isovalue();
    const int x = slider.width() / 2, y = slider.height() / 2;
    drag(slider, {x, y}, {x + slider.width() / 4, y});
    wait_until([&] { return now().session.tick.proxy.isovalue != before; });
    wait_until([&] { return now().session.tick.proxy.isovalue == window_->live()->isovalue(); });
    wait_until_settled();
}

TEST_F(Window, space_switches_the_forces_off_and_on) {
    feel(large_sphere);
    press_until_force();
    press(Qt::Key_Space);
    wait_until([&] { return !now().forces_on && force() == 0; });
    save("off");
    press(Qt::Key_Space);
    // The hand is deep enough for a force, which begins once a small one is wanted.
    wait_until([&] { return now().forces_on; });
}

TEST_F(Window, freeze_holds_hand_and_proxy) {
    feel(large_sphere);
    press(Qt::Key_F);
    wait_until([&] { return now().session.frozen; });
    const Vec3 before = now().session.tick.proxy.hip;
    turn_wheel(window_->views().scene(), 10);
    wait_for_ticks(50);
    EXPECT_EQ(now().session.tick.proxy.hip, before);
}

TEST_F(Window, a_session_is_recorded_and_played_back_with_the_timeline) {
    feel(large_sphere);
    const QString file = scratch("session.csv");
    QElapsedTimer since_before;
    since_before.start();
    type_in_dialog(Qt::Key_R, scratch("session"));  // the dialog adds the extension
    wait_until([&] { return window_->recordings().recording(); });
    press_until_force();
    const auto clock_s = [&] {
        const auto& clock = part<QLabel>("recording_clock");
        const auto time = QRegularExpression("([0-9]+):([0-5][0-9])$").match(clock.text());
        if (!clock.isVisible() || !time.hasMatch()) return -1;
        return 60 * time.captured(1).toInt() + time.captured(2).toInt();
    };
    wait_until([&] { return clock_s() >= 1; });
    EXPECT_LE(clock_s(), since_before.elapsed() / 1000);
    save("recording");
    press(Qt::Key_R, Qt::ControlModifier);
    EXPECT_EQ(window_->live()->recording(), nullptr);
    const QRegularExpression told("^Recorded [1-9][0-9]*\\.[0-9] s$");
    wait_until([&] { return window_->statusBar()->currentMessage().contains(told); });
    wait_until([&] { return !part<QLabel>("recording_clock").isVisible(); });
    ASSERT_TRUE(QFile::exists(file));
    type_in_dialog(Qt::Key_O, file);
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_EQ(window_->live(), nullptr);
    EXPECT_EQ(window_->playback()->different(), 0U);
    EXPECT_TRUE(window_->timeline().isVisible());
    // At the end the hand presses, at the beginning it does not.
    window_->playing().show_time(window_->playback()->end());
    EXPECT_GT(window_->playback()->at(window_->content().time()).session.tick.force.norm(), 0.2);
    wait_until_settled();
    save("played");
    window_->playing().show_time(window_->playback()->begin());
    EXPECT_EQ(window_->playback()->at(window_->content().time()).session.tick.force.norm(), 0);
    QTest::mouseClick(&part<QToolButton>("timeline_play"), Qt::LeftButton);
    EXPECT_TRUE(window_->timeline().playing());
    wait_until([&] { return window_->content().time() > window_->playback()->begin() + 0.1; });
    // And back to feeling.
    press(Qt::Key_Escape);
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_FALSE(window_->timeline().isVisible());
}

TEST_F(Window, a_file_that_cannot_be_opened_is_reported_and_the_session_continues) {
    feel(large_sphere);
    const run::Run* live = window_->live();
    window_->files().open_path(scratch("missing.nrrd"));
    wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().contains("missing.nrrd"));
    auto* box = window_->findChild<QMessageBox*>("problem");
    ASSERT_NE(box, nullptr);
    EXPECT_TRUE(box->isVisible());
    save("told");
    QTest::keyClick(box, Qt::Key_Return);
    EXPECT_EQ(window_->live(), live);
    const std::int64_t number = now().number;
    wait_until([&] { return now().number > number; });
}

TEST_F(Window, a_session_file_brings_back_what_was_set) {
    feel(large_sphere);
    ForceSettings force = window_->live()->settings().force;
    force.stiffness = 0.31;
    window_->content().effect().request(force);
    window_->content().effect().request(command::Isovalue{100});
    window_->views().scene().look_from(pictures::view_named("left"));
    Look look = window_->panel().look_controls().look();
    look.surface_opacity = 0.5;
    window_->panel().look_controls().set_look(look);
    const pictures::Camera camera = window_->views().scene().camera();
    window_->files().save_session(scratch("day.json"));
    feel("synthetic:torus:32x32x16");
    window_->files().open_path(scratch("day.json"));
    wait_until(
        [&] { return window_->live() && window_->live()->field().geometry().size[0] == 48; });
    EXPECT_EQ(window_->live()->settings().force.stiffness, 0.31);
    EXPECT_EQ(window_->live()->isovalue(), 100);
    EXPECT_EQ(window_->panel().look_controls().look().surface_opacity, 0.5);
    EXPECT_LT((window_->views().scene().camera().towards_viewer - camera.towards_viewer).norm(),
              1e-9);
}

TEST_F(Window, another_device_takes_over_with_what_was_set) {
    feel(large_sphere);
    window_->content().effect().request(command::Isovalue{90});
    use_device("simulated:hand=press");
    ASSERT_NE(window_->live(), nullptr);
    EXPECT_EQ(window_->live()->mouse(), nullptr);
    EXPECT_EQ(window_->live()->isovalue(), 90);
    wait_until([&] { return force() > 0.2; });
    use_device("nonsense");
    EXPECT_TRUE(window_->messages().problem().contains("nonsense"));
    EXPECT_EQ(run::text_of(window_->live()->setup().device), "simulated:hand=press");
}

TEST_F(Window, control_q_ends_the_window_and_the_session) {
    feel(large_sphere);
    press(Qt::Key_Q, Qt::ControlModifier);
    EXPECT_FALSE(window_->isVisible());
    window_.reset();
}

TEST_F(Window, a_double_click_shows_a_pane_alone_and_again_all) {
    feel(large_sphere);
    SlicePane& axial = window_->views().slice(2);
    Scene& scene = window_->views().scene();
    QTest::mouseDClick(&axial, Qt::LeftButton);
    EXPECT_TRUE(axial.isVisible());
    EXPECT_FALSE(scene.isVisible());
    EXPECT_FALSE(window_->views().slice(1).isVisible());
    wait_until([&] { return axial.width() > window_->views().width() - 20; });
    save("axial");
    QTest::mouseDClick(&axial, Qt::LeftButton);
    EXPECT_TRUE(scene.isVisible());
    press(Qt::Key_F7);
    EXPECT_TRUE(scene.isVisible());
    EXPECT_FALSE(axial.isVisible());
    press(Qt::Key_F6);
    wait_until_settled();
    save("four");
    EXPECT_NEAR(scene.width(), axial.width(), 20);
    EXPECT_NEAR(scene.height(), window_->views().slice(0).height(), 20);
    press(Qt::Key_F5);
    wait_until_settled();
    EXPECT_GT(scene.width(), 2 * axial.width());
    // Order, from above: axial, coronal, sagittal.
    EXPECT_LT(axial.y(), window_->views().slice(1).y());
    EXPECT_LT(window_->views().slice(1).y(), window_->views().slice(0).y());
}

TEST_F(Window, the_read_out_tells_place_value_and_slope_at_the_proxy) {
    feel(large_sphere);
    press_until_force();
    const auto words = [&] { return part<QLabel>("readout").text(); };
    const QString level = QString::number(window_->live()->isovalue(), 'g', 4);
    wait_until([&] { return words().contains("mm   " + level); });
    EXPECT_TRUE(words().contains("slope"));
}

TEST_F(Window, help_has_first_steps_and_versions) {
    for (const char* name : {"first_steps", "about"}) {
        part<QAction>((std::string(name) + "_action").c_str()).trigger();
        auto& dialog = part<QDialog>(name);
        wait_until([&] { return dialog.isVisible(); });
        EXPECT_TRUE(dialog.findChild<QTextBrowser*>()->toPlainText().contains(
            QString(name) == "about" ? "VTK" : "Touch"));
        dialog.grab().save(QString("%1/%2.png").arg(PALPATE_PICTURES, name));
        dialog.close();
    }
}

TEST_F(Window, question_mark_lists_every_shortcut) {
    press(Qt::Key_Question, Qt::ShiftModifier);
    auto* dialog = window_->findChild<QDialog*>("shortcuts");
    ASSERT_NE(dialog, nullptr);
    wait_until([&] { return dialog->isVisible(); });
    dialog->grab().save(QString(PALPATE_PICTURES) + "/shortcuts.png");
    dialog->close();
}

}  // namespace
}  // namespace palpate::viewer::test
