// Dequantization: the surface of a ball from its rounded samples, and what it may never do.
#include "palpate/filters/dequantize.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "palpate/io/sample_volume.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

namespace palpate::filters {
namespace {

using support::cube;

/// Density 127.5 at `radius` [samples] round a centre off the grid, falling by `slope` levels a
/// sample.
Volume ball(int edge, double radius, double slope, const Vec3& centre) {
    return support::volume_of<std::uint8_t>(scenes::centred(cube(edge)), [&](const Index3& index) {
        const double r = (index.cast<double>() - centre).norm();
        return std::uint8_t(std::lround(std::clamp(127.5 + slope * (radius - r), 0.0, 255.0)));
    });
}

Volume ball_mask(int edge, double radius, const Vec3& centre) {
    return support::volume_of<std::uint8_t>(scenes::centred(cube(edge)), [&](const Index3& index) {
        return std::uint8_t((index.cast<double>() - centre).norm() < radius);
    });
}

/// A function of the eight samples round a point, interpolated trilinearly.
template <class Value, class At>
Value interpolated(const Vec3& point, const Value& zero, At&& at) {
    const Index3 low = point.array().floor().cast<int>();
    const Vec3 part = point - low.cast<double>();
    Value sum = zero;
    for (int corner = 0; corner < 8; ++corner) {
        const Index3 offset(corner & 1, corner >> 1 & 1, corner >> 2);
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) weight *= offset[axis] ? part[axis] : 1 - part[axis];
        sum += weight * at(low + offset);
    }
    return sum;
}

double density(const Volume& volume, const Vec3& point) {
    return interpolated(point, 0.0, [&](const Index3& i) { return volume.sample(i); });
}

/// Central differences at the samples, interpolated: what trilinear interpolation itself tilts is
/// not counted.
Vec3 gradient(const Volume& volume, const Vec3& point) {
    return interpolated(point, Vec3(Vec3::Zero()), [&](const Index3& i) -> Vec3 {
        Vec3 slope;
        for (int axis = 0; axis < 3; ++axis) {
            const Index3 unit = Index3::Unit(axis);
            slope[axis] = (volume.sample(i + unit) - volume.sample(i - unit)) / 2;
        }
        return slope;
    });
}

struct Fidelity {
    double mean = 0, p99 = 0;  ///< angle of the gradient on the isosurface [degrees]
    double bias = 0;           ///< of the radius [samples]
};

/// Fidelity of the isosurface of a ball, along 2000 rays from its centre.
Fidelity fidelity(const Volume& volume, double isovalue, double radius, const Vec3& centre) {
    support::Random random(7);
    std::vector<double> angles;
    Fidelity result;
    for (int ray = 0; ray < 2000; ++ray) {
        const Vec3 direction = random.direction();
        double inside = radius - 2, outside = radius + 2;
        while (outside - inside > 1e-6) {
            const double middle = 0.5 * (inside + outside);
            const bool solid = density(volume, centre + middle * direction) > isovalue;
            (solid ? inside : outside) = middle;
        }
        const Vec3 normal = -gradient(volume, centre + inside * direction).normalized();
        angles.push_back(std::acos(std::min(1.0, normal.dot(direction))) * 180 / std::numbers::pi);
        result.mean += angles.back() / 2000;
        result.bias += (inside - radius) / 2000;
    }
    std::ranges::sort(angles);
    result.p99 = angles[1980];
    return result;
}

Vec3 off_grid(int edge) {
    return Vec3::Constant(0.5 * (edge - 1)) + Vec3(0.13, -0.21, 0.07);
}

double largest_move(const Volume& before, const Volume& after) {
    double most = 0;
    const auto moved = after.samples<float>();
    with_type(before.type(), [&](auto zero) {
        const auto own = before.samples<decltype(zero)>();
        for (std::size_t i = 0; i < own.size(); ++i) {
            most = std::max(most, std::abs(double(moved[i]) - double(own[i])));
        }
    });
    return most;
}

TEST(Dequantize, gives_a_ball_of_8_bits_its_normals_back) {
    const int edge = support::is_slow_build ? 48 : 96;
    const double radius = 0.35 * edge, slope = 255 * 1.4 / edge;
    const Volume before = ball(edge, radius, slope, off_grid(edge));
    const Fidelity rough = fidelity(before, 127.5, radius, off_grid(edge));
    const Fidelity fine = fidelity(dequantized(before), 127.5, radius, off_grid(edge));
    EXPECT_GT(rough.mean, 1);
    EXPECT_LT(fine.mean, 0.05);
    EXPECT_LT(fine.p99, 0.2);
    EXPECT_LT(std::abs(fine.bias), 0.01);
}

/// Mean angle between the gradient and the true normal of the scene's torus [degrees].
double tilt_of_torus(const Volume& volume) {
    support::Random random(11);
    const double edge = volume.geometry().size[0];
    double sum = 0;
    for (int i = 0; i < 2000; ++i) {
        const double along = random.uniform(0, 2 * std::numbers::pi);
        const double round = random.uniform(0, 2 * std::numbers::pi);
        const Vec3 out(std::cos(along), std::sin(along), 0);
        const Vec3 normal = std::cos(round) * out + std::sin(round) * Vec3::UnitZ();
        const Vec3 at = 0.3 * edge * out + 0.12 * edge * normal;
        const Vec3 slope = gradient(volume, index_from_physical(volume.geometry(), at));
        sum += std::acos(std::min(1.0, std::abs(normal.dot(slope.normalized()))));
    }
    return sum / 2000 * 180 / std::numbers::pi;
}

TEST(Dequantize, gives_a_torus_its_normals_back_though_its_terraces_are_short_and_steep) {
    for (const std::string size : {"60x60x30", "80x80x40"}) {
        const Volume before = scenes::make_volume("torus:" + size, SampleType::uint8).volume;
        const Volume true_samples =
            scenes::make_volume("torus:" + size, SampleType::float32).volume;
        const double least = tilt_of_torus(true_samples);
        const double rough = tilt_of_torus(before) - least;
        EXPECT_GT(rough, 0.25) << size;
        EXPECT_LT(tilt_of_torus(dequantized(before)) - least, 0.1 * rough) << size;
    }
}

TEST(Dequantize, keeps_small_bodies_on_gentle_slopes_where_they_are) {
    struct Body {
        double radius, slope;
    };
    for (const Body& body : {Body{12, 0.8}, Body{8, 2}, Body{20, 2}, Body{12, 20}}) {
        const Volume before = ball(56, body.radius, body.slope, off_grid(56));
        const Fidelity fine = fidelity(dequantized(before), 127.5, body.radius, off_grid(56));
        EXPECT_LT(fine.mean, 0.5) << body.radius << " " << body.slope;
        EXPECT_LT(std::abs(fine.bias), 0.03) << body.radius << " " << body.slope;
    }
}

TEST(Dequantize, takes_the_stair_steps_of_a_mask) {
    const Volume before = ball_mask(56, 20, off_grid(56));
    const Fidelity rough = fidelity(before, 0.5, 20, off_grid(56));
    const Fidelity fine = fidelity(dequantized(before), 0.5, 20, off_grid(56));
    EXPECT_GT(rough.mean, 10);
    EXPECT_LT(fine.mean, 3);
    EXPECT_LT(std::abs(fine.bias), 0.15);
}

TEST(Dequantize, moves_no_sample_by_half_a_level_nor_out_of_the_range) {
    const Geometry grid = scenes::centred({23, 17, 31});
    for (const SampleType type : {SampleType::uint8, SampleType::int16, SampleType::uint16}) {
        for (const double amplitude : {1.0, 3.0, 255.0}) {
            const Volume before = scenes::noise(grid, type, 5, amplitude);
            const Volume after = dequantized(before);
            EXPECT_EQ(after.type(), SampleType::float32);
            EXPECT_LT(largest_move(before, after), 0.5) << name_of(type) << " " << amplitude;
            EXPECT_GE(after.minimum(), before.minimum());
            EXPECT_LE(after.maximum(), before.maximum());
        }
    }
    const Volume salt = scenes::salt({23, 17, 31}, 0.3, 1);
    EXPECT_LT(largest_move(salt, dequantized(salt)), 127.5);
    EXPECT_GT(largest_move(salt, dequantized(salt)), 100);
}

TEST(Dequantize, keeps_a_wall_of_one_sample_in_a_mask_closed) {
    const Volume before = support::volume_of<std::uint8_t>(
        scenes::centred(cube(24)), [](const Index3& i) { return std::uint8_t(i[0] == 12); });
    const Volume after = dequantized(before);
    for (int k = 0; k < 24; ++k) {
        for (int j = 0; j < 24; ++j) EXPECT_GT(after.sample({12, j, k}), 0.5) << j << " " << k;
    }
}

TEST(Dequantize, changes_next_to_nothing_in_a_scan_with_steep_slopes) {
    const Volume before = io::read_volume(io::sample_volume_path()).volume;
    DequantizeOptions options;
    options.rounds = 5;
    const Volume after = dequantized(before, options);
    EXPECT_LT(largest_move(before, after), 0.5);
    double turned = 0, area = 0;  // of the isosurfaces, which the gradient weighs
    const Index3 size = before.geometry().size;
    support::Random random(3);
    for (int i = 0; i < 200000; ++i) {
        const Index3 at(1 + random.below(size[0] - 2), 1 + random.below(size[1] - 2),
                        1 + random.below(size[2] - 2));
        const Vec3 was = gradient(before, at.cast<double>());
        if (was.norm() < 8) continue;
        const Vec3 is = gradient(after, at.cast<double>());
        area += was.norm();
        turned += was.norm() * std::atan2(was.cross(is).norm(), was.dot(is));
    }
    EXPECT_LT(turned / area * 180 / std::numbers::pi, 1);
}

TEST(Dequantize, leaves_what_has_no_terraces_exactly_as_it_is) {
    support::Random random(3);
    const auto value = [&](const Index3& at) {
        const double r = (at.cast<double>() - Vec3(24, 23, 25)).norm();
        return std::uint8_t(at[0] < 64 ? std::lround(150 - 0.7 * std::min(r, 60.0))
                                       : 100 + random.below(60));
    };
    const Volume before = support::volume_of<std::uint8_t>(scenes::centred({128, 48, 48}), value);
    const Volume after = dequantized(before);
    std::int64_t moved = 0, same = 0;
    for (int k = 0; k < 48; ++k) {
        for (int j = 0; j < 48; ++j) {
            for (int i = 0; i < 128; ++i) {
                const bool stays = after.sample({i, j, k}) == before.sample({i, j, k});
                if (i < 48) moved += !stays;
                if (i >= 80) same += stays;
            }
        }
    }
    EXPECT_GT(moved, 100000);
    EXPECT_EQ(same, 48 * 48 * 48);
}

TEST(Dequantize, gives_16_bits_the_same_surface_as_8_bits) {
    const Volume narrow = ball(48, 15, 1.5, off_grid(48));
    const Volume wide = support::volume_of<std::uint16_t>(narrow.geometry(), [&](const Index3& at) {
        return std::uint16_t(40000 + 16 * narrow.sample(at));
    });
    const Volume from_8 = dequantized(narrow), from_16 = dequantized(wide);
    for (int i = 0; i < 48; ++i) {
        const Index3 at(i, 20, 30);
        EXPECT_NEAR((from_16.sample(at) - 40000) / 16, from_8.sample(at), 1e-3) << i;
    }
}

TEST(Dequantize, gives_the_same_bits_on_any_number_of_threads) {
    const Volume before = scenes::noise(scenes::centred({200, 300, 7}), SampleType::uint8, 9, 4);
    DequantizeOptions options;
    options.rounds = 3;
    options.threads = 1;
    const Volume alone = dequantized(before, options);
    for (const int threads : {2, 5, 0}) {
        options.threads = threads;
        const Volume together = dequantized(before, options);
        EXPECT_TRUE(std::ranges::equal(alone.samples<float>(), together.samples<float>()));
    }
}

TEST(Dequantize, tells_its_progress_and_stops_when_that_throws) {
    const Volume before = scenes::noise(scenes::centred(cube(12)), SampleType::uint8, 1, 9);
    DequantizeOptions options;
    double last = 0;
    options.progress = [&](double part) {
        EXPECT_GT(part, last);
        last = part;
    };
    (void)dequantized(before, options);
    EXPECT_NEAR(last, 1, 1e-9);
    struct Cancelled {};
    options.progress = [](double part) {
        if (part > 0.4) throw Cancelled();
    };
    EXPECT_THROW(dequantized(before, options), Cancelled);
}

TEST(Dequantize, looks_for_levels_only_until_progress_throws) {
    struct Cancelled {};
    for (const auto type : {SampleType::uint8, SampleType::float32}) {
        const Volume volume = scenes::salt({1024, 1024, 1}, 0.5, 1);
        const Volume before = type == SampleType::uint8 ? volume : smoothed(volume);
        int reports = 0;
        DequantizeOptions options;
        options.progress = [&](double part) {
            EXPECT_LT(part, 0.1);
            if (++reports == 2) throw Cancelled();  // the second comes before the first round
        };
        EXPECT_THROW((void)dequantized(before, options), Cancelled);
        const OnProgress cancel = [](double) { throw Cancelled(); };
        EXPECT_THROW((void)level_of(before, cancel), Cancelled);
        EXPECT_THROW((void)terraces_of(before, cancel), Cancelled);
    }
}

TEST(Dequantize, leaves_data_without_levels_as_they_are) {
    const Volume flat = scenes::noise(scenes::centred(cube(5)), SampleType::uint8, 1, 0);
    EXPECT_EQ(dequantized(flat).type(), SampleType::float32);
    EXPECT_EQ(largest_move(flat, dequantized(flat)), 0);
    const Volume fine = scenes::noise(scenes::centred(cube(42)), SampleType::float32, 1, 1);
    EXPECT_EQ(dequantized(fine).data(), fine.data());
}

TEST(Dequantize, refuses_options_out_of_range) {
    const Volume volume = scenes::noise(scenes::centred(cube(4)), SampleType::uint8, 1, 9);
    const auto refused = [&](auto change) {
        DequantizeOptions options;
        change(options);
        EXPECT_THROW(dequantized(volume, options), std::invalid_argument);
    };
    refused([](auto& o) { o.rounds = 0; });
    refused([](auto& o) { o.rounds = most_rounds + 1; });
    refused([](auto& o) { o.coarsest = 3; });
    refused([](auto& o) { o.coarsest = 2 * greatest_step; });
    refused([](auto& o) { o.level = 0; });
    refused([](auto& o) { o.threads = -1; });
}

}  // namespace
}  // namespace palpate::filters
