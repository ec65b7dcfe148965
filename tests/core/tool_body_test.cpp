// Tool body: its distances against slow references, and what sweeps of it carve.
#include "palpate/tool.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "support/constants.hpp"
#include "support/edits.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

double distance_to_box(const Vec3& p, const Vec3& half) {
    const Vec3 out = p.cwiseAbs() - half;
    return out.cwiseMax(0).norm() + std::min(out.maxCoeff(), 0.0);
}

/// Tools with what their bodies' distances are in closed form.
struct Known {
    Tool tool;
    std::function<double(const Vec3&)> distance;
    double error;  ///< of the shape's facets and points [mm]
};
std::vector<Known> known_tools() {
    const auto capsule = [](const Vec3& p) {
        return distance_to_segment(p, {0, 0, 0}, {0, 0, 12});
    };
    return {{box_tool({6, 9, 4}, 0.5),
             [](const Vec3& p) {
                 return distance_to_box(p, {3, 4.5, 2});
             },
             0},
            {sphere_tool(5, 0.5), [](const Vec3& p) { return p.norm() - 5; }, 0.03},
            {rod_tool(12, 0.5), capsule, 0.15},
            {needle_tool(20, 1.5, 0.5),
             [](const Vec3& p) {
                 const double tube = std::max(std::hypot(p[0], p[1]) - 1.5, p[2] - 20);
                 if (p[2] > 20 || p[2] < 1.5) {
                     const double ball = (p - Vec3(0, 0, 1.5)).norm() - 1.5;
                     const double across = std::max(0.0, std::hypot(p[0], p[1]) - 1.5);
                     return p[2] < 1.5 ? ball : std::hypot(across, p[2] - 20);
                 }
                 return tube;
             },
             0.02}};
}

TEST(ToolBody, gives_the_distance_from_the_skin_up_to_its_reach) {
    Random random(3);
    for (const Known& known : known_tools()) {
        const ToolBody body(std::make_shared<const Tool>(known.tool), 0.25, 3);
        EXPECT_EQ(body.is_closed(), !known.tool.shape().triangles.empty());
        double most = 0;
        int near = 0;
        for (int i = 0; i < scaled(20000); ++i) {
            const Vec3 half = 0.5 * (body.high() - body.low()) + Vec3::Constant(5);
            const Vec3 p =
                0.5 * (body.low() + body.high()) + half.cwiseProduct(random.point(-1, 1));
            const double is = known.distance(p), found = body.distance(p);
            if (std::abs(is) > 2.7) {
                EXPECT_GT(is > 0 ? found : -found, 2.5) << p.transpose();
                continue;
            }
            ++near;
            most = std::max(most, std::abs(found - is));
        }
        EXPECT_GT(near, scaled(20000) / 10);
        std::printf("[ evidence ] %zu points: off by %.3f mm at most\n", known.tool.points().size(),
                    most);
        // Near bends of the distance (the middle, edges), linear interpolation is off by at most
        // half of a place's diagonal.
        EXPECT_LT(most, known.error + 0.5 * 0.25 * std::sqrt(3.0));
    }
}

/// A tube with a square hole, its facets turned at random.
ToolShape tube(Random& random) {
    const auto ring = [](double r, double z) {
        return std::vector<Vec3>{{r, r, z}, {-r, r, z}, {-r, -r, z}, {r, -r, z}};
    };
    ToolShape shape;
    for (const auto& [r, z] : {std::pair{5.0, 0.0}, {5.0, 8.0}, {2.0, 8.0}, {2.0, 0.0}}) {
        for (const Vec3& p : ring(r, z)) shape.vertices.push_back(p);
    }
    for (std::uint32_t a = 0; a < 4; ++a) {
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t b = (a + 1) % 4, j = (i + 1) % 4;
            shape.triangles.push_back({4 * a + i, 4 * a + j, 4 * b + i});
            shape.triangles.push_back({4 * a + j, 4 * b + j, 4 * b + i});
        }
    }
    for (auto& t : shape.triangles) {
        if (random.chance(0.5)) std::swap(t[0], t[1]);
    }
    return shape;
}

TEST(ToolBody, of_a_closed_mesh_is_what_it_encloses_whichever_way_its_faces_are_turned) {
    Random random(5);
    const ToolBody body(std::make_shared<const Tool>(mesh_tool(tube(random), 1)), 0.2, 2);
    ASSERT_TRUE(body.is_closed());
    for (int i = 0; i < scaled(20000); ++i) {
        const Vec3 p = random.point(-8, 8) + Vec3(0, 0, 4);
        const double outer = distance_to_box(p - Vec3(0, 0, 4), {5, 5, 4});
        const double hole = 2 - std::max(std::abs(p[0]), std::abs(p[1]));
        const double is = std::max(outer, hole);  // its sign, and its size near flat faces
        if (std::abs(is) < 0.2) continue;
        ASSERT_EQ(body.distance(p) < 0, is < 0) << p.transpose();
    }
}

// Corners and edges of regular shapes lie on the lines along which the sides are counted.
TEST(ToolBody, is_outside_all_around_whatever_its_places_are) {
    Random random(11);
    for (int i = 0; i < scaled(40) + 1; ++i) {
        const double size = random.uniform(0.3, 3), spacing = size * random.uniform(0.3, 1);
        const double step = size * random.uniform(0.1, 0.8), reach = 3 * step;
        for (const Tool& tool : {sphere_tool(size, spacing), burr_tool(size, spacing),
                                 box_tool({size, 2 * size, 0.7 * size}, spacing),
                                 needle_tool(4 * size, size, spacing)}) {
            const ToolBody body(std::make_shared<const Tool>(tool), step, reach);
            const Vec3 middle = 0.5 * (body.low() + body.high());
            const Vec3 half = 0.5 * (body.high() - body.low()) + Vec3::Constant(0.99 * reach);
            for (int n = 0; n < 200; ++n) {
                const Vec3 p = middle + half.cwiseProduct(random.point(-1, 1));
                const double apart =
                    distance_to_box(p - middle, half - Vec3::Constant(0.99 * reach));
                if (apart > 2 * step) {
                    ASSERT_GT(body.distance(p), 0) << size << ", " << step;
                }
            }
        }
    }
}

TEST(ToolBody, without_a_closed_shape_is_its_points) {
    Random random(5);
    ToolShape open = tube(random);
    open.triangles.pop_back();
    const auto tool = std::make_shared<const Tool>(mesh_tool(open, 1));
    const ToolBody body(tool, 0.2, 2);
    EXPECT_FALSE(body.is_closed());
    for (const Vec3& point : tool->points()) {
        EXPECT_GE(body.distance(point), 0);
        EXPECT_LT(body.distance(point), 0.2);
    }
    EXPECT_GT(body.distance({3.5, 3.5, 4}), 1);
}

TEST(ToolBody, refuses_lengths_that_are_none_and_meshes_too_fine_for_it) {
    const auto tool = std::make_shared<const Tool>(point_tool());
    for (const double bad : {0.0, -1.0, std::nan(""), 1e9}) {
        EXPECT_THROW(ToolBody(tool, bad, 1), std::invalid_argument);
        EXPECT_THROW(ToolBody(tool, 1, bad), std::invalid_argument);
    }
    EXPECT_THROW(ToolBody(tool, 1e-6, 1e6), std::invalid_argument);
    ToolShape fine;
    fine.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    fine.triangles.assign(20'001, {0, 1, 2});
    EXPECT_THROW(ToolBody(std::make_shared<const Tool>(Tool({Vec3::Zero()}, {}, true, fine)), 1, 1),
                 std::invalid_argument);
}

/// A block of solid with a body's sweep carved out of it.
struct Carved {
    Geometry geometry =
        support::grid(Index3::Constant(48), {1, 1, 1}, {-20, 5, 9}, oblique_direction());
    std::shared_ptr<const Samples> block =
        samples_of(volume_of<std::int16_t>(geometry, [](const Index3&) { return 200; }));
    Brush brush = brush_for(BrushKind::carve, linear_field(block, Solid::above, 0), 100, 0.5);

    edit::Sweep sweep(const Tool& tool, const Pose& from, const Pose& to) const {
        const auto body = std::make_shared<const ToolBody>(
            body_for(brush, geometry, std::make_shared<const Tool>(tool)));
        return {brush, body, from, to};
    }
};

TEST(Sweep, of_a_point_is_the_stroke_of_a_round_brush) {
    Carved c;
    c.brush.radius = 5;
    const Vec3 middle = physical_centre(c.geometry);
    const Vec3 from = middle - Vec3(9, 4, 2), to = middle + Vec3(8, 6, 3);
    const auto stroke = edited(c.block, edit::Stroke{c.brush, from, to}).samples;
    const auto sweep = edited(c.block, c.sweep(point_tool(), {from}, {to})).samples;
    for_each_sample(c.geometry, [&](const Index3& at) {
        ASSERT_NEAR(sweep->sample(at), stroke->sample(at), 5) << at.transpose();
    });
}

TEST(Sweep, of_a_turning_tool_takes_away_what_it_passed_through_and_nothing_else) {
    const Carved c;
    Random random(8);
    int free = 0, solid = 0;
    for (const Known& known : known_tools()) {
        if (known.tool.shape().triangles.empty()) continue;
        for (int n = 0; n < scaled(4) + 1; ++n) {
            const Vec3 middle = physical_centre(c.geometry);
            const Pose from{middle + random.point(-8, 8),
                            turned({1, 0, 0, 0}, 2 * random.direction())};
            const Pose to{middle + random.point(-8, 8),
                          turned(from.orientation, random.uniform(0, 2) * random.direction())};
            const auto after = edited(c.block, c.sweep(known.tool, from, to)).samples;
            const Vec3 turn = rotation_between(from.orientation, to.orientation);
            for (int i = 0; i < scaled(2000); ++i) {
                const Vec3 index = random.point(1, 46).array().round();
                const Vec3 p = physical_from_index(c.geometry, index);
                double is = 1e9;
                for (int k = 0; k <= 300; ++k) {
                    const Pose at{from.position + k / 300.0 * (to.position - from.position),
                                  turned(from.orientation, k / 300.0 * turn)};
                    is = std::min(is,
                                  known.distance(at.orientation.conjugate() * (p - at.position)));
                }
                if (std::abs(is - c.brush.radius) < 0.3) continue;  // of a voxel
                const bool gone = after->sample(index.cast<int>()) < 100;
                ASSERT_EQ(gone, is < c.brush.radius) << is << " mm from the tool's way";
                ++(gone ? free : solid);
            }
        }
    }
    EXPECT_GT(free, is_slow_build ? 0 : scaled(200));
    EXPECT_GT(solid, is_slow_build ? 0 : scaled(1000));
}

}  // namespace
