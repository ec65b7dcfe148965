// Tools as options name them, and the points of the built-in shapes.
#include "palpate/io/tool_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::io {
namespace {

using support::Random;
using support::ScratchFolder;

/// Largest distance [mm] from places of a surface to the nearest point of the tool.
template <class Place>
double widest_gap(const Tool& tool, Place&& place) {
    Random random(3);
    double widest = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 at = place(random);
        double nearest = 1e9;
        for (const Vec3& point : tool.points()) nearest = std::min(nearest, (point - at).norm());
        widest = std::max(widest, nearest);
    }
    return widest;
}

TEST(ToolFile, names_give_the_shapes_with_their_sizes) {
    const auto extent = [](const std::string& text) {
        Eigen::AlignedBox3d box;
        const auto tool = make_tool(tool_spec_from(text), 0.15);
        for (const Vec3& point : tool->points()) box.extend(point);
        return box;
    };
    EXPECT_EQ(make_tool(tool_spec_from("point"), 1), nullptr);
    EXPECT_NEAR(extent("sphere:3").sizes()[2], 6, 0.05);
    EXPECT_EQ(extent("rod:7.5").max(), Vec3(0, 0, 7.5));
    EXPECT_TRUE(extent("box:1,2,3").sizes().isApprox(Vec3(1, 2, 3)));
    EXPECT_NEAR(extent("needle").max()[2], 60, 1e-9);
    EXPECT_NEAR(extent("needle").min()[2], 0, 1e-9) << "the tip is the reference point";
    EXPECT_NEAR(extent("needle:20,2").max()[0], 2, 1e-9);
    EXPECT_NEAR(extent("burr:1").min()[2], -1, 1e-9);
    EXPECT_NEAR(extent("burr:1").max()[2], 4, 1e-9);
    EXPECT_NEAR(make_tool(tool_spec_from("fingertip"), 0.5)->radius(), std::hypot(8, 12), 0.1);
}

TEST(ToolFile, round_shapes_have_points_all_over_no_farther_apart_than_asked) {
    const double pi = std::acos(-1);
    const auto on_ball = [&](double radius) {
        return [radius](Random& random) { return Vec3(radius * random.direction()); };
    };
    EXPECT_LT(widest_gap(sphere_tool(3, 0.5), on_ball(3)), 0.5);
    const auto on_tip = [&](Random& random) {
        Vec3 d = random.direction();
        d[2] = -std::abs(d[2]);
        return Vec3(2 * d + Vec3(0, 0, 2));
    };
    EXPECT_LT(widest_gap(needle_tool(20, 2, 0.4), on_tip), 0.4);
    const auto on_shaft = [&](Random& random) {
        const double angle = random.uniform(0, 2 * pi);
        return Vec3(2 * std::cos(angle), 2 * std::sin(angle), random.uniform(2, 20));
    };
    EXPECT_LT(widest_gap(needle_tool(20, 2, 0.4), on_shaft), 0.4);
    const auto on_burr = [&](Random& random) {
        Vec3 d = random.direction();
        if (d[2] > 0.5) d[2] = -d[2];
        return Vec3(3 * d);
    };
    EXPECT_LT(widest_gap(burr_tool(3, 0.5), on_burr), 0.5);
    const Tool burr = burr_tool(3, 0.5);
    for (const Vec3& point : burr.points()) {
        const double across = std::hypot(point[0], point[1]);
        EXPECT_TRUE(std::abs(point.norm() - 3) < 0.03 || std::abs(across - 1.2) < 0.03) << point;
    }
}

TEST(ToolFile, a_file_of_points_is_the_tool) {
    const ScratchFolder folder;
    const std::string path = (folder / "hook.csv").string();
    std::ofstream(path) << "# a hook\nname,x,y,z\ntip,0,0,0\nbarb,1,0.5,-2e-1\n";
    const auto tool = make_tool(tool_spec_from(path), 1);
    ASSERT_EQ(tool->points().size(), 2U);
    EXPECT_EQ(tool->points()[1], Vec3(1, 0.5, -0.2));
}

TEST(ToolFile, what_is_no_tool_is_refused_in_words) {
    for (const char* text :
         {"", "spoon", "sphere", "sphere:", "sphere:0", "sphere:-1", "sphere:nan", "sphere:inf",
          "sphere:1,2", "box:1,2", "box:1,2,3,4", "box:1,,3", "rod:1e7", "needle:5", "burr:x",
          "point:1", "fingertip:2", "needle:1,2"}) {
        EXPECT_THROW((void)make_tool(tool_spec_from(text), 0.5), std::invalid_argument) << text;
    }
    EXPECT_THROW((void)tool_spec_from("missing.csv"), InputError);
    for (const char* text : {"x,y\n1,2\n", "x,y,z\n", "x,y,z\n1,2,nan\n", "x,y,z\n1,2\n"}) {
        EXPECT_THROW((void)parse_tool_points(text, "t.csv"), InputError) << text;
    }
    EXPECT_THROW((void)make_tool(SphereSpec{50}, 0.1), std::invalid_argument) << "too many points";
    EXPECT_THROW((void)make_tool(SphereSpec{1}, 0), std::invalid_argument);
}

TEST(ToolFile, a_tool_of_a_similar_name_is_suggested) {
    const auto told = [](const std::string& text) -> std::string {
        try {
            (void)tool_spec_from(text);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_TRUE(told("spher:2").ends_with(" (did you mean sphere:2?)")) << told("spher:2");
    EXPECT_TRUE(told("Needle").ends_with(" (did you mean needle?)")) << told("Needle");
    EXPECT_TRUE(told("point:1").ends_with(" (did you mean point?)")) << told("point:1");
    EXPECT_TRUE(told("lever:1").ends_with(" .vtp)")) << told("lever:1");
}

TEST(ToolFile, a_mesh_of_many_triangles_can_be_stopped_on_its_way_to_a_tool) {
    constexpr std::uint32_t edge = 100;
    ToolShape sheet;
    for (std::uint32_t y = 0; y <= edge; ++y) {
        for (std::uint32_t x = 0; x <= edge; ++x) {
            sheet.vertices.emplace_back(x, y, 0);
            const std::uint32_t next = edge + 1, at = y * next + x;
            if (x == edge || y == edge) continue;
            sheet.triangles.push_back({at, at + 1, at + next});
            sheet.triangles.push_back({at + 1, at + next + 1, at + next});
        }
    }
    const MeshSpec spec{std::make_shared<const ToolShape>(std::move(sheet))};
    std::vector<double> parts;
    const auto whole = make_tool(spec, 4, [&](double part) { parts.push_back(part); });
    EXPECT_GT(parts.size(), 10U);
    EXPECT_TRUE(std::ranges::is_sorted(parts));
    EXPECT_LE(parts.back(), 1);
    for (const std::size_t last : {std::size_t{1}, parts.size() / 2, parts.size()}) {
        std::size_t calls = 0;
        EXPECT_THROW((void)make_tool(spec, 4,
                                     [&](double) {
                                         if (++calls == last) throw std::runtime_error("stop");
                                     }),
                     std::runtime_error);
        EXPECT_EQ(calls, last);
    }
    const auto untold = make_tool(spec, 4);
    EXPECT_TRUE(std::ranges::equal(whole->points(), untold->points()));
}

}  // namespace
}  // namespace palpate::io
