// Named synthetic volumes ("synthetic:cylinder:100x100x30") and small builders of hard cases.
// Shared by tests, benchmarks, evaluation and demo; the core only. See docs/scenes.md.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::scenes {

/// A volume to touch, with its description.
struct Scene {
    std::string name;
    Volume volume;
    double isovalue = 0;  ///< a suitable one [data units]
    std::string description;
    /// The analytic density [data units, not rounded] at a physical point [mm], of which the
    /// samples are samples. Empty if there is none (noise, shepp-logan).
    std::function<double(const Vec3& physical)> exact;
};

/// The most that make_volume and the builders allocate for samples: 8 GiB, so 1024^3 of any type.
inline constexpr std::uint64_t largest_scene_bytes = std::uint64_t{8} << 30;

/// cylinder, sphere, torus, plane, shell, marschner-lobb, shepp-logan, noise, beating.
std::vector<std::string> volume_names();

/// A scene from its specification: "NAME", "NAME:WxHxD", each also with "synthetic:" in front.
/// Spacing 1 mm (beating: 100 mm along the longest axis), physical_centre() exactly (0, 0, 0). The
/// default of `type` is the scene's own. Density 0..1 is stored as 0..1 in float32 and as
/// 0..largest value in an integer type. shepp-logan is in Hounsfield units in int16 and float32, in
/// HU + 1000 in uint16, and has -1000..2000 HU as 0..255 in uint8. Throws std::invalid_argument
/// that lists the names or the form, or says which size is too large.
Scene make_volume(std::string_view spec, std::optional<SampleType> type = {},
                  const OnProgress& progress = {});

/// The same scene on a given grid. The shape is in millimetres, as large as the grid allows, around
/// physical_centre(geometry) and along the grid's own axes: a sphere is a sphere at any spacing.
/// Throws std::invalid_argument for an unknown name or a geometry that is not valid or too large.
Scene make_volume(std::string_view name, const Geometry& geometry,
                  std::optional<SampleType> type = {}, const OnProgress& progress = {});

// Builders of volumes for tests. All but noise take the grid of centred(size).

/// A grid whose physical_centre is (0, 0, 0), exactly if spacing and direction are axis-aligned
/// multiples of powers of two, to rounding otherwise.
Geometry centred(const Index3& size, const Vec3& spacing = Vec3::Ones(),
                 const Mat3& direction = Mat3::Identity());

/// White noise: every sample uniform in 0..amplitude (integer types: rounded to the nearest).
Volume noise(const Geometry& geometry, SampleType type, std::uint64_t seed, double amplitude,
             const OnProgress& progress = {});

/// uint8: each sample is 255 with the given probability, else 0.
Volume salt(const Index3& size, double fraction, std::uint64_t seed);

/// uint8: 255 at the samples lo..hi (both included, index space), else 0. Its isosurfaces lie along
/// the grid, so all degenerate cases of the lattice occur at once.
Volume box(const Index3& size, const Index3& lo, const Index3& hi);

/// A spherical sheet around the centre, falling linearly from full at `radius` [mm] to 0 at
/// `thickness` [mm] on both sides: `thickness` wide at half height. If it is thinner than a voxel,
/// only some samples lie in it, so it has holes and specks, as intended.
Volume thin_shell(const Index3& size, double radius, double thickness,
                  SampleType type = SampleType::uint8);

/// A ball in a unit box (1 = the shortest axis of the grid): density 1/2 + slope (radius - r),
/// clamped to 0..1; half height is its surface. In 8 bits the ramp has steps, which a hand feels.
Volume ball(const Index3& size, double radius = 0.35, double slope = 1.4,
            SampleType type = SampleType::uint8);

}  // namespace palpate::scenes
