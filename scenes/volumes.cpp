// The named scenes: their densities, and parsing of their specifications.
#include "palpate/scenes/volumes.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <numbers>
#include <stdexcept>

#include "palpate/names.hpp"
#include "palpate/scenes/beating.hpp"
#include "scenes/fill.hpp"
#include "scenes/head_phantom.hpp"

namespace palpate::scenes {
namespace {

struct Recipe {
    const char* name;
    const char* description;
    Index3 size;
    SampleType type;
    double isovalue;  // as density: 0..1, or Hounsfield units for the head
    Scene (*make)(const Recipe&, const Geometry&, SampleType, const OnProgress&);
};

/// Fills the volume, and keeps the density as the scene's exact function.
template <class Density>
Scene analytic(const Recipe& recipe, const Geometry& geometry, SampleType type,
               const OnProgress& progress, Density density) {
    const Scale scale = unit_scale(type);
    const auto value = [=](const Vec3& centred_mm) { return scale(density(centred_mm)); };
    return {recipe.name, filled(geometry, type, value, progress), scale(recipe.isovalue),
            recipe.description, [=, centre = physical_centre(geometry)](const Vec3& physical) {
                return value(grid_axes_from_physical(geometry, physical - centre));
            }};
}

/// The paper's test volume (Corenthy et al. 2012, section 6).
Scene cylinder(const Recipe& recipe, const Geometry& geometry, SampleType type,
               const OnProgress& progress) {
    const double radius = 0.5 * shortest_length(geometry, 2);
    return analytic(recipe, geometry, type, progress, [=](const Vec3& p) {
        return std::max(0.0, 1 - std::sqrt(p[0] * p[0] + p[1] * p[1]) / radius);
    });
}

Scene sphere(const Recipe& recipe, const Geometry& geometry, SampleType type,
             const OnProgress& progress) {
    const double radius = 0.5 * shortest_length(geometry);
    return analytic(recipe, geometry, type, progress,
                    [=](const Vec3& p) { return std::max(0.0, 1 - p.norm() / radius); });
}

Scene torus(const Recipe& recipe, const Geometry& geometry, SampleType type,
            const OnProgress& progress) {
    const double ring = 0.3 * shortest_length(geometry, 2);
    const double reach = 0.2 * shortest_length(geometry, 2);
    return analytic(recipe, geometry, type, progress, [=](const Vec3& p) {
        const double across = std::sqrt(p[0] * p[0] + p[1] * p[1]) - ring;
        return std::max(0.0, 1 - std::sqrt(across * across + p[2] * p[2]) / reach);
    });
}

Scene plane(const Recipe& recipe, const Geometry& geometry, SampleType type,
            const OnProgress& progress) {
    const double height = std::max(1, geometry.size[2] - 1) * geometry.spacing[2];
    return analytic(recipe, geometry, type, progress,
                    [=](const Vec3& p) { return std::clamp(0.5 - p[2] / height, 0.0, 1.0); });
}

Scene shell(const Recipe& recipe, const Geometry& geometry, SampleType type,
            const OnProgress& progress) {
    const double radius = 0.35 * shortest_length(geometry);
    const double reach = 0.12 * shortest_length(geometry);
    return analytic(recipe, geometry, type, progress, [=](const Vec3& p) {
        return std::max(0.0, 1 - std::abs(p.norm() - radius) / reach);
    });
}

/// Marschner and Lobb 1994 with f_M = 6 and alpha = 0.25 on [-1, 1]^3.
Scene marschner_lobb(const Recipe& recipe, const Geometry& geometry, SampleType type,
                     const OnProgress& progress) {
    constexpr double pi = std::numbers::pi, f_m = 6, alpha = 0.25;
    Vec3 half;
    for (int a = 0; a < 3; ++a) {
        half[a] = 0.5 * std::max(1, geometry.size[a] - 1) * geometry.spacing[a];
    }
    return analytic(recipe, geometry, type, progress, [=](const Vec3& p) {
        const Vec3 u = p.cwiseQuotient(half);
        const double r = std::sqrt(u[0] * u[0] + u[1] * u[1]);
        const double ripple = std::cos(2 * pi * f_m * std::cos(pi * r / 2));
        return (1 - std::sin(pi * u[2] / 2) + alpha * (1 + ripple)) / (2 * (1 + alpha));
    });
}

Scene shepp_logan(const Recipe& recipe, const Geometry& geometry, SampleType type,
                  const OnProgress& progress) {
    Scale scale{0, 1};
    if (type == SampleType::uint16) scale = {1000, 1};
    if (type == SampleType::uint8) scale = {85, 255.0 / 3000};
    const HeadPhantom head(0.5 * shortest_length(geometry), 2 * geometry.spacing.maxCoeff());
    return {recipe.name,
            filled(
                geometry, type, [&](const Vec3& p) { return scale(head.hounsfield(p)); }, progress),
            scale(recipe.isovalue),
            recipe.description,
            {}};
}

Scene white_noise(const Recipe& recipe, const Geometry& geometry, SampleType type,
                  const OnProgress& progress) {
    const Scale scale = unit_scale(type);
    constexpr std::uint64_t seed = 1;
    return {recipe.name,
            noise(geometry, type, seed, scale.gain, progress),
            scale(recipe.isovalue),
            recipe.description,
            {}};
}

Scene beating(const Recipe&, const Geometry& geometry, SampleType type,
              const OnProgress& progress) {
    return beating_frame(geometry, 0, type, progress);
}

constexpr auto u8 = SampleType::uint8;
constexpr auto f32 = SampleType::float32;

const std::array<Recipe, 9>& recipes() {
    static const std::array<Recipe, 9> all{{
        {"cylinder",
         "the paper's: density 1 at the z axis, falling linearly to 0 at the radius",
         {100, 100, 30},
         f32,
         0.4,
         cylinder},
        {"sphere",
         "density 1 at the centre, falling linearly to 0: every level is a sphere",
         {64, 64, 64},
         u8,
         0.3,
         sphere},
        {"torus", "a ring around the z axis; every level is a torus", {80, 80, 40}, u8, 0.4, torus},
        {"plane",
         "density 1 at the bottom, 0 at the top; every level is a plane across z",
         {64, 64, 64},
         u8,
         0.5,
         plane},
        {"shell", "a hollow sphere with an outer and an inner wall", {64, 64, 64}, u8, 0.5, shell},
        {"marschner-lobb",
         "the Marschner-Lobb test signal: ripples near the Nyquist limit",
         {41, 41, 41},
         f32,
         0.5,
         marschner_lobb},
        {"shepp-logan",
         "a head phantom in Hounsfield units: skin from -470, skull from 530",
         {128, 128, 128},
         SampleType::int16,
         -470,
         shepp_logan},
        {"noise",
         "white noise (seed 1): the hardest surface there is",
         {64, 64, 64},
         u8,
         0.5,
         white_noise},
        {"beating",
         "a heart-like shell of two chambers, at the beginning of a beat",
         {64, 64, 64},
         u8,
         0.5,
         beating},
    }};
    return all;
}

const Recipe& recipe_of(std::string_view name) {
    for (const Recipe& recipe : recipes()) {
        if (name == recipe.name) return recipe;
    }
    throw std::invalid_argument("there is no synthetic volume '" + std::string(name) +
                                "': " + use_one_of(volume_names(), name) +
                                ", alone or with a size as in sphere:64x64x64");
}

Index3 size_from_text(std::string_view text) {
    Index3 size;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (int a = 0; a < 3; ++a) {
        const auto [next, error] = std::from_chars(at, end, size[a]);
        const bool ends_well = a < 2 ? next != end && *next == 'x' : next == end;
        if (error != std::errc{} || !ends_well || size[a] < 1) {
            throw std::invalid_argument("'" + std::string(text) +
                                        "' is not a size: give three whole numbers of samples, "
                                        "each at least 1, as in 64x64x64");
        }
        at = next + 1;
    }
    return size;
}

}  // namespace

std::vector<std::string> volume_names() {
    std::vector<std::string> names;
    for (const Recipe& recipe : recipes()) names.emplace_back(recipe.name);
    return names;
}

Scene make_volume(std::string_view spec, std::optional<SampleType> type,
                  const OnProgress& progress) {
    constexpr std::string_view prefix = "synthetic:";
    if (spec.starts_with(prefix)) spec.remove_prefix(prefix.size());
    const std::size_t colon = spec.find(':');
    const Recipe& recipe = recipe_of(spec.substr(0, colon));
    const Index3 size = colon == spec.npos ? recipe.size : size_from_text(spec.substr(colon + 1));
    const Geometry grid = recipe.make == beating ? beating_grid(size) : centred(size);
    return recipe.make(recipe, grid, type.value_or(recipe.type), progress);
}

Scene make_volume(std::string_view name, const Geometry& geometry, std::optional<SampleType> type,
                  const OnProgress& progress) {
    const Recipe& recipe = recipe_of(name);
    check(geometry);
    return recipe.make(recipe, geometry, type.value_or(recipe.type), progress);
}

}  // namespace palpate::scenes
