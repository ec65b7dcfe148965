// Bodies and hands for the benchmarks.
#include "benchmarks/hand.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::benchmarks {
namespace {

/// Long enough for the benchmarks' updates to be mostly new ones, short enough for the path itself
/// to stay in the second-level cache.
constexpr int path_length = 32768;

/// Round the z axis of the volume's centre. The pitch is no simple fraction of a voxel, so turns
/// do not repeat one another.
HandPath helix(double radius, double step) {
    constexpr double pitch = 0.6180339887;  // [mm] a turn
    const double turn = step / radius;
    HandPath path;
    path.reserve(path_length);
    for (int i = 0; i < path_length; ++i) {
        const double angle = turn * i;
        path.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                          -10.3 + pitch * angle / (2 * std::numbers::pi));
    }
    return path;
}

}  // namespace

Touch cylinder_touch(SampleType type, double voxels_per_mm, double depth) {
    scenes::Scene scene = scenes::make_volume("cylinder:100x100x30", type);
    const double range = scene.volume.range();
    // Density falls from 1 at the axis to 0 at 50 mm: 0.53 of it lies at 23.5 mm.
    const double radius = 50 * (1 - 0.53);
    const double isovalue = scene.volume.minimum() + 0.53 * range;
    return {linear_field(std::move(scene.volume)), isovalue,
            helix(radius - depth, step_per_tick(voxels_per_mm))};
}

Touch noise_touch(SampleType type, double voxels_per_mm) {
    const double amplitude = type == SampleType::float32 ? 1 : 255;
    Field field = linear_field(scenes::noise(scenes::centred({48, 48, 48}), type, 7, amplitude));
    // A Lissajous curve within +-20 voxels; its speed varies, so it is walked by arc length.
    const auto curve = [](double t) {
        return Vec3(20 * std::sin(t), 20 * std::sin(1.618 * t + 1), 20 * std::sin(2.414 * t + 2));
    };
    HandPath path;
    path.reserve(path_length);
    const double step = step_per_tick(voxels_per_mm);
    for (double t = 0; path.size() < path_length;) {
        path.push_back(curve(t));
        const double speed = (curve(t + 1e-4) - curve(t - 1e-4)).norm() / 2e-4;
        t += step / speed;
    }
    return {std::move(field), 0.5 * amplitude, std::move(path)};
}

Touch ball_touch(int size, double voxels_per_mm) {
    constexpr double radius = 22;  // [voxel]
    constexpr int reach = 96;      // the density is zero from 47 voxels on
    const Volume block = scenes::ball(Index3::Constant(reach), radius / reach, 0.02 * reach);
    const std::size_t n = static_cast<std::size_t>(size);
    std::vector<std::uint8_t> samples(n * n * n, 0);
    const int first = std::max(0, (size - reach) / 2);
    for (int k = first; k < std::min(size, first + reach); ++k) {
        for (int j = first; j < std::min(size, first + reach); ++j) {
            for (int i = first; i < std::min(size, first + reach); ++i) {
                const Index3 in_block = Index3(i, j, k) - Index3::Constant((size - reach) / 2);
                const std::size_t at = (static_cast<std::size_t>(k) * n + j) * n + i;
                samples[at] = static_cast<std::uint8_t>(block.sample(in_block));
            }
        }
    }
    // Great circles round z, x and y in turn, a quarter each, so that all axes of memory are met.
    HandPath path;
    path.reserve(path_length);
    const double turn = step_per_tick(voxels_per_mm) / (radius - 1);
    for (int i = 0; i < path_length; ++i) {
        const double angle = turn * i;
        const int quarter = static_cast<int>(angle / (0.5 * std::numbers::pi)) % 3;
        const double a = std::fmod(angle, 0.5 * std::numbers::pi);
        Vec3 p(0.137, 0.271, 0.419);  // off the planes of symmetry
        p[quarter] += (radius - 1) * std::cos(a);
        p[(quarter + 1) % 3] += (radius - 1) * std::sin(a);
        path.push_back(p);
    }
    const Geometry geometry = scenes::centred(Index3::Constant(size));
    return {linear_field(Volume(geometry, std::move(samples))), 0.5 * 255, std::move(path)};
}

Touch ramp_touch(int size) {
    const Geometry geometry = scenes::centred({size, size, size});
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(sample_count(geometry)));
    const double middle = 0.5 * (size - 1);
    for (int k = 0; k < size; ++k) {
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) {
                const Vec3 p = Vec3(i, j, k) - Vec3::Constant(middle);
                samples.push_back(static_cast<float>(p[0] + 0.37 * p[1] + 0.21 * p[2]));
            }
        }
    }
    return {linear_field(Volume(geometry, std::move(samples))), 0, {}};
}

Touch smooth(Touch touch) {
    touch.field.set_interpolation(Interpolation::cubic);
    return touch;
}

Touch all_in_bricks(Touch touch) {
    const auto& samples = touch.field.shared_samples();
    const double background = touch.field.background();
    // There and back: every brick is made anew, and holds what was there.
    const SampleBox all = whole_box(samples->geometry());
    const auto blank = edited(edited(samples, edit::Fill{all, samples->maximum()}).samples,
                              edit::Fill{all, samples->minimum()});
    const Edited back = edited(blank.samples, edit::Replace{Index3::Zero(), samples->volume()});
    touch.field = linear_field(back.samples, touch.field.solid(), background);
    return touch;
}

Touch all_resident(Touch touch) {
    const Volume& volume = touch.field.volume();
    const Geometry& geometry = volume.geometry();
    ResidentBricks bricks(geometry.size);
    std::vector<ResidentBricks::Change> all;
    const std::size_t each = size_of(volume.type());
    for (int k = 0; k < bricks.count()[2]; ++k) {
        for (int j = 0; j < bricks.count()[1]; ++j) {
            for (int i = 0; i < bricks.count()[0]; ++i) {
                const Index3 brick(i, j, k);
                const SampleBox box = ResidentBricks::box_of(brick, geometry.size);
                std::shared_ptr<std::byte[]> samples(
                    new std::byte[ResidentBricks::per_brick * each]());
                for (int z = box.low[2]; z <= box.high[2]; ++z) {
                    for (int y = box.low[1]; y <= box.high[1]; ++y) {
                        const auto to = ResidentBricks::place_of({box.low[0], y, z});
                        const auto from =
                            (std::ptrdiff_t{z} * geometry.size[1] + y) * geometry.size[0] +
                            box.low[0];
                        std::memcpy(samples.get() + static_cast<std::size_t>(to) * each,
                                    static_cast<const std::byte*>(volume.data()) +
                                        static_cast<std::size_t>(from) * each,
                                    static_cast<std::size_t>(box.high[0] - box.low[0] + 1) * each);
                    }
                }
                all.push_back({brick, {std::move(samples), 0}});
            }
        }
    }
    const double background = touch.field.background();
    touch.field = Field(std::make_shared<const Samples>(volume, geometry, bricks.with(all),
                                                        volume.minimum(), volume.maximum()),
                        touch.field.solid(), background, touch.field.interpolation());
    return touch;
}

Touch between_frames(Touch touch) {
    const Volume& volume = touch.field.volume();
    const double background = touch.field.background();
    Field between = linear_field(
        std::make_shared<const Samples>(std::vector<Frame>{{0, volume, 0}, {1, volume, 1}}),
        touch.field.solid(), background);
    between.set_time(0.5);
    touch.field = std::move(between);
    return touch;
}

}  // namespace palpate::benchmarks
