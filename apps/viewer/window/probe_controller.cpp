// Turns drags, clicks and arrow keys into positions of the mouse device.
#include "apps/viewer/window/probe_controller.hpp"

#include <QAction>

#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/run_controller.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {

ProbeController::ProbeController(Content& content, RunController& run, Views& views,
                                 Messages& messages)
    : content_(content), views_(views), messages_(messages) {
    connect(&views, &Views::probe_dragged, this, &ProbeController::move_by);
    connect(&views, &Views::probe_aimed, this, &ProbeController::move_to);
    connect(&run, &RunController::device_changed, this, [this] { set_pointing(possible()); });
    connect(&content, &Content::playback_started, this, [this] { set_pointing(false); });
    add_keys();
}

bool ProbeController::possible() const {
    return content_.live() && content_.live()->mouse();
}

void ProbeController::set_pointing(bool probe) {
    pointing_ = probe && possible();
    views_.set_hand(pointing_);
    if (!pointing_) return;
    views_.scene().setFocus();
    messages_.show_done(
        "Drag to move the probe, turn the wheel to push it in; the right button turns the "
        "view");
}

void ProbeController::move_by(const Vec3& by) {
    const auto now = possible() ? content_.snapshot() : std::nullopt;
    if (!now) return;
    const DeviceTransform& transform = now->session.transform;
    devices::Mouse& mouse = *content_.live()->mouse();
    mouse.aim(mouse.aimed() + transform.rotation.transpose() * by / transform.scale);
}

void ProbeController::move_to(const Vec3& to) {
    const auto now = possible() ? content_.snapshot() : std::nullopt;
    if (now) content_.live()->mouse()->aim(device_from_physical(now->session.transform, to));
}

void ProbeController::nudge(const Vec3& screen) {
    if (!content_.live()) return;
    const ViewAxes axes = axes_of(views_.scene().camera());
    const double step = content_.live()->field().geometry().spacing.minCoeff();
    move_by(step *
            (screen[0] * axes.right + screen[1] * axes.up + screen[2] * axes.towards_viewer));
}

void ProbeController::add_keys() {
    struct Key {
        QString text;
        int key;
        Vec3 step;
    };
    const Key keys[] = {
        {"Nudge the probe to the left", Qt::Key_Left, {-1, 0, 0}},
        {"Nudge the probe to the right", Qt::Key_Right, {1, 0, 0}},
        {"Nudge the probe up", Qt::Key_Up, {0, 1, 0}},
        {"Nudge the probe down", Qt::Key_Down, {0, -1, 0}},
        {"Nudge the probe into the depth", Qt::Key_PageUp, {0, 0, -1}},
        {"Nudge the probe towards you", Qt::Key_PageDown, {0, 0, 1}},
    };
    // Only where the scene has the focus: elsewhere arrows belong to sliders, numbers and slices.
    for (const Key& key : keys) {
        for (const bool far : {false, true}) {
            auto* action = new QAction(far ? key.text + " by ten voxels" : key.text, &views_);
            action->setShortcut(QKeySequence(key.key + (far ? int(Qt::ShiftModifier) : 0)));
            action->setShortcutContext(Qt::WidgetShortcut);
            const Vec3 step = (far ? 10 : 1) * key.step;
            connect(action, &QAction::triggered, this, [this, step] { nudge(step); });
            views_.scene().addAction(action);
        }
    }
    views_.scene().setFocusPolicy(Qt::StrongFocus);
}

}  // namespace palpate::viewer
