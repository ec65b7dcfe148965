// Stage 7, proxy: the point that stays on the free side of the isosurface while the hand presses
// into it (Corenthy et al. 2012, section 4). A proxy is a small value: copy it and there are two.
// Nothing here allocates, locks or throws.
#pragma once

#include <limits>

#include "palpate/lattice.hpp"

namespace palpate {

/// Whether the proxy follows the hand or rests on the surface.
enum class Mode : std::uint8_t { free, constrained };

/// How an update ended. Anything but `done` and `refused` is finished by later updates.
enum class UpdateStatus : std::uint8_t {
    done,           ///< the SCP is where the method puts it
    out_of_budget,  ///< step budget used up: the SCP is valid, the next update goes on from it
    recovering,     ///< the SCP is still inside the solid: render no force
    refused,        ///< HIP not finite or absurdly far (1e9 voxels): nothing was changed
};

/// The state between updates. Set `isovalue` freely between two updates.
struct Proxy {
    LatticePoint scp;                  ///< surface contact point, index space
    Vec3 scp_physical = Vec3::Zero();  ///< the same [mm]
    double isovalue = 0;               ///< [data units]
    Mode mode = Mode::free;
    bool placed = false;        ///< false: the next update starts at its HIP
    bool sliding = false;       ///< dynamic friction applies
    double recovery_reach = 0;  ///< [voxel] how far the way out was searched so far
    /// Unit normal of the surface felt before the field changed, physical axes; zero: none
    Vec3 ahead = Vec3::Zero();
};

/// Coulomb friction as a cone on the proxy's motion: it stays until the tangential pull exceeds
/// `static_coefficient` times the normal pull, then trails the hand at `dynamic_coefficient`.
struct Friction {
    double static_coefficient = 0;
    double dynamic_coefficient = 0;  ///< at most the static one
};

struct ProxySettings {
    Friction friction;
    /// Most straight pieces (tetrahedra entered) an update may use. 4096 are 500 voxels of travel,
    /// far above what a hand does in a tick, and at worst (all of it along a surface) some 0.45 ms:
    /// half a tick at 1 kHz. Faster loops take less.
    int step_budget = 4096;
};

/// What the steps of an update were, for figures, path files and tests.
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
    Vec3 goal;   ///< what it headed for [mm, physical]
    Tetrahedron tetrahedron;
};
/// Called for each step where `on_step` is set; costs nothing where it is not.
struct StepObserver {
    void (*on_step)(const Step& step, void* context) = nullptr;
    void* context = nullptr;
};

struct ProxyUpdate {
    UpdateStatus status = UpdateStatus::done;
    Mode mode = Mode::free;
    Vec3 hip = Vec3::Zero();  ///< [mm, physical]
    Vec3 scp = Vec3::Zero();  ///< [mm, physical]; equal to hip bit for bit when it was reached
    double density = 0;       ///< f(SCP) [data units]
    double isovalue = 0;      ///< [data units]
    int tetrahedra = 0;       ///< through how many the SCP moved
};

/// A proxy method: moves the proxy for one HIP [mm, physical]. All methods have this form, so a
/// renderer takes any of them.
using ProxyMethod = ProxyUpdate (*)(Proxy& proxy, const Field& field, const Vec3& hip,
                                    const ProxySettings& settings, StepObserver observer);

/// The default method, "exact descent" (docs/proxy.md). Guarantees, with r = field.range():
/// G1 every point of the SCP's path has sign * (f - isovalue) / r <= 1e-9 (recovery excepted);
/// G2 constrained: |f(SCP) - isovalue| / r <= 1e-9;
/// G3 no free straight motion of 1e-3 voxel leads closer to the HIP (frictionless);
/// G4 the distance to the HIP [mm] never grows (frictionless, field and isovalue unchanged);
/// G5 at most `step_budget` pieces an update, and never NaN.
ProxyUpdate update_exact(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings = {}, StepObserver observer = {});

/// The paper's method as published (Fig. 4): constraint planes of all tetrahedra at the SCP, one
/// goal that satisfies all of them, walked to tetrahedron by tetrahedron. Keeps G1, G2 and G5;
/// sticks on convex ridges, where it breaks G3. No friction. For comparison.
ProxyUpdate update_paper(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings = {}, StepObserver observer = {});

/// Puts the proxy at `hip` if that is free, else at the point recovery finds, however long that
/// takes (so not for the servo thread). False if no free point was found: all of space is solid.
bool place(Proxy& proxy, const Field& field, const Vec3& hip, double isovalue,
           StepObserver observer = {});

/// To be called before the field is exchanged or goes on in time: keeps on which side of the
/// surface the proxy is, so that a wall that comes over it pushes it ahead, however thin
/// (recovery).
void field_will_change(Proxy& proxy, const Field& field);

/// Unit normal of the level set at the SCP, out of the solid, physical axes; zero where the field
/// is constant. On a wall that of one of the tetrahedra that meet there.
Vec3 normal_at(const Proxy& proxy, const Field& field);

/// Where a straight segment first meets the isosurface, walking the lattice exactly.
struct RayHit {
    bool hit = false;
    Vec3 point = Vec3::Zero();   ///< [mm, physical]; the segment's end without a hit
    Vec3 normal = Vec3::Zero();  ///< unit, out of the solid, physical axes
};
/// `from` and `to` in mm, physical. A start inside the solid is a hit at `from`.
RayHit cast_ray(const Field& field, double isovalue, const Vec3& from, const Vec3& to,
                int step_budget = std::numeric_limits<int>::max());

}  // namespace palpate
