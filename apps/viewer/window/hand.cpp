// The mouse and the keys as a hand.
#include <Eigen/Geometry>

#include <QAction>
#include <QStatusBar>

#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {

/// Moves what the pointer aims at by so much [mm, physical].
void MainWindow::drag_probe(const Vec3& by) {
    const auto now = live_ && live_->mouse() ? live_->snapshot() : std::nullopt;
    if (!now) return;
    const DeviceTransform& transform = now->session.transform;
    live_->mouse()->aim(live_->mouse()->aimed() +
                        transform.rotation.transpose() * by / transform.scale);
}

void MainWindow::aim_probe(const Vec3& to) {
    const auto now = live_ && live_->mouse() ? live_->snapshot() : std::nullopt;
    if (now) live_->mouse()->aim(device_from_physical(now->session.transform, to));
}

/// `screen`: to the right, up, towards the viewer, in steps.
void MainWindow::nudge(const Vec3& screen) {
    if (!live_) return;
    const pictures::Camera camera = views_->scene().camera();
    const Vec3 back = camera.towards_viewer.normalized();
    const Vec3 right = Vec3(camera.up).cross(back).normalized();
    const double step = live_->field().geometry().spacing.minCoeff();
    drag_probe(step * (screen[0] * right + screen[1] * back.cross(right) + screen[2] * back));
}

void MainWindow::make_hand_actions() {
    struct Key {
        QString text;
        int key;
        Vec3 step;
    };
    const Key keys[] = {
        {tr("Nudge the probe to the left"), Qt::Key_Left, {-1, 0, 0}},
        {tr("Nudge the probe to the right"), Qt::Key_Right, {1, 0, 0}},
        {tr("Nudge the probe up"), Qt::Key_Up, {0, 1, 0}},
        {tr("Nudge the probe down"), Qt::Key_Down, {0, -1, 0}},
        {tr("Nudge the probe into the depth"), Qt::Key_PageUp, {0, 0, -1}},
        {tr("Nudge the probe towards you"), Qt::Key_PageDown, {0, 0, 1}},
    };
    // Where the scene has the focus: elsewhere arrows belong to sliders, numbers and slices.
    for (const Key& key : keys) {
        for (const bool far : {false, true}) {
            auto* action = new QAction(far ? key.text + tr(" by ten voxels") : key.text, this);
            action->setShortcut(QKeySequence(key.key + (far ? int(Qt::ShiftModifier) : 0)));
            action->setShortcutContext(Qt::WidgetShortcut);
            const Vec3 step = (far ? 10 : 1) * key.step;
            connect(action, &QAction::triggered, this, [this, step] { nudge(step); });
            views_->scene().addAction(action);
        }
    }
    views_->scene().setFocusPolicy(Qt::StrongFocus);
}

void MainWindow::use_pointer_for(bool probe) {
    const bool can = live_ && live_->mouse();
    views_->set_hand(probe && can);
    auto* action = findChild<QAction*>("pointer");
    action->setEnabled(can);
    action->setChecked(probe && can);
    if (probe && can) {
        views_->scene().setFocus();
        statusBar()->showMessage(
            tr("Drag to move the probe, turn the wheel to push it in; the right button turns the "
               "view"));
    }
}

}  // namespace palpate::viewer
