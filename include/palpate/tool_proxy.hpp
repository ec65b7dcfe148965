// Tool proxy: the pose of a rigid tool that stays on the free side of the isosurface while
// the hand presses and turns it into the solid, on the smooth field (docs/tools.md). No point of
// the tool ever goes through. Nothing here but the making of a proxy allocates, locks or throws.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "palpate/proxy.hpp"
#include "palpate/tool.hpp"

namespace palpate {

struct ToolSettings {
    /// At each contact: it does not slip until the tangential pull exceeds the static coefficient
    /// times its pressure, and then trails the hand at the dynamic one.
    Friction friction = {};
    /// Most rounds of an update: each finds a direction and goes along it. An update that finds no
    /// way on before it is at rest ends as one that is out of budget.
    int most_rounds = 60;
    /// Most work of an update: cubes of the lattice looked at, 0.15 microseconds each, and all else
    /// that takes as long. One for each point of the tool comes on top, two while it is brought out
    /// of the solid. Later updates finish what is left. A thousand points take 0.8 ms at most;
    /// faster loops need a smaller budget.
    int work_budget = 4096;
    /// [mm] in place of the tool's own; 0: that.
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
    Pose proxy;        ///< the same to the bit where it was reached
    int contacts = 0;  ///< how many points hold the proxy
    int rounds = 0;
    int work = 0;  ///< of the work budget
    /// [mm] How far from its pose recovery has looked for free space for the reference point.
    double searched = 0;
};

namespace tool {

struct Kept;
/// What updates keep to save time: nobody else looks into it. Copies are independent.
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

/// The state between updates. Set `isovalue` freely between two updates. Copies are independent.
class ToolProxy {
  public:
    /// Allocates what updates need. Not null.
    explicit ToolProxy(std::shared_ptr<const Tool> tool);

    const Tool& tool() const { return *tool_; }
    /// Allocates what use() needs for tools of this many points. Changes nothing else.
    void make_room(std::size_t points);
    /// Another tool from the next update on, at the same pose; recovers where that is inside.
    /// Allocates nothing; frees the tool before unless somebody else holds it. False, and nothing
    /// changes: there is no room for its points.
    bool use(std::shared_ptr<const Tool> tool) noexcept;
    Pose pose;
    double isovalue = 0;  ///< [data units]
    Mode mode = Mode::free;
    bool placed = false;  ///< false: the next update starts at the hand's pose
    std::array<ToolContact, most_tool_contacts> contacts{};
    int contact_count = 0;  ///< contacts known, those without pressure included
    bool sliding = false;   ///< dynamic friction applies

    tool::Kept& kept() const { return *kept_; }

  private:
    std::shared_ptr<const Tool> tool_;
    tool::Keeper kept_;
};

/// Called with every pose that the proxy goes to: between two of them each point of the tool
/// travels a straight line.
struct PoseObserver {
    void (*on_pose)(const Pose& pose, void* context) = nullptr;
    void* context = nullptr;
};

/// Moves the proxy for one pose of the hand. Guarantees, with r = field.range():
/// T1 between two successive poses every point of the tool goes straight, and no point of its way
/// has
///    sign * (f - isovalue) / r > 1e-9 (recovery excepted); each pose is exactly rigid;
/// T2 points that hold the proxy have |f - isovalue| / r <= 1e-6;
/// T3 at rest the pose is optimal to first order: what is left of the pull, projected on what the
///    contacts allow, is at most 3e-4 of it;
/// T4 the distance to the hand, sqrt(|translation|^2 + |gyration * rotation|^2), never grows (field
///    and isovalue unchanged); T3 and T4 without friction;
/// T5 bounded work, and never NaN.
/// Refused: a field that is not cubic, a pose that is not finite or farther than `farthest_hip`, a
/// tool whose radius is more than `farthest_hip` voxels.
ToolUpdate update_tool(ToolProxy& proxy, const Field& field, const Pose& hand,
                       const ToolSettings& settings = {}, PoseObserver observer = {});

}  // namespace palpate
