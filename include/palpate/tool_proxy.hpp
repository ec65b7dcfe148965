// Tool proxy: the pose of a rigid tool that stays on the free side of the isosurface while the hand
// presses and turns it into the solid, on the smooth field (docs/tools.md). No point of the tool
// ever goes through the surface. Only the construction of a proxy allocates, locks or throws.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "palpate/proxy.hpp"
#include "palpate/tool.hpp"

namespace palpate {

struct ToolSettings {
    /// A contact does not slip until the tangential pull exceeds the static coefficient times its
    /// pressure. Then it follows the hand with the dynamic one.
    Friction friction = {};
    /// Largest work per update, in the units of ProxySettings::step_budget. In addition, an update
    /// may examine each point of the tool once, or twice during recovery, and gather the samples
    /// for this. Later updates continue the work. With a thousand points, an update takes at most
    /// 0.6 ms. Faster loops need a smaller budget.
    int work_budget = 4096;
    /// [mm] Replaces the tool's own gyration: 1e-10 to 1e10. 0: the tool's own.
    double gyration = 0;
};

/// A point of the tool that touches, or nearly.
struct ToolContact {
    int point = 0;               ///< of the tool
    Vec3 place = Vec3::Zero();   ///< [mm, physical]
    Vec3 normal = Vec3::Zero();  ///< unit, out of the solid, physical axes
    double pressure = 0;         ///< share of the pull that it holds [mm]; 0: does not touch
};
inline constexpr int most_tool_contacts = 32;

struct ToolUpdate {
    UpdateStatus status = UpdateStatus::done;
    Mode mode = Mode::free;
    Pose hand;         ///< that of the device
    Pose proxy;        ///< the same bit for bit if it was reached
    int contacts = 0;  ///< how many points hold the proxy
    int rounds = 0;    ///< number of steps, each along a direction of its own
    int work = 0;      ///< of the work budget
    /// [mm] The distance from the pose up to which recovery has searched free space for the
    /// reference point.
    double searched = 0;
};

namespace tool {

struct Kept;
/// Results that updates keep to save time. Private to the proxy. Copies are independent.
class Keeper {
  public:
    Keeper();
    Keeper(const Keeper& other);
    Keeper(Keeper&&) noexcept;
    Keeper& operator=(Keeper other) noexcept;
    ~Keeper();
    Kept& operator*() const { return *kept_; }

  private:
    std::unique_ptr<Kept> kept_;
};

}  // namespace tool

/// The state between updates, without results that only save time.
struct ToolState {
    Pose pose;
    Mode mode = Mode::free;
    bool placed = false;   ///< false: the next update starts at the hand's pose
    bool sliding = false;  ///< dynamic friction applies
    std::array<ToolContact, most_tool_contacts> contacts{};
    std::array<int, most_tool_contacts> idle{};  ///< updates for which a contact had no pressure
    int contact_count = 0;          ///< contacts known, those without pressure included
    double trust = 1, stride = 64;  ///< longest steps [voxel], in contact and with nothing near
};

/// The proxy. Set `isovalue` freely between two updates. Copies are independent.
class ToolProxy : public ToolState {
  public:
    /// Allocates the memory that updates need. Not null.
    explicit ToolProxy(std::shared_ptr<const Tool> tool);

    const Tool& tool() const { return *tool_; }
    /// Allocates the memory that use() needs for tools of this many points. Changes nothing else.
    void make_room(std::size_t points);
    /// Another tool from the next update on, at the same pose. If it is inside the solid there,
    /// recovery follows. Allocates nothing. Frees the previous tool unless it is held elsewhere.
    /// False, without any change, if there is no room for its points.
    bool use(std::shared_ptr<const Tool> tool) noexcept;
    double isovalue = 0;  ///< [data units]

    tool::Kept& kept() const { return *kept_; }

  private:
    std::shared_ptr<const Tool> tool_;
    tool::Keeper kept_;
};

/// Called with every pose of the proxy. Between two of them, each point of the tool travels along a
/// straight line.
struct PoseObserver {
    void (*on_pose)(const Pose& pose, void* context) = nullptr;
    void* context = nullptr;
};

/// Moves the proxy for one pose of the hand. Guarantees, with r = field.range():
/// T1 between two successive poses every point of the tool goes straight, and no point of its way
/// has
///    sign * (f - isovalue) / r > 1e-9 (recovery excepted); each pose is exactly rigid;
/// T2 points that hold the proxy have |f - isovalue| / r <= 1e-6;
/// T3 at rest the pose is optimal to first order: at most 3e-4 of the pull remains along directions
/// that the contacts allow;
/// T4 the distance to the hand, sqrt(|translation|^2 + |gyration * rotation|^2), never grows (field
///    and isovalue unchanged); T3 and T4 without friction;
/// T5 bounded work, and never NaN.
/// Refused: a field that is not cubic, a pose that is not finite or farther than `farthest_hip`, a
/// tool whose radius is more than `farthest_hip` voxels, a gyration out of range, friction below 0.
ToolUpdate update_tool(ToolProxy& proxy, const Field& field, const Pose& hand,
                       const ToolSettings& settings = {}, PoseObserver observer = {});

}  // namespace palpate
