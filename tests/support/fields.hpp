// Fields on which the proxy must keep its guarantees: white noise, salt, sheets thinner than a
// voxel, grid-aligned boxes, anisotropic and oblique grids, smooth ones, and all four sample types.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/field.hpp"
#include "support/random.hpp"

namespace palpate::support {

struct TestField {
    std::string name;
    Field field;
    double isovalue;
};

/// A rotation in thirds: the same bits everywhere, without sines.
inline Mat3 oblique_direction() {
    Mat3 direction;
    direction << 2, -1, 2, 2, 2, -1, -1, 2, 2;
    return direction / 3;
}

inline Geometry grid(const Index3& size, const Vec3& spacing = Vec3::Ones(),
                     const Vec3& origin = Vec3::Zero(), const Mat3& direction = Mat3::Identity()) {
    return {size, spacing, origin, direction};
}

inline Index3 cube(int edge) {
    return Index3::Constant(edge);
}

/// Samples from a function of their index.
template <class T, class F>
Volume volume_of(const Geometry& geometry, F&& sample) {
    std::vector<T> samples;
    samples.reserve(static_cast<std::size_t>(sample_count(geometry)));
    for (int z = 0; z < geometry.size[2]; ++z) {
        for (int y = 0; y < geometry.size[1]; ++y) {
            for (int x = 0; x < geometry.size[0]; ++x) {
                samples.push_back(static_cast<T>(sample(Index3(x, y, z))));
            }
        }
    }
    return Volume(geometry, std::move(samples));
}

/// Every sample uniform in [low, high), cut to the type.
template <class T>
Volume noise_volume(const Geometry& geometry, std::uint64_t seed, double low, double high) {
    Random random(seed);
    return volume_of<T>(geometry, [&](const Index3&) { return random.uniform(low, high); });
}

/// The function of Marschner and Lobb 1994 in -1..1 (f_M = 6, alpha = 0.25).
inline double marschner_lobb(const Vec3& p) {
    constexpr double pi = 3.14159265358979323846;
    const double r = std::sqrt(p[0] * p[0] + p[1] * p[1]);
    const double rho = std::cos(12 * pi * std::cos(pi * r / 2));
    return (1 - std::sin(pi * p[2] / 2) + 0.25 * (1 + rho)) / (2 * (1 + 0.25));
}

/// The same samples, felt smoothly.
inline Field smooth(Field field) {
    field.set_interpolation(Interpolation::cubic);
    return field;
}

inline TestField noise_field(std::uint64_t seed = 1, Solid solid = Solid::above) {
    return {solid == Solid::above ? "noise" : "noise_below",
            linear_field(noise_volume<std::uint8_t>(grid(cube(24)), seed, 0, 256), solid), 128};
}

inline TestField salt_field(std::uint64_t seed = 2) {
    Random random(seed);
    return {"salt",
            linear_field(volume_of<std::uint8_t>(
                grid(cube(24)), [&](const Index3&) { return random.chance(0.25) ? 255 : 0; })),
            100};
}

/// A spherical sheet, nominally 3/4 voxel wide at the isovalue: density 255 - 200 |d| over the
/// distance d to the sphere [voxel]. Sampled, it is a lace of specks, sheets and holes.
inline TestField shell_field() {
    const Geometry geometry = grid(cube(24));
    return {"shell",
            linear_field(volume_of<std::uint8_t>(
                geometry,
                [&](const Index3& i) {
                    const Vec3 from = i.cast<double>() - Vec3::Constant(11.5);
                    const double d = std::abs(std::sqrt(from.squaredNorm()) - 8);
                    return d < 1.2 ? 255 - 200 * d : 0;
                })),
            180};
}

/// A hollow box whose walls are one sample thick: closed, and an eighth of a voxel wide at the
/// isovalue. Its walls are at 5 and 17 along each axis.
inline TestField sheet_field() {
    return {"sheet",
            linear_field(volume_of<std::uint8_t>(grid(cube(24)),
                                                 [](const Index3& i) {
                                                     const auto from = (i.array() - 11).abs();
                                                     return from.maxCoeff() == 6 ? 255 : 0;
                                                 })),
            240};
}

/// Samples 255 in 6..17 along each axis: planes of the isosurface along the grid.
inline TestField box_field() {
    return {"box",
            linear_field(volume_of<std::uint8_t>(
                grid(cube(24)),
                [](const Index3& i) {
                    return (i.array() >= 6).all() && (i.array() <= 17).all() ? 255 : 0;
                })),
            127.5};
}

/// The smooth field half way between two frames that are alike: its samples have to be gathered.
inline Field between_alike(const Volume& volume) {
    Field field(
        std::make_shared<const Samples>(std::vector<Frame>{{0, volume, 0}, {1, volume, 1}}));
    field.set_time(0.5);
    return field;
}

inline TestField anisotropic_field(std::uint64_t seed = 3) {
    const Geometry geometry = grid({24, 24, 16}, {0.5, 0.5, 2}, {-100, 50, 700});
    return {"anisotropic", linear_field(noise_volume<std::int16_t>(geometry, seed, -1024, 3072)),
            1500};
}

inline TestField oblique_field(std::uint64_t seed = 4) {
    const Geometry geometry =
        grid({20, 24, 18}, {0.7, 1.1, 0.9}, {31, -44, 12}, oblique_direction());
    return {"oblique", linear_field(noise_volume<std::uint16_t>(geometry, seed, 0, 65536)),
            33000.3};
}

inline TestField marschner_lobb_field() {
    const Geometry geometry = grid(cube(40), Vec3::Constant(0.8));
    return {
        "marschner_lobb",
        linear_field(volume_of<float>(
            geometry,
            [](const Index3& i) { return marschner_lobb((i.cast<double>() / 19.5).array() - 1); })),
        0.5};
}

inline TestField offset_field(std::uint64_t seed = 5) {
    return {"offset", linear_field(noise_volume<float>(grid(cube(24)), seed, 999999, 1000001)),
            1000000.137};
}

/// A few values only: plateaus, saddles and surfaces through samples, at the isovalue itself.
inline TestField terraces_field(std::uint64_t seed = 6) {
    return {"terraces", linear_field(noise_volume<std::uint8_t>(grid(cube(24)), seed, 0, 4)), 1};
}

}  // namespace palpate::support
