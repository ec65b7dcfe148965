// Stage 7, proxy: the point that stays on the free side of the isosurface while the hand presses
// into it (Corenthy et al. 2012, section 4), and penetrability, which presses it through surfaces.
// A proxy is a small value that can be copied. No update allocates, locks or throws.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "palpate/cubic.hpp"
#include "palpate/names.hpp"

namespace palpate {

/// Whether the proxy follows the hand or rests on the surface.
enum class Mode : std::uint8_t { free, constrained };

/// How an update ended. After any other status than `done` and `refused`, later updates continue.
enum class UpdateStatus : std::uint8_t {
    done,           ///< the SCP has its final place for this HIP
    out_of_budget,  ///< step budget used up: the SCP is valid, the next update continues from it
    recovering,     ///< the SCP is still inside the solid: render no force
    /// HIP not finite or farther than `farthest_hip`, or friction below 0 or NaN: nothing was
    /// changed
    refused,
    not_finite,  ///< the SCP would be NaN or infinite: nothing was changed, render no force
    waiting,     ///< held, because samples that it needs are not in memory: render no force
};

/// Farthest HIP outside the grid [voxel] that an update accepts. The rounding error of a step grows
/// with its target's distance: up to here G1 and G2 hold (docs/proxy.md, "Domain").
inline constexpr double farthest_hip = 1e5;

/// The last piece that an update computed, for the next update, which usually begins in the same
/// tetrahedron. It is used only if all of its inputs are the same. Private to the proxy.
class KeptPiece {
    friend struct CubicSite;
    friend struct Kept;
    double isovalue = 0;  // less the field's offset [data units]
    double sign = 0;
    Tetrahedron tetrahedron;
    cubic::Piece piece;  // of the excess, sign * (f - isovalue)
    // An upper bound of the excess in the tetrahedron's cube, times cubic::scale: the greatest
    // excess of the samples around it. Infinity until it was computed.
    double most = std::numeric_limits<double>::infinity();
};
/// A sample and its neighbours, bit for bit, with their type. Private to the proxy.
class KeptSamples {
    friend struct Kept;
    int type = 0;  // none
    std::array<std::byte, 27 * sizeof(double)> bytes{};
};

/// The state between updates. Set `isovalue` freely between two updates.
struct Proxy {
    LatticePoint scp;                  ///< surface contact point, of the lattice of `interpolation`
    Vec3 scp_physical = Vec3::Zero();  ///< the same [mm]
    double isovalue = 0;               ///< [data units]
    /// A second level, on the free side of the isovalue. The SCP stays between the two levels, and
    /// touches this one from its solid side. Without a value, the free side has no second level.
    /// For update_exact() and update_straight().
    std::optional<double> behind;
    bool turned = false;  ///< the last surface touched was that of `behind`
    Mode mode = Mode::free;
    Interpolation interpolation = Interpolation::linear;  ///< of the field of the last update
    bool placed = false;        ///< false: the next update starts at its HIP
    bool sliding = false;       ///< dynamic friction applies
    double recovery_reach = 0;  ///< [voxel] how far recovery has searched for free space so far
    /// Unit normal of the surface that was touched before the field changed, physical axes. Zero:
    /// none
    Vec3 normal_before = Vec3::Zero();
    // These save time on a cubic field and change no result.
    KeptPiece kept;
    KeptSamples kept_samples;  ///< from which its piece was computed
};

/// Coulomb friction as a cone on the proxy's motion: it stays until the tangential pull exceeds
/// `static_coefficient` times the normal pull, then follows the hand with `dynamic_coefficient`.
struct Friction {
    double static_coefficient = 0;
    double dynamic_coefficient = 0;  ///< at most the static one
};

struct ProxySettings {
    Friction friction = {};
    Friction behind = {};  ///< at the level behind
    /// Largest work per update, in units of some 500 instructions, which take 30 to 100 ns. A step
    /// through a tetrahedron counts as 1, its polynomial as 1 more, and other work likewise
    /// (docs/proxy.md, "The budget"). 4096 are 500 voxels of travel through free space, far more
    /// than a hand moves in a tick, and take at most half a tick at 1 kHz. Faster loops need a
    /// smaller budget.
    int step_budget = 4096;
};

/// Kinds of steps of an update, for figures, path files and tests.
enum class StepKind : std::uint8_t {
    place,      ///< first position, before anything moved
    free_move,  ///< straight motion through free space
    cross,      ///< a wall was crossed on that straight motion (no corner)
    goal,       ///< nothing moved: `goal` is the constrained goal of the step that follows
    slide,      ///< motion along the surface inside one tetrahedron
    recover,    ///< motion out of the solid after the field or the isovalue changed
    press,      ///< the penetrability stage moved the SCP
};
struct Step {
    StepKind kind;
    Vec3 point;  ///< SCP after the step [mm, physical]
    Vec3 goal;   ///< towards which it moved [mm, physical]
    Tetrahedron tetrahedron;
};
/// `on_step` is called for each step, unless it is null. Null costs nothing.
struct StepObserver {
    void (*on_step)(const Step& step, void* context) = nullptr;
    void* context = nullptr;
};

struct ProxyUpdate {
    UpdateStatus status = UpdateStatus::done;
    Mode mode = Mode::free;
    Vec3 hip = Vec3::Zero();  ///< [mm, physical]
    Vec3 scp = Vec3::Zero();  ///< [mm, physical]; equal to hip bit for bit if it was reached
    double density = 0;       ///< f(SCP) [data units]
    double isovalue = 0;  ///< [data units] of the touched surface. In free space: of the one ahead
    bool behind = false;  ///< the touched surface is that of Proxy::behind
    int tetrahedra = 0;   ///< number of tetrahedra that the SCP moved through
    int work = 0;         ///< of the step budget
    double searched = 0;  ///< [mm] how far from the SCP recovery has looked for free space
    int level = 0;        ///< level of detail of the samples at the SCP (stores)
};

/// True if the spring between SCP and HIP acts: in contact, and after an update out of budget. If
/// it acted only in contact, a hand could move away from a free SCP without work, and the spring
/// would give this energy to the hand at the next surface.
inline bool pulls(const ProxyUpdate& update) {
    return update.mode == Mode::constrained || update.status == UpdateStatus::out_of_budget;
}

/// A proxy method moves the proxy for one HIP [mm, physical]. All methods have this form, so a
/// renderer can use any of them.
using ProxyMethod = ProxyUpdate (*)(Proxy& proxy, const Field& field, const Vec3& hip,
                                    const ProxySettings& settings, StepObserver observer);

/// The default method, "exact descent", on linear (docs/proxy.md) and cubic fields
/// (docs/smooth.md). Guarantees, with r = field.range():
/// G1 every point of the SCP's path has sign * (f - isovalue) / r <= 1e-9 (recovery excepted);
/// G2 constrained: |f(SCP) - isovalue| / r <= 1e-9;
/// G3 no free straight motion of 1e-3 voxel leads closer to the HIP (frictionless; on a cubic field
///    by more than 2e-3 of its length);
/// G4 the distance to the HIP [mm] never grows (frictionless, field and isovalue unchanged);
/// G5 no more work per update than `step_budget`, and never NaN.
ProxyUpdate update_exact(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings = {}, StepObserver observer = {});

/// Moves the proxy straight to the HIP until it meets the surface, without sliding, like the tip of
/// a needle. Keeps G1, G2, G4 and G5. No friction.
ProxyUpdate update_straight(Proxy& proxy, const Field& field, const Vec3& hip,
                            const ProxySettings& settings = {}, StepObserver observer = {});

/// Puts the proxy at `hip` if that point is free, else at the free point that recovery finds. Its
/// time is not bounded, so it is not for the servo thread. False if all of space is solid.
bool place(Proxy& proxy, const Field& field, const Vec3& hip, double isovalue,
           StepObserver observer = {});

/// Call it before the field is exchanged or its time changes. It stores the normal of the surface
/// that the proxy touches, so that recovery moves the proxy to the same side of a wall that moves
/// over it, however thin the wall is.
void field_will_change(Proxy& proxy, const Field& field);

/// Unit normal of the level set at the SCP, out of the solid, physical axes. Zero where the field
/// is constant. At the level behind it points into the layer that contains the SCP. On a wall
/// between tetrahedra it is the normal in one of them.
Vec3 normal_at(const Proxy& proxy, const Field& field);

/// The first point of a straight segment on the isosurface, from an exact walk in the lattice.
struct RayHit {
    bool hit = false;
    Vec3 point = Vec3::Zero();   ///< [mm, physical]. The segment's end without a hit
    Vec3 normal = Vec3::Zero();  ///< unit, out of the solid, physical axes
};
/// `from` and `to` in mm, physical. A start inside the solid is a hit at `from`.
RayHit cast_ray(const Field& field, double isovalue, const Vec3& from, const Vec3& to,
                int step_budget = std::numeric_limits<int>::max());

// Penetrability presses a proxy through surfaces (Corenthy et al. 2012, section 5, Eq. 5 and Fig.
// 7). Beyond a threshold the surface gives way, and the isovalue follows the hand inwards, and
// outwards again, so that one press explores all levels of a data set.

/// Levels that may be touched, both ends included [data units].
struct DensityRange {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
};
template <>
inline constexpr auto settings_of<DensityRange> =
    std::tuple{setting(&DensityRange::low, "low", "data units", "Lowest level that is touched"),
               setting(&DensityRange::high, "high", "data units", "Highest level that is touched")};

/// The input of a penetrability function in each constrained tick.
struct Pressing {
    double isovalue;  ///< level felt now [data units]
    double pull;      ///< |SCP - HIP| [device mm]
    Vec3 scp, hip;    ///< [mm, physical]
};
/// A penetrability function returns the penetration threshold PT [device mm] at which the surface
/// gives way in this tick. Infinity: it does not give way. Called on the servo thread: it must not
/// allocate, lock or throw. A negative or NaN result counts as 0.
using PenetrabilityFunction = double (*)(const Pressing& pressing, const void* context);

/// When surfaces give way, and which levels may be touched. A plain value, so it can be sent to a
/// running servo thread. It may change between any two ticks.
struct Penetrability {
    static constexpr int most_ranges = 16;

    bool on = false;
    /// PT [device mm] without a function. The spring force (Eq. 4) never exceeds k PT; damping and
    /// viscosity are added to it.
    double threshold = 1;
    PenetrabilityFunction function = nullptr;
    const void* context = nullptr;  ///< given to `function`. Must outlive its use
    /// Disjoint and in the order in which the hand meets them (rising; falling for solid below).
    std::array<DensityRange, most_ranges> ranges{};
    int range_count = 1;
};

/// Off: the level stays as it is now. If the hand is past the last range, the level is infinity and
/// nothing can be touched: set `proxy.isovalue` then.
Penetrability no_penetrability();
/// Threshold: the surface gives way at PT [device mm]. Levels below `minimum` are not touched (with
/// Solid::below, those above it). Throws std::invalid_argument unless PT >= 0.
Penetrability penetrability_threshold(double threshold, double minimum, Solid solid = Solid::above);
/// Ranges of interest: only these levels are touched. Between two of them the proxy is free. Ranges
/// may overlap and come in any order. Throws std::invalid_argument for PT < 0, no range, NaN, low >
/// high or more than 16.
Penetrability penetrability_ranges(double threshold, std::span<const DensityRange> ranges,
                                   Solid solid = Solid::above);

/// Throws std::invalid_argument, with the reason, for a value that is on and not valid for this
/// side: PT is NaN or below 0, ranges are out of order, or there are none or too many.
void check(const Penetrability& penetrability, Solid solid);

/// Applied after a proxy update (Fig. 7): if the surface gives way, moves the proxy and sets the
/// level there. Changes `proxy` (SCP, isovalue, mode) and `update`. `device_per_volume`: device mm
/// per mm of physical space. Updates that are not `done` are left unchanged.
///
/// With penetrability on, G1 and G2 hold for the level felt at the end of the tick. When the
/// surface gives way, the SCP passes through the solid (StepKind::press). A press that
/// ends between two ranges leaves a free SCP at a distance of PT from the HIP. The next update
/// closes it. Past the last range the isovalue is infinity (minus infinity where `solid` is below).
void apply_penetrability(const Penetrability& penetrability, const Field& field,
                         double device_per_volume, Proxy& proxy, ProxyUpdate& update,
                         StepObserver observer = {});

}  // namespace palpate
