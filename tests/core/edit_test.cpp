// Edit: each sample against a slow reference, the surface that a brush leaves, and refusals.
#include "palpate/edit.hpp"

#include <gtest/gtest.h>

#include "palpate/names.hpp"
#include "palpate/proxy.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// Whether a stored sample is this value, rounded and cut to its type; a half may be rounded up or
/// down.
bool is_rounded(SampleType type, double sample, double value) {
    if (type == SampleType::float32)
        return std::abs(sample - value) <= 1e-6 * (1 + std::abs(value));
    return sample == cut_to(type, value - 1e-6) || sample == cut_to(type, value + 1e-6);
}

TEST(Edit, makes_of_each_sample_what_the_formulas_say) {
    int changes[4] = {}, swept[4] = {}, others = 0;
    std::uint64_t seed = 0;
    for (const SampleType type : sample_types) {
        for (const Geometry& geometry : odd_grids()) {
            for (int i = 0; i < scaled(40) + 1; ++i) {
                Random random(++seed);
                const Volume before = noise_of(type, geometry, seed);
                const Edit edit = random_edit(random, geometry, type);
                const Edited after = edited(samples_of(before), edit);
                SampleBox changed;
                for_each_sample(geometry, [&](const Index3& at) {
                    const double now = after.samples->sample(at);
                    ASSERT_TRUE(is_rounded(type, now, value_after(edit, before, at)))
                        << "seed " << seed << " at " << at.transpose() << ": " << before.sample(at)
                        << " became " << now << ", not " << value_after(edit, before, at);
                    if (now != before.sample(at)) changed = united(changed, {at, at});
                });
                ASSERT_EQ(after.changed, changed) << "the box is not tight";
                if (changed.empty()) continue;
                const auto* stroke = std::get_if<edit::Stroke>(&edit);
                const auto* sweep = std::get_if<edit::Sweep>(&edit);
                (stroke  ? changes[static_cast<int>(stroke->brush.kind)]
                 : sweep ? swept[static_cast<int>(sweep->brush.kind)]
                         : others) += 1;
            }
        }
    }
    if (is_slow_build) return;  // too few edits for all kinds
    for (const int count : changes) EXPECT_GT(count, scaled(40));
    for (const int count : swept) EXPECT_GT(count, scaled(20));
    EXPECT_GT(others, scaled(60));
}

TEST(Edit, gives_the_same_bits_again) {
    Random random(3);
    for (int i = 0; i < 30; ++i) {
        const auto samples = samples_of(noise_of(sample_types[i % 4], odd_grids()[4], 5));
        const Edit edit = random_edit(random, samples->geometry(), sample_types[i % 4]);
        EXPECT_TRUE(same_bits(flattened(*edited(samples, edit).samples),
                              flattened(*edited(samples, edit).samples)));
    }
}

/// A block of one density, and rays out of its middle.
struct Block {
    Geometry geometry;
    double inside = 200, level = 100;
    std::shared_ptr<const Samples> samples;

    Block(const Vec3& spacing, double edge_mm, const Mat3& direction, double density)
        : geometry(grid((edge_mm * spacing.cwiseInverse()).array().ceil().cast<int>() + 1, spacing,
                        {3, -20, 700}, direction)),
          inside(density),
          samples(samples_of(
              volume_of<std::int16_t>(geometry, [&](const Index3&) { return density; }))) {}

    Vec3 centre() const { return physical_centre(geometry); }
    Brush brush(double radius) const {
        return brush_for(BrushKind::carve, linear_field(samples, Solid::above, 0), level, radius);
    }
    /// Distance at which a ray from a point of the carved room leaves it [mm].
    double way_to_surface(const Samples& after, const Vec3& from, const Vec3& direction) const {
        const Field field = linear_field(std::make_shared<const Samples>(after), Solid::above, 0);
        const RayHit hit = cast_ray(field, level, from, from + 100 * direction);
        EXPECT_TRUE(hit.hit);
        return (hit.point - from).norm();
    }
};

struct Errors {
    double most = 0, sum = 0;
    int count = 0;
    void add(double error) {
        most = std::max(most, std::abs(error));
        sum += std::abs(error);
        ++count;
    }
};

TEST(Edit, carving_leaves_the_surface_at_the_radius) {
    struct Case {
        Vec3 spacing;
        double radius, density, most, mean;  // errors in the largest voxel
        Mat3 direction = Mat3::Identity();
    };
    const Case cases[] = {
        {Vec3::Ones(), 8, 200, 0.08, 0.025},
        {Vec3::Ones(), 4, 200, 0.12, 0.05},
        {Vec3::Constant(0.3), 2.4, 200, 0.08, 0.025, oblique_direction()},
        {{0.5, 0.5, 2}, 12, 200, 0.08, 0.025},
        {{0.7, 1.1, 0.9}, 9, 200, 0.08, 0.025, oblique_direction()},
        // If the solid is much farther from the level than the carved value, or much nearer, the
        // edge is cut off on one side.
        {Vec3::Ones(), 8, 1000, 0.4, 0.06},
        {Vec3::Ones(), 8, 130, 0.25, 0.1},
    };
    for (const Case& c : cases) {
        const Block block(c.spacing, 3 * c.radius, c.direction, c.density);
        Random random(2);
        Errors errors;
        for (int i = 0; i < 10; ++i) {
            const Vec3 centre = block.centre() + c.spacing.minCoeff() * random.point(-0.5, 0.5);
            const Edited carved =
                edited(block.samples, edit::Stroke{block.brush(c.radius), centre, centre});
            for (int ray = 0; ray < 200; ++ray) {
                const double way =
                    block.way_to_surface(*carved.samples, centre, random.direction());
                errors.add((way - c.radius) / c.spacing.maxCoeff());
            }
        }
        std::printf(
            "[ evidence ] spacing %.1f %.1f %.1f radius %4.1f solid at %4.0f: off by mean "
            "%.3f, most %.3f voxel\n",
            c.spacing[0], c.spacing[1], c.spacing[2], c.radius, c.density,
            errors.sum / errors.count, errors.most);
        EXPECT_LT(errors.most, c.most);
        EXPECT_LT(errors.sum / errors.count, c.mean);
    }
}

TEST(Edit, adding_leaves_the_surface_at_the_radius) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        const double s = solid == Solid::above ? 1 : -1;
        const auto air = samples_of(
            volume_of<std::int16_t>(grid(cube(24)), [&](const Index3&) { return -100 * s; }));
        const Field field = linear_field(air, solid);
        const Brush brush = brush_for(BrushKind::add, field, 0, 7);
        EXPECT_EQ(brush.value, 100 * s);
        const Vec3 centre(11.3, 12.1, 11.8);
        const Field added =
            linear_field(edited(air, edit::Stroke{brush, centre, centre}).samples, solid, -100 * s);
        Random random(4);
        for (int i = 0; i < 300; ++i) {
            const Vec3 way = random.direction();
            const RayHit hit = cast_ray(added, 0, centre + 11 * way, centre);
            ASSERT_TRUE(hit.hit);
            ASSERT_NEAR((hit.point - centre).norm(), 7, 0.1);
        }
    }
}

TEST(Edit, a_stroke_is_a_capsule) {
    const Block block(Vec3::Ones(), 40, Mat3::Identity(), 200);
    const Vec3 from = block.centre() - Vec3(9, 4, 2), to = block.centre() + Vec3(8, 6, 3);
    const Edited carved = edited(block.samples, edit::Stroke{block.brush(5), from, to});
    Random random(6);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 start = from + random.uniform(0, 1) * (to - from);
        const Vec3 direction = random.direction();
        const double way = block.way_to_surface(*carved.samples, start, direction);
        ASSERT_NEAR(distance_to_segment(start + way * direction, from, to), 5, 0.12);
    }
}

TEST(Edit, a_fast_stroke_leaves_no_gap) {
    // Small, so that dabs a tick apart would not meet; what many close dabs carve is all gone.
    const Block block(Vec3::Ones(), 60, Mat3::Identity(), 200);
    const Brush brush = block.brush(2.5);
    const Vec3 from = block.centre() - Vec3(24, 11, 7), to = block.centre() + Vec3(23, 14, 9);
    const auto stroke = edited(block.samples, edit::Stroke{brush, from, to}).samples;
    auto dabs = block.samples;
    constexpr int count = 2000;
    for (int i = 0; i <= count; ++i) {
        const Vec3 at = from + double(i) / count * (to - from);
        dabs = edited(dabs, edit::Stroke{brush, at, at}).samples;
    }
    for_each_sample(block.geometry, [&](const Index3& at) {
        ASSERT_NEAR(stroke->sample(at), dabs->sample(at), 1) << at.transpose();
    });
    const Field field = linear_field(stroke, Solid::above, 0);
    EXPECT_FALSE(cast_ray(field, block.level, from, to).hit);
}

TEST(Edit, faint_touches_of_whole_numbers_do_not_stand_still) {
    const auto solid =
        samples_of(volume_of<std::uint8_t>(grid(cube(9)), [](const Index3&) { return 200; }));
    for (const BrushKind kind : {BrushKind::carve, BrushKind::paint}) {
        Brush brush = brush_for(kind, linear_field(solid, Solid::above, 0), 100, 3);
        brush.value = 0;
        brush.strength = 0.001;  // of 200: a fifth of a unit
        const Index3 middle(4, 4, 4);
        const edit::Stroke touch{brush, middle.cast<double>(), middle.cast<double>()};
        auto samples = solid;
        for (int i = 1; i <= 100; ++i) {
            samples = edited(samples, touch).samples;
            ASSERT_EQ(samples->sample(middle), 200 - i);
        }
        // Nearer to its aim than a sixteenth of a unit a touch it comes to rest.
        for (int i = 0; i < 400; ++i) samples = edited(samples, touch).samples;
        EXPECT_TRUE(edited(samples, touch).changed.empty());
        EXPECT_LE(samples->sample(middle), 63);
    }
}

TEST(Edit, a_brush_that_paints_any_value_comes_to_an_end_where_it_rests) {
    for (const SampleType type : sample_types) {
        for (const double value : {100.4, 100.5, 99.6}) {
            for (const double strength : {0.3, 1.0}) {
                edit::Stroke stroke;
                stroke.brush = {BrushKind::paint, 3, 1, strength, 0, Solid::above, value};
                stroke.from = stroke.to = Vec3(6, 6, 6);
                auto samples = samples_of(noise_of(type, grid(cube(13)), 3));
                int touches = 0;
                for (Edited next = edited(samples, stroke); !next.changed.empty();
                     next = edited(next.samples, stroke)) {
                    ASSERT_LT(++touches, 2000) << value;
                    samples = next.samples;
                }
                EXPECT_NEAR(samples->sample({6, 6, 6}), value, 0.5);
            }
        }
    }
}

TEST(Edit, values_are_cut_at_the_limits_of_the_type) {
    const double lowest[] = {0, -32768, 0}, highest[] = {255, 32767, 65535};
    for (int i = 0; i < 3; ++i) {
        const auto samples = samples_of(noise_of(sample_types[i], grid(cube(5)), 1));
        const SampleBox all = whole_box(samples->geometry());
        EXPECT_EQ(edited(samples, edit::Fill{all, 1e9}).samples->sample({2, 2, 2}), highest[i]);
        EXPECT_EQ(edited(samples, edit::Fill{all, -1e9}).samples->sample({2, 2, 2}), lowest[i]);
    }
    const auto floats = samples_of(noise_of(SampleType::float32, grid(cube(5)), 1));
    const double most = std::numeric_limits<float>::max();
    EXPECT_EQ(
        edited(floats, edit::Fill{whole_box(floats->geometry()), 1e300}).samples->sample({0, 0, 0}),
        most);
}

TEST(Edit, far_outside_the_grid_changes_nothing) {
    const auto samples = samples_of(noise_of(SampleType::uint8, grid(cube(20)), 1));
    for (const double far : {1e3, 1e9, 1e15, 1e300}) {
        edit::Stroke stroke{{.value = -1}, Vec3::Constant(far), Vec3::Constant(far)};
        EXPECT_EQ(edited(samples, stroke).samples, samples);
    }
    for (const BrushKind kind : brush_kinds) {
        Brush brush{.kind = kind};
        brush.value = kind == BrushKind::add ? 9 : -9;
        const edit::Stroke endless{brush, Vec3::Constant(-1e300), Vec3::Constant(1e300)};
        EXPECT_EQ(edited(samples, endless).samples, samples);
    }
    constexpr int least = std::numeric_limits<int>::min(), most = std::numeric_limits<int>::max();
    const edit::Fill all{{Index3::Constant(least), Index3::Constant(most)}, 3};
    EXPECT_EQ(edited(samples, all).samples->maximum(), samples->maximum());
    EXPECT_EQ(flattened(*edited(samples, all).samples).maximum(), 3);
    // Through it all, from far off to far off.
    edit::Stroke through{
        {.kind = BrushKind::paint, .radius = 2, .value = 7}, Vec3(10, 10, -1e6), Vec3(10, 10, 1e6)};
    const auto after = edited(samples, through).samples;
    for (int z = 0; z < 20; ++z) EXPECT_EQ(after->sample({10, 10, z}), 7);
}

TEST(Edit, that_cannot_be_made_is_refused) {
    const auto samples = samples_of(noise_of(SampleType::uint8, grid(cube(5)), 1));
    const auto refused = [&](const Edit& edit) {
        EXPECT_THROW(check(edit, *samples), std::invalid_argument);
        EXPECT_THROW(edited(samples, edit), std::invalid_argument);
    };
    const double bad = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    const auto stroke = [](auto&& change) {
        edit::Stroke made{{.level = 10, .value = 0}};
        change(made);
        return made;
    };
    EXPECT_NO_THROW(check(stroke([](auto&) {}), *samples));
    for (const double radius : {0.0, -1.0, bad, infinity}) {
        refused(stroke([&](auto& s) { s.brush.radius = radius; }));
    }
    for (const double hardness : {-0.1, 1.1, bad}) {
        refused(stroke([&](auto& s) { s.brush.hardness = hardness; }));
    }
    for (const double strength : {0.0, 1.1, bad}) {
        refused(stroke([&](auto& s) { s.brush.strength = strength; }));
    }
    for (const double value : {bad, infinity, 10.0, 11.0}) {  // not on the free side
        refused(stroke([&](auto& s) { s.brush.value = value; }));
    }
    refused(stroke([&](auto& s) { s.brush.level = bad; }));
    refused(stroke([&](auto& s) { s.brush.solid = Solid::below; }));
    refused(stroke([&](auto& s) { s.brush.kind = BrushKind::add; }));
    refused(stroke([&](auto& s) { s.from[1] = bad; }));
    refused(stroke([&](auto& s) { s.to[2] = infinity; }));
    const auto sweep = [&](auto&& change) {
        edit::Sweep made{{.radius = 1, .level = 10, .value = 0}, nullptr, {}, {}};
        made.body = std::make_shared<const ToolBody>(
            body_for(made.brush, samples->geometry(), std::make_shared<const Tool>(point_tool())));
        change(made);
        return made;
    };
    EXPECT_NO_THROW(check(sweep([](auto&) {}), *samples));
    refused(sweep([](auto& s) { s.body.reset(); }));
    refused(sweep([](auto& s) { s.brush.radius = 2; }));  // farther than the body reaches
    refused(sweep([&](auto& s) { s.brush.value = bad; }));
    refused(sweep([&](auto& s) { s.from.position[1] = bad; }));
    refused(sweep([&](auto& s) { s.to.position[2] = infinity; }));
    refused(sweep([](auto& s) { s.to.position[2] = 1e6; }));  // too many poses
    refused(sweep([](auto& s) { s.from.orientation.coeffs() *= 1.1; }));
    refused(sweep([&](auto& s) { s.to.orientation.x() = bad; }));
    refused(edit::Fill{{}, bad});
    refused(edit::Replace{Index3(1 << 21, 0, 0), samples->volume()});
    const Samples sequence({{0, samples->volume()}, {1, samples->volume()}});
    EXPECT_THROW(check(edit::Fill{}, sequence), std::invalid_argument);
}

TEST(Edit, brushes_have_names) {
    for (const BrushKind kind : brush_kinds) EXPECT_EQ(named<BrushKind>(enum_name(kind)), kind);
    EXPECT_THROW(named<BrushKind>("dig"), std::invalid_argument);
}

}  // namespace
