// What a person looks at: several surfaces, cuts, measurements, overlays, by keys and mouse.
#include <QAbstractScrollArea>
#include <QAccessible>
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QPushButton>
#include <QSettings>

#include <map>

#include "apps/viewer/panel/inputs.hpp"
#include "palpate/io/sample_volume.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class Looking : public InWindow {
  protected:
    const Look& look() { return window_->panel().look_controls().look(); }
    QPoint middle(QWidget& widget) { return widget.rect().center(); }
};

TEST_F(Looking, skin_over_bone_is_two_clicks_and_either_is_felt) {
    feel(io::sample_volume_path().string());
    const double skin = window_->live()->isovalue();
    QTest::mouseClick(&on_page<QPushButton>("add_surface"), Qt::LeftButton);
    wait_until_settled();
    ASSERT_EQ(look().surfaces.size(), 1U);
    const double other = look().surfaces[0].level;
    EXPECT_NE(other, skin);
    save("two-surfaces");
    QTest::mouseClick(&on_page<QPushButton>("surface_1_feel"), Qt::LeftButton);
    wait_until_settled();
    EXPECT_EQ(window_->live()->isovalue(), other);
    EXPECT_EQ(look().surfaces[0].level, skin);
}

TEST_F(Looking, plus_and_minus_zoom_a_slice_that_has_the_focus_and_change_the_level_elsewhere) {
    feel("synthetic:sphere:48x48x48");
    SlicePane& pane = window_->views().slice(2);
    Scene& scene = window_->views().scene();
    const double level = window_->content().effect().isovalue();
    const Vec3 aside = physical_centre(window_->live()->field().geometry()) + Vec3(9, 0, 0);
    const auto seen = [&] { return pane.pixel_of(aside); };
    QTest::mouseClick(&pane, Qt::LeftButton, {}, middle(pane));
    const QPointF before = seen();
    QTest::keyClick(&pane, Qt::Key_Plus);
    EXPECT_GT((seen() - before).manhattanLength(), 3);
    QTest::keyClick(&pane, Qt::Key_Minus);
    EXPECT_LT((seen() - before).manhattanLength(), 0.1);
    EXPECT_EQ(window_->content().effect().isovalue(), level);
    scene.setFocus();
    QTest::keyClick(&scene, Qt::Key_Plus);
    EXPECT_GT(window_->content().effect().isovalue(), level);
}

TEST_F(Looking, a_click_touches_what_is_seen_behind_a_cut) {
    const Index3 size = Index3::Constant(48);
    std::vector<std::uint8_t> shell(48 * 48 * 48);
    for (int i = 0; i < int(shell.size()); ++i) {
        const Vec3 from_middle = Vec3(i % 48, i / 48 % 48, i / 2304) - Vec3::Constant(23.5);
        shell[std::size_t(i)] =
            std::uint8_t(std::max(0.0, 250 - 60 * std::abs(from_middle.norm() - 17)));
    }
    io::write_volume(Volume(Geometry{size}, std::move(shell)), scratch_.path() / "shell.nrrd");
    feel(scratch("shell.nrrd").toStdString());
    Scene& scene = window_->views().scene();
    const Vec3 towards = axes_of(scene.camera()).towards_viewer;
    const Vec3 centre = physical_centre(window_->live()->field().geometry());
    const auto touch = [&] {
        QTest::mouseClick(&scene, Qt::LeftButton, {}, middle(scene) + QPoint(40, 30));
        wait_until([&] { return !window_->probe().travelling() && force() > 0.1; });
        wait_for_hand();
        EXPECT_EQ(now().session.tick.proxy.mode, Mode::constrained);
        return (now().session.tick.proxy.scp - centre).dot(towards);
    };
    press(Qt::Key_V);
    wait_until_settled();
    EXPECT_LT(touch(), -8) << "the inside of the far wall";
    EXPECT_LT(force(), 1);
    window_->findChild<QAction*>("cut_nothing")->trigger();
    wait_until_settled();
    EXPECT_GT(touch(), 10) << "the outside of the near wall";
}

TEST_F(Looking, a_cut_by_key_faces_the_viewer_and_a_session_brings_it_back) {
    feel("synthetic:sphere:48x48x48");
    press(Qt::Key_V);
    wait_until_settled();
    EXPECT_EQ(look().cut, Cut::plane);
    const Vec3 towards = window_->views().scene().camera().towards_viewer.normalized();
    EXPECT_LT((look().cut_plane.normal - towards).norm(), 1e-9);
    EXPECT_EQ(part<QComboBox>("cut").currentIndex(), 1);
    save("cut");
    window_->files().save_session(scratch("s.json"));
    press(Qt::Key_V, Qt::ShiftModifier);
    wait_until_settled();
    EXPECT_EQ(look().cut, Cut::box);
    window_->files().open_path(scratch("s.json"));
    wait_until([&] { return look().cut == Cut::plane; });
    wait_until_settled();
}

TEST_F(Looking, the_key_of_a_cut_removes_it_again) {
    feel("synthetic:sphere:48x48x48");
    const auto cut_after = [&](Qt::KeyboardModifiers with) {
        press(Qt::Key_V, with);
        wait_until_settled();
        EXPECT_EQ(part<QComboBox>("cut").currentIndex(), int(look().cut));
        EXPECT_EQ(part<QAction>("cut_plane").isChecked(), look().cut == Cut::plane);
        EXPECT_EQ(part<QAction>("cut_box").isChecked(), look().cut == Cut::box);
        EXPECT_EQ(part<QAction>("cut_nothing").isChecked(), look().cut == Cut::nothing);
        return look().cut;
    };
    EXPECT_EQ(cut_after({}), Cut::plane);
    EXPECT_EQ(cut_after({}), Cut::nothing);
    EXPECT_EQ(cut_after(Qt::ShiftModifier), Cut::box);
    EXPECT_EQ(cut_after({}), Cut::plane) << "the other cut replaces it";
    EXPECT_EQ(cut_after(Qt::ShiftModifier), Cut::box);
    EXPECT_EQ(cut_after(Qt::ShiftModifier), Cut::nothing);
    part<QAction>("cut_nothing").trigger();
    EXPECT_EQ(look().cut, Cut::nothing);
    EXPECT_TRUE(part<QAction>("cut_nothing").isChecked());
}

TEST_F(Looking, a_double_click_on_a_slice_leaves_the_crosshair_where_it_was) {
    feel("synthetic:sphere:48x48x48");
    SlicePane& axial = window_->views().slice(2);
    const Vec3 before = window_->views().shown().crosshair;
    for (const bool follow : {true, false}) {
        window_->views().set_follow(follow);
        const QPoint at(axial.width() / 4, axial.height() / 4);
        QTest::mouseClick(&axial, Qt::LeftButton, {}, at);
        EXPECT_NE(window_->views().shown().crosshair, before) << "a click moves it";
        QTest::mouseDClick(&axial, Qt::LeftButton, {}, at);
        EXPECT_EQ(window_->views().alone() != nullptr, follow) << "alone, and again all";
        EXPECT_EQ(window_->views().shown().crosshair, before);
        EXPECT_EQ(window_->views().follows(), follow);
        QTest::lastMouseTimestamp += 1000;  // what follows is another double click
    }
}

TEST_F(Looking, a_length_and_an_angle_are_measured_in_a_slice_and_kept) {
    feel("synthetic:sphere:48x48x48");
    SlicePane& pane = window_->views().slice(2);
    const auto click = [&](const Vec3& at) {
        QTest::mouseClick(&pane, Qt::LeftButton, {}, pane.pixel_of(at).toPoint());
    };
    const double mm = 1.0 / (pane.pixel_of({1, 0, 0}) - pane.pixel_of({0, 0, 0})).x();
    const Vec3 before = window_->views().shown().crosshair;
    press(Qt::Key_M);
    EXPECT_TRUE(window_->measuring().measuring());
    click({-10, 0, 0});
    click({10, 0, 0});
    EXPECT_FALSE(window_->measuring().measuring());
    ASSERT_EQ(window_->measuring().measurements().size(), 1U);
    const auto& length = window_->measuring().measurements()[0];
    EXPECT_NEAR((length.points[1] - length.points[0]).norm(), 20, 1.5 * mm);
    EXPECT_EQ(window_->views().shown().crosshair, before)
        << "a click while measuring moves nothing";
    press(Qt::Key_M, Qt::ShiftModifier);
    click({0, 10, 0});
    click({0, 0, 0});
    click({10, 0, 0});
    ASSERT_EQ(window_->measuring().measurements().size(), 2U);
    EXPECT_NEAR(std::stod(text_of(window_->measuring().measurements()[1])), 90, 8);
    wait_until_settled();
    save("measured");
    window_->files().save_session(scratch("s.json"));
    const auto measured = window_->measuring().measurements();
    window_->measuring().remove_all();
    window_->files().open_path(scratch("s.json"));
    wait_until([&] { return window_->measuring().measurements() == measured; });
}

using DrawnLooking = Looking;

TEST_F(DrawnLooking, a_length_on_the_surface_in_the_scene_and_escape_gives_up) {
    feel("synthetic:sphere:48x48x48");
    Scene& scene = window_->views().scene();
    const auto camera = scene.camera();
    press(Qt::Key_M);
    QTest::mouseClick(&scene, Qt::LeftButton, {}, middle(scene));
    QTest::mouseClick(&scene, Qt::LeftButton, {}, QPoint(5, 5));  // beside everything
    EXPECT_TRUE(window_->measuring().measuring());
    QTest::mouseClick(&scene, Qt::LeftButton, {}, middle(scene) + QPoint(40, 0));
    ASSERT_EQ(window_->measuring().measurements().size(), 1U);
    const Field& field = window_->live()->field();
    for (const Vec3& p : window_->measuring().measurements()[0].points) {
        EXPECT_NEAR(value_at(field, p), window_->live()->isovalue(), 1e-6 * field.range())
            << "on the surface that is touched, not on its picture";
    }
    EXPECT_EQ(scene.camera().towards_viewer, camera.towards_viewer);
    press(Qt::Key_M);
    press(Qt::Key_Escape);
    EXPECT_FALSE(window_->measuring().measuring());
    EXPECT_EQ(window_->measuring().measurements().size(), 1U);
    wait_until_settled();
    save("measured");
    wait_until([&] { return part<QAction>("measure_remove_last").isEnabled(); });
    press(Qt::Key_Backspace, Qt::ShiftModifier);
    EXPECT_TRUE(window_->measuring().measurements().empty());
}

TEST_F(Looking, a_point_of_a_coarse_picture_is_measured_on_the_exact_surface) {
    feel("synthetic:sphere:48x48x48");
    wait_until_settled();
    Scene& scene = window_->views().scene();
    const Field& field = window_->live()->field();
    const Vec3 middle = physical_centre(field.geometry());
    const Vec3 towards = axes_of(scene.camera()).towards_viewer;
    const Vec3 aside = axes_of(scene.camera()).right;
    press(Qt::Key_M);
    Q_EMIT scene.point_chosen(middle + 23 * towards);
    Q_EMIT scene.point_chosen(middle + 23 * towards + 23.5 * aside);  // only in the picture
    EXPECT_TRUE(window_->measuring().measuring());
    Q_EMIT scene.point_chosen(middle + 5 * towards + 4 * aside);
    ASSERT_EQ(window_->measuring().measurements().size(), 1U);
    for (const Vec3& p : window_->measuring().measurements()[0].points) {
        EXPECT_NEAR(value_at(field, p), window_->live()->isovalue(), 1e-6 * field.range());
        EXPECT_GT((p - middle).dot(towards), 0) << "the side that is seen";
    }
}

TEST_F(Looking, a_segmentation_lies_over_slices_and_scene_with_its_names_and_colours) {
    feel("synthetic:sphere:48x48x48");
    write_segmentation(scratch_.path() / "ball.seg.nrrd");
    typing(scratch("ball.seg.nrrd"),
           [&] { QTest::mouseClick(&on_page<QPushButton>("open_overlay"), Qt::LeftButton); });
    wait_until([&] { return window_->panel().overlay_controls().overlay() != nullptr; });
    wait_until_settled();
    const Overlay& overlay = *window_->panel().overlay_controls().overlay();
    ASSERT_EQ(overlay.labels.size(), 2U);
    EXPECT_EQ(overlay.labels[0].name, "left half");
    EXPECT_EQ(overlay.labels[1].value, 7);
    auto& list = on_page<QListWidget>("overlay_labels");
    ASSERT_EQ(list.count(), 2);
    EXPECT_EQ(list.item(1)->text(), "right half");
    SlicePane& pane = window_->views().slice(2);
    const auto colour_at = [&](const Vec3& at) {
        return pane.grab().toImage().pixel(
            (pane.pixel_of(at) * pane.devicePixelRatioF()).toPoint());
    };
    set(window_->views(), &Shown::crosshair, {3, 3, 3});
    EXPECT_GT(qRed(colour_at({-8, 6, 3})), qBlue(colour_at({-8, 6, 3})) + 40);
    EXPECT_GT(qBlue(colour_at({8, 6, 3})), qRed(colour_at({8, 6, 3})) + 40);
    save("overlay");
    list.item(1)->setCheckState(Qt::Unchecked);
    wait_until([&] { return look().overlay.hidden == std::vector{7}; });
    EXPECT_LT(qBlue(colour_at({8, 6, 3})), qRed(colour_at({8, 6, 3})) + 20);
    window_->files().save_session(scratch("s.json"));
    QTest::mouseClick(&part<QPushButton>("close_overlay"), Qt::LeftButton);
    EXPECT_EQ(window_->panel().overlay_controls().overlay(), nullptr);
    window_->files().open_path(scratch("s.json"));
    wait_until([&] { return window_->panel().overlay_controls().overlay() != nullptr; });
    EXPECT_EQ(look().overlay.hidden, std::vector{7});
    wait_until_settled();
}

TEST_F(Looking, another_image_lies_over_the_slices_in_a_colour_map) {
    feel("synthetic:sphere:48x48x48");
    window_->panel().overlay_controls().open(run::source_named("synthetic:torus:40x40x40"));
    wait_until([&] { return window_->panel().overlay_controls().overlay() != nullptr; });
    EXPECT_FALSE(window_->panel().overlay_controls().overlay()->is_label_map());
    wait_until_settled();
    save("image");
    auto& level = on_page<NumberBox>("overlay_level");
    EXPECT_TRUE(level.isVisible());
    EXPECT_FALSE(part<QListWidget>("overlay_labels").isVisible());
    level.setValue(100);
    wait_until_settled();
    EXPECT_EQ(look().overlay.level, 100);
}

TEST_F(Looking, an_overlay_that_cannot_be_read_is_reported_and_the_one_before_stays) {
    feel("synthetic:sphere:48x48x48");
    write_segmentation(scratch_.path() / "ball.seg.nrrd");
    window_->panel().overlay_controls().open(
        run::source_named((scratch_.path() / "ball.seg.nrrd").string()));
    wait_until([&] { return window_->panel().overlay_controls().overlay() != nullptr; });
    window_->panel().overlay_controls().open(
        run::source_named((scratch_.path() / "none.nrrd").string()));
    wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_NE(window_->panel().overlay_controls().overlay(), nullptr);
    EXPECT_NE(window_->live(), nullptr);
    feel("synthetic:torus:40x40x40");
    EXPECT_EQ(window_->panel().overlay_controls().overlay(), nullptr)
        << "it belongs to the volume before";
}

TEST_F(Looking, pressing_through_shows_what_is_felt_and_not_a_body_in_pieces) {
    feel("synthetic:sphere:48x48x48");
    const double level = window_->views().shown().isovalue;
    window_->content().effect().request(Command(penetrability_threshold(0.3, level)));
    Scene& scene = window_->views().scene();
    ASSERT_TRUE(press_until([&] { return now().session.tick.proxy.isovalue > level + 20; }));
    EXPECT_EQ(window_->views().shown().isovalue, level) << "the whole surface stays";
    wait_until_settled();
    save("pressed-through");
    turn_wheel(scene, -60);
    wait_until([&] { return now().session.tick.proxy.mode == Mode::free; });
    wait_until_settled();
}

TEST_F(Looking, preferences_are_used_at_once_and_kept) {
    feel("synthetic:sphere:48x48x48");
    press(Qt::Key_Comma, Qt::ControlModifier);
    wait_until([&] { return window_->findChild<QDialog*>("preferences"); });
    save("preferences");
    auto& unit = part<QComboBox>("preferred_unit");
    auto& dialog = part<QDialog>("preferences");
    activate(dialog);
    unit.setFocus();
    QTest::keyClick(&unit, Qt::Key_C);
    ASSERT_EQ(unit.currentText(), "centimetres");
    part<QDoubleSpinBox>("preferred_wheel").setValue(30);
    part<QDoubleSpinBox>("preferred_triangles").setValue(0.1);
    dialog.close();
    Preferences wanted;
    wanted.appearance = saved_preferences().appearance;
    wanted.unit = LengthUnit::centimetres;
    wanted.wheel_px = 30;
    wanted.surface_millions = 0.1;
    EXPECT_EQ(saved_preferences(), wanted);
    // Twice as far as by default.
    Scene& scene = window_->views().scene();
    Vec3 dragged = Vec3::Zero();
    QObject::connect(&scene, &Scene::probe_dragged, [&](const Vec3& by) { dragged += by; });
    const ViewSize size = scene.view_size();
    turn_wheel(scene, 1);
    EXPECT_NEAR(dragged.norm(), 30 * mm_per_pixel(scene.camera(), size), 1e-9);
    QSettings().setValue("preferences/wheel_px", "nonsense");
    EXPECT_EQ(saved_preferences().wheel_px, Preferences().wheel_px);
}

TEST_F(Looking, mnemonics_are_unique_in_each_menu) {
    for (QMenu* menu : window_->findChildren<QMenu*>()) {
        std::map<QString, QString> seen;
        for (const QAction* action : menu->actions()) {
            const auto at = action->text().indexOf('&');
            if (at < 0) continue;
            const QString key = action->text().mid(at + 1, 1).toLower();
            EXPECT_TRUE(seen.emplace(key, action->text()).second)
                << action->text().toStdString() << " and " << seen[key].toStdString();
        }
    }
}

TEST_F(Looking, a_slice_fills_the_window_and_then_the_next) {
    feel("synthetic:sphere:48x48x48");
    for (const int axis : {2, 1, 0, 2}) {
        press(Qt::Key_F8);
        for (int other = 0; other < 3; ++other) {
            EXPECT_EQ(window_->views().slice(other).isVisible(), other == axis);
        }
        EXPECT_FALSE(window_->views().scene().isVisible());
    }
    press(Qt::Key_F5);
    EXPECT_TRUE(window_->views().scene().isVisible());
}

TEST_F(Looking, every_control_has_a_name_for_screen_readers) {
    feel("synthetic:sphere:48x48x48");
    int named = 0;
    const auto has_name = [](const QWidget* widget) {
        const QAccessibleInterface* const one =
            QAccessible::queryAccessibleInterface(const_cast<QWidget*>(widget));
        return one && !one->text(QAccessible::Name).trimmed().isEmpty();
    };
    for (QWidget* widget : window_->findChildren<QWidget*>()) {
        const bool is_control = widget->focusPolicy() != Qt::NoFocus && !widget->focusProxy() &&
                                !qobject_cast<QAbstractScrollArea*>(widget->parent()) &&
                                !qobject_cast<QLabel*>(widget) && !widget->isWindow() &&
                                !qobject_cast<QAbstractItemView*>(widget->parent()) &&
                                !widget->inherits("QComboBoxListView") &&
                                !widget->objectName().startsWith("qt_");
        if (!is_control) continue;
        ++named;
        EXPECT_TRUE(has_name(widget))
            << widget->metaObject()->className() << ' ' << widget->objectName().toStdString()
            << " in " << widget->parentWidget()->objectName().toStdString();
    }
    EXPECT_GT(named, 100);
}

}  // namespace
}  // namespace palpate::viewer::test
