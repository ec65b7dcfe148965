// Clicks and drags on scene and slices that move the hand or do not, by events with times of their
// own.
#include <QApplication>
#include <QStatusBar>

#include "apps/viewer/model/probe_route.hpp"
#include "apps/viewer/scene/navigation.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class Clicks : public InWindow {
  protected:
    void open() {
        feel("synthetic:sphere:48x48x48");
        before_ = aimed();
    }
    Vec3 aimed() { return window_->live()->mouse()->aimed(); }
    Scene& scene() { return window_->views().scene(); }
    /// `time` [ms] is that of the window system.
    void send(QEvent::Type type, QWidget& pane, const QPoint& at, ulong time) {
        const Qt::MouseButton held =
            type == QEvent::MouseButtonRelease ? Qt::NoButton : Qt::LeftButton;
        QMouseEvent event(type, at, pane.mapToGlobal(at),
                          type == QEvent::MouseMove ? Qt::NoButton : Qt::LeftButton, held, {});
        event.setTimestamp(time);
        QApplication::sendEvent(&pane, &event);
        QApplication::processEvents();
    }
    /// With so much motion while the button is down.
    void click(QEvent::Type press, QWidget& pane, const QPoint& at, ulong time, int motion = 0) {
        send(press, pane, at, time);
        if (motion > 0) send(QEvent::MouseMove, pane, at + QPoint(motion, 0), time + 20);
        send(QEvent::MouseButtonRelease, pane, at + QPoint(motion, 0), time + 40);
    }
    void click_with_ctrl(SlicePane& pane, const Vec3& to) {
        QTest::mouseClick(&pane, Qt::LeftButton, Qt::ControlModifier, pane.pixel_of(to).toPoint());
        wait_until([&] { return !window_->probe().travelling(); });
        wait_for_hand();
        wait_for_ticks(4);
    }

    Vec3 before_;
};

TEST_F(Clicks, a_double_click_that_trembles_and_a_third_click_move_no_hand) {
    open();
    const QPoint at = scene().rect().center() + QPoint(40, 30);
    click(QEvent::MouseButtonPress, scene(), at, 1000, 2);
    click(QEvent::MouseButtonDblClick, scene(), at, 1150, 2);
    click(QEvent::MouseButtonPress, scene(), at, 1300);
    EXPECT_EQ(window_->views().alone(), &scene());
    EXPECT_FALSE(window_->probe().travelling());
    EXPECT_EQ(aimed(), before_);
    // The fourth one is the second of another pair to Qt.
    click(QEvent::MouseButtonDblClick, scene(), at, 1400);
    EXPECT_EQ(window_->views().alone(), &scene());
    EXPECT_FALSE(window_->probe().travelling());
    click(QEvent::MouseButtonPress, scene(), at, 3000);
    EXPECT_TRUE(window_->probe().travelling()) << "one that comes later is a click again";
}

TEST_F(Clicks, the_third_click_may_land_on_another_pane) {
    open();
    SlicePane& axial = window_->views().slice(2);
    const QPoint there = scene().mapToGlobal(scene().rect().center());
    window_->views().toggle_alone(&axial);
    QApplication::processEvents();
    click(QEvent::MouseButtonPress, axial, axial.mapFromGlobal(there), 1000);
    click(QEvent::MouseButtonDblClick, axial, axial.mapFromGlobal(there), 1150);
    ASSERT_EQ(window_->views().alone(), nullptr);
    click(QEvent::MouseButtonPress, scene(), scene().mapFromGlobal(there), 1300);
    EXPECT_FALSE(window_->probe().travelling());
    EXPECT_EQ(aimed(), before_);
}

TEST_F(Clicks, one_with_a_pixel_of_motion_is_a_touch) {
    open();
    click(QEvent::MouseButtonPress, scene(), scene().rect().center(), 1000, 1);
    EXPECT_TRUE(window_->probe().travelling());
    wait_until([&] { return !window_->probe().travelling(); });
    wait_until([&] { return force() > 0.1; });
    EXPECT_LT(force(), 0.6);
}

TEST_F(Clicks, a_drag_that_goes_farther_moves_the_hand_by_the_whole_way) {
    open();
    const QPoint at = scene().rect().center();
    drag(scene(), at, at + QPoint(40, 0));
    EXPECT_FALSE(window_->probe().travelling());
    const Vec3 moved = aimed() - before_;
    const double mm = mm_per_pixel(scene().camera(), scene().view_size());
    EXPECT_NEAR(moved.norm() * now().session.transform.scale, 40 * mm, 0.01 * mm);
}

TEST_F(Clicks, with_ctrl_into_a_body_touch_it_lightly_in_front) {
    open();
    SlicePane& axial = window_->views().slice(2);
    click_with_ctrl(axial, Vec3::Zero());
    wait_until([&] { return force() > 0.1; });
    EXPECT_LT(force(), 0.6);
    EXPECT_TRUE(window_->statusBar()->currentMessage().contains("inside"))
        << window_->statusBar()->currentMessage().toStdString();
    const Vec3 hip = now().session.tick.proxy.hip;
    QTest::mousePress(&axial, Qt::LeftButton, Qt::ControlModifier, axial.pixel_of(hip).toPoint());
    wait_for_ticks(4);
    EXPECT_LT((now().session.tick.proxy.hip - hip).norm(), 0.1) << "the probe is there already";
}

TEST_F(Clicks, with_ctrl_on_a_surface_touch_that_also_behind_the_body) {
    open();
    const double level = window_->live()->isovalue();
    Vec3 behind = -axes_of(scene().camera()).towards_viewer;
    const auto far = surface_under(window_->live()->field(), level, Vec3::Zero(), behind);
    const Vec3 place = far.value();
    // The axial slice, or the coronal where the view is from above.
    SlicePane& pane = window_->views().slice(std::abs(behind[2]) < 0.5 ? 2 : 1);
    const Vec3 wanted = pane.point_at(QPointF(pane.pixel_of(place).toPoint()));
    click_with_ctrl(pane, place);
    EXPECT_LT((now().session.tick.proxy.scp - wanted).norm(), 2);
    EXPECT_LT(force(), 0.6);
    EXPECT_NE(aimed(), before_);
}

}  // namespace
}  // namespace palpate::viewer::test
