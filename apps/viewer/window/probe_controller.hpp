// Mouse and keys as the hand: they move the probe where the device of the live run is the mouse.
#pragma once

#include <QElapsedTimer>
#include <optional>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/window/desk.hpp"

namespace palpate::viewer {

class ProbeController : public Controller {
    Q_OBJECT

  public:
    explicit ProbeController(const Desk& desk);

    /// Whether the mouse is the device.
    bool possible() const;
    /// Whether the left button moves the probe, not the view.
    bool pointing() const;
    void set_pointing(bool probe);
    /// Moves what the mouse aims at [mm, physical], not beyond the far side of the grid.
    void move_by(const Vec3& by);
    void move_to(const Vec3& to);
    /// Lifts the hand and brings it from outside to a point of a slice. Where a surface is in the
    /// way, probe or tool touches that lightly and goes no deeper.
    void reach(const Vec3& to);
    /// `screen`: to the right, up, towards the viewer [voxels].
    void nudge(const Vec3& screen);
    /// Turns the tool by a rotation vector [radians, physical axes].
    void turn_by(const Vec3& rotation);
    /// Lifts the hand, wherever it is, and brings it from in front to the surface under a point of
    /// the picture, until probe or tool touches lightly; nothing where the probe is there already,
    /// or there is no surface.
    void touch(const Vec3& at);

    /// Sixty times a second: goes on with what takes time.
    void observe();
    /// The probe is on its way to where it was sent.
    bool travelling() const;

  Q_SIGNALS:
    /// The hand is off the volume, on its way to where it was sent; or has arrived.
    void lifted(bool off);

  private:
    void add_keys();
    Vec3 towards_viewer() const;
    Vec3 in_view(const Vec3& screen) const;
    Vec3 aimed(const DeviceTransform& transform) const;
    void aim(const DeviceTransform& transform, const Vec3& physical);
    std::vector<Vec3> tool_points(const DeviceTransform& transform) const;
    double touch_depth(const DeviceTransform& transform) const;
    void send_to(const DeviceTransform& transform, const Vec3& to, const Vec3& towards);
    void forget_press();
    void take_over();
    void end_route();
    void drop_route();
    void approach(const Snapshot& now);
    void travel(const Snapshot& now);
    void press_deeper(const Snapshot& now);
    Vec3 before_far_side(const Vec3& from, const Vec3& by);

    // A run has begun: to the first surface, once there is a tick and the hand is chosen.
    PerHand<bool> approaching_;
    PerHand<std::optional<Vec3>> came_from_;  // the side from which the last route led to its end
    std::vector<Vec3> route_;                 // stops to come, the next one last [mm, physical]
    bool behind_cut_ = false;                 // its last part but one goes through what is cut away
    std::optional<Vec3> pressed_;  // where the button went down, until it is a touch or a drag
    QElapsedTimer since_;          // then
    bool held_ = false;            // since then, without a drag
    double pressed_seconds_ = 0;   // of it, for which the probe has gone deeper
};

}  // namespace palpate::viewer
