// The orientation in which slices are shown.
#include "apps/viewer/slices/plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "support/fields.hpp"

namespace palpate::viewer {
namespace {

using support::grid;

Mat3 columns(const Vec3& x, const Vec3& y, const Vec3& z) {
    Mat3 direction;
    direction << x, y, z;
    return direction;
}

const Vec3 left(1, 0, 0), back(0, 1, 0), head(0, 0, 1);

/// Grids whose axes run along the body's in every order and direction, 48 of them.
std::vector<Mat3> signed_orders() {
    std::vector<Mat3> all;
    std::array<int, 3> order{0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            Mat3 direction = Mat3::Zero();
            for (int a = 0; a < 3; ++a) direction(order[a], a) = signs >> a & 1 ? -1 : 1;
            all.push_back(direction);
        }
    } while (std::next_permutation(order.begin(), order.end()));
    return all;
}

TEST(SlicePlane, every_grid_is_shown_in_the_radiological_convention) {
    for (const Mat3& direction : signed_orders()) {
        const Geometry geometry = grid({4, 5, 6}, {1, 2, 3}, {7, 8, 9}, direction);
        std::set<std::string> titles;
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(geometry, axis);
            titles.insert(plane.title);
            if (plane.title == "Axial") {
                EXPECT_EQ(plane.at_left + plane.at_right, "RL");
                EXPECT_EQ(plane.at_top + plane.at_bottom, "AP");
            } else if (plane.title == "Coronal") {
                EXPECT_EQ(plane.at_left + plane.at_right, "RL");
                EXPECT_EQ(plane.at_top + plane.at_bottom, "SI");
            } else {
                EXPECT_EQ(plane.at_left + plane.at_right, "AP");
                EXPECT_EQ(plane.at_top + plane.at_bottom, "SI");
            }
        }
        EXPECT_EQ(titles.size(), 3U);
    }
}

TEST(SlicePlane, sides_that_the_file_does_not_tell_are_not_named) {
    for (const Mat3& direction : signed_orders()) {
        Geometry geometry = grid({4, 5, 6}, {1, 2, 3}, {7, 8, 9}, direction);
        geometry.oriented = false;
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(geometry, axis);
            std::string all = plane.title + plane.at_left + plane.at_right + plane.at_top;
            all += plane.at_bottom + position_text(plane, geometry, {10, 20, 30});
            all.resize(all.find(" "));
            EXPECT_EQ(all.find_first_not_of("XYZ+-"), std::string::npos) << all;
        }
    }
}

TEST(SlicePlane, right_on_the_screen_is_where_its_letter_says) {
    for (const Mat3& direction : signed_orders()) {
        const Geometry geometry = grid({4, 5, 6}, {1, 2, 3}, {7, 8, 9}, direction);
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(geometry, axis);
            const auto at = [&](const Vec3& slice) {
                return physical_from_index(geometry, index_from_slice(plane, geometry, slice));
            };
            const Vec3 right = at({1, 0, 2}) - at({0, 0, 2}), down = at({0, 1, 2}) - at({0, 0, 2});
            EXPECT_GT(right.dot(plane.at_right == "L" ? left : back), 0.5);
            EXPECT_GT(down.dot(plane.at_bottom == "P" ? back : -head), 0.5);
        }
    }
}

TEST(SlicePlane, slice_coordinates_come_back_from_index_space) {
    support::Random random(7);
    for (const Mat3& direction : signed_orders()) {
        const Geometry geometry = grid({4, 5, 6}, {1, 2, 3}, {7, 8, 9}, direction);
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(geometry, axis);
            const Vec3 index = random.point(-2, 7);
            const Vec3 slice = slice_from_index(plane, geometry, index);
            EXPECT_LT((index_from_slice(plane, geometry, slice) - index).norm(), 1e-12);
            EXPECT_EQ(slice[2], index[axis]);
        }
    }
}

TEST(SlicePlane, aslant_grids_name_all_sides_that_an_edge_lies_towards) {
    const Mat3 turned =
        Eigen::AngleAxisd(30 * 3.14159265358979 / 180, Vec3::UnitZ()).toRotationMatrix();
    const SlicePlane axial = slice_plane(grid({4, 5, 6}, Vec3::Ones(), Vec3::Zero(), turned), 2);
    EXPECT_EQ(axial.title, "Axial");
    EXPECT_EQ(axial.at_right, "LP");
    EXPECT_EQ(axial.at_left, "RA");
    EXPECT_EQ(axial.at_top, "AL");
    EXPECT_EQ(axial.at_bottom, "PR");
    const Mat3 little =
        Eigen::AngleAxisd(10 * 3.14159265358979 / 180, Vec3::UnitZ()).toRotationMatrix();
    EXPECT_EQ(slice_plane(grid({4, 5, 6}, Vec3::Ones(), Vec3::Zero(), little), 2).at_right, "L");
}

TEST(SlicePlane, any_orientation_gives_three_different_planes) {
    support::Random random(11);
    for (int i = 0; i < 300; ++i) {
        const Vec3 x = random.direction(), y = x.unitOrthogonal();
        const Mat3 direction =
            Eigen::AngleAxisd(random.uniform(0, 7), x) * columns(x, y, x.cross(y));
        const Geometry geometry = grid({4, 5, 6}, Vec3::Ones(), Vec3::Zero(), direction);
        std::set<int> body, screen;
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(geometry, axis);
            body.insert(plane.anatomical);
            EXPECT_NE(plane.right.axis, plane.down.axis);
            EXPECT_NE(plane.right.axis, axis);
            EXPECT_NE(plane.down.axis, axis);
        }
        EXPECT_EQ(body.size(), 3U);
    }
}

TEST(SlicePlane, the_position_names_the_side_of_the_body_it_lies_on) {
    const Geometry mirrored =
        grid({4, 5, 6}, Vec3::Ones(), Vec3::Zero(), columns(-left, back, -head));
    EXPECT_EQ(position_text(slice_plane(mirrored, 2), mirrored, {1, 2, 12.5}), "S 12.50 mm");
    EXPECT_EQ(position_text(slice_plane(mirrored, 2), mirrored, {1, 2, -3}), "I 3.00 mm");
    EXPECT_EQ(position_text(slice_plane(mirrored, 0), mirrored, {-4, 2, 9}), "R 4.00 mm");
}

}  // namespace
}  // namespace palpate::viewer
