// Orientation and samples of slices, smooth lines in a mask, and pictures on real data.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <QGridLayout>
#include <QPalette>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "apps/viewer/slices/plane.hpp"
#include "apps/viewer/slices/samples.hpp"
#include "apps/viewer/slices/slice_picture.hpp"
#include "palpate/run/source.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"
#include "viewer/slices/pane_support.hpp"

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
            all += plane.at_bottom + position_text(plane, {10, 20, 30});
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
            const Vec3 first = plane.physical({0, 0, 2});
            const Vec3 right = plane.physical({1, 0, 2}) - first;
            const Vec3 down = plane.physical({0, 1, 2}) - first;
            EXPECT_GT(right.dot(plane.at_right == "L" ? left : back), 0.5);
            EXPECT_GT(down.dot(plane.at_bottom == "P" ? back : -head), 0.5);
        }
    }
}

TEST(SlicePlane, points_come_back_from_physical_space) {
    support::Random random(7);
    for (const Mat3& direction : signed_orders()) {
        const Geometry geometry = grid({4, 5, 6}, {1, 2, 3}, {7, 8, 9}, direction);
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(geometry, axis);
            const Vec3 index = random.point(-2, 7);
            const Vec3 physical = physical_from_index(geometry, index);
            const Vec3 point = plane.point(physical);
            EXPECT_LT((plane.physical(point) - physical).norm(), 1e-12);
            EXPECT_NEAR(point[2], index[axis], 1e-12);
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
    EXPECT_EQ(position_text(slice_plane(mirrored, 2), {1, 2, 12.5}), "S 12.50 mm");
    EXPECT_EQ(position_text(slice_plane(mirrored, 2), {1, 2, -3}), "I 3.00 mm");
    EXPECT_EQ(position_text(slice_plane(mirrored, 0), {-4, 2, 9}), "R 4.00 mm");
    const double fine = 0.0003;  // a microscope's
    const Geometry cell =
        grid({4, 5, 6}, Vec3::Constant(fine), Vec3::Zero(), columns(-left, back, -head));
    EXPECT_EQ(position_text(slice_plane(cell, 2), {1, 2, 2 * fine}), "S 0.60 µm");
}

/// A value that tells its place, on a mirrored and turned grid.
Field ramp(SampleType type) {
    Mat3 direction;
    direction << 0, 0, -1, -1, 0, 0, 0, 1, 0;
    const Geometry geometry = support::grid({7, 6, 5}, {1, 2, 3}, {10, 20, 30}, direction);
    const auto value = [](const Index3& i) { return i[0] + 10 * i[1] + 40 * i[2]; };
    return with_type(type, [&](auto zero) {
        return linear_field(support::volume_of<decltype(zero)>(geometry, value));
    });
}

TEST(SliceSamples, are_those_of_the_volume_whatever_its_type_axis_and_direction) {
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        const Field field = ramp(type);
        for (int axis = 0; axis < 3; ++axis) {
            const SlicePlane plane = slice_plane(field.geometry(), axis);
            SliceSamples samples(field, plane);
            for (const double position : {1.25, 2.0, 0.0, 3.5, 3.75, 2.75}) {
                samples.go_to(position);
                std::vector<float> row(static_cast<std::size_t>(samples.width()));
                for (int v = 0; v < samples.height(); ++v) {
                    samples.interpolate(v, row.data());
                    for (int u = 0; u < samples.width(); ++u) {
                        const Vec3 i = index_from_physical(
                            field.geometry(), plane.physical({double(u), double(v), position}));
                        EXPECT_NEAR(row[std::size_t(u)], i[0] + 10 * i[1] + 40 * i[2], 1e-4);
                    }
                }
            }
        }
    }
}

TEST(SliceSamples, have_a_ring_of_background_and_are_background_outside) {
    const Field field = linear_field(ramp(SampleType::int16).volume(), Solid::above, -77);
    const SlicePlane plane = slice_plane(field.geometry(), 1);
    SliceSamples samples(field, plane);
    samples.go_to(2.5);
    for (int v = -1; v <= samples.height(); ++v) {
        for (const int layer : {0, 1}) {
            EXPECT_EQ(samples.row(layer, v)[-1], -77);
            EXPECT_EQ(samples.row(layer, v)[samples.width()], -77);
        }
    }
    for (const double outside : {-1.0, 6.0, 1e300, -1e300}) {
        samples.go_to(outside);
        EXPECT_FALSE(samples.in_data());
        for (int u = 0; u < samples.width(); ++u) EXPECT_EQ(samples.row(0, 2)[u], -77);
    }
    samples.go_to(std::nan(""));
    EXPECT_TRUE(std::isfinite(samples.position()));
}

TEST(SliceSamples, beyond_the_last_layer_its_voxels_go_on) {
    const Field field = ramp(SampleType::float32);
    SliceSamples samples(field, slice_plane(field.geometry(), 2));
    std::vector<float> inside(static_cast<std::size_t>(samples.width())), border = inside;
    for (const auto& [position, layer] : {std::pair{4.4, 4.0}, {-0.4, 0.0}}) {
        samples.go_to(layer);
        samples.interpolate(1, inside.data());
        samples.go_to(position);
        EXPECT_TRUE(samples.in_data());
        samples.interpolate(1, border.data());
        EXPECT_EQ(inside, border);
    }
}

double covered(const LineMask& mask) {
    double sum = 0;
    for (int y = 0; y < mask.height(); ++y) {
        for (int x = 0; x < mask.width(); ++x) sum += mask.row(y)[x] / 255.0;
    }
    return sum;
}

TEST(LineMask, covers_as_much_as_the_line_is_large_in_any_direction) {
    support::Random random(3);
    for (int i = 0; i < 50; ++i) {
        LineMask mask(200, 200);
        const double angle = random.uniform(0, 7), length = random.uniform(20, 80);
        const double dx = length * std::cos(angle), dy = length * std::sin(angle);
        mask.draw(100, 100, 100 + dx, 100 + dy, 1.5);
        const double area = 3 * length + 3.14159 * 1.5 * 1.5;
        EXPECT_NEAR(covered(mask), area, 0.06 * area);
    }
}

TEST(LineMask, the_same_line_twice_or_in_pieces_is_the_same) {
    LineMask once(50, 50), twice(50, 50);
    once.draw(5.3, 7.1, 44, 31, 0.8);
    twice.draw(5.3, 7.1, 44, 31, 0.8);
    twice.draw(5.3, 7.1, 44, 31, 0.8);
    for (int y = 0; y < 50; ++y) {
        for (int x = 0; x < 50; ++x) EXPECT_EQ(once.row(y)[x], twice.row(y)[x]);
    }
}

TEST(LineMask, what_is_far_outside_or_far_longer_than_the_picture_does_no_harm) {
    LineMask mask(20, 10);
    mask.draw(-50, -50, -40, 90, 1);
    mask.draw(1e9, 3, 2e9, 3, 1);
    EXPECT_EQ(covered(mask), 0);
    mask.draw(-1e9, 5, 1e9, 5, 1);
    EXPECT_NEAR(covered(mask), 2 * 20, 2);
    mask.draw(5, 5, 5, 5, 1);  // a dot
    mask.draw(std::nan(""), 5, 5, 5, 1);
    LineMask nothing(0, 0);
    nothing.draw(0, 0, 5, 5, 1);
}

Volume real(const std::string& name) {
    return run::load(run::source_named(std::string(PALPATE_DATA_FOLDER) + "/" + name)).volume;
}

bool there_is(const std::string& name) {
    return std::filesystem::exists(std::string(PALPATE_DATA_FOLDER) + "/" + name);
}

/// Three panes round a contact with what is felt.
struct ThreePanes {
    QWidget window;
    std::array<SlicePane*, 3> panes;

    ThreePanes(const Field& field, double isovalue, const Vec3& hand_from) {
        auto* layout = new QGridLayout(&window);
        Proxy proxy;
        place(proxy, field, hand_from, isovalue);
        const Vec3 middle = physical_centre(field.geometry());
        const RayHit hit = cast_ray(field, isovalue, hand_from, middle);
        // 6 mm into what is there.
        const Vec3 hip = hit.point + 6 * (middle - hand_from).normalized();
        const ProxyUpdate update = update_exact(proxy, field, hip);
        for (const int axis : {0, 1, 2}) {
            auto* pane = panes[std::size_t(axis)] = new SlicePane(axis);
            pane->set_field(field, isovalue);
            set(*pane, &Shown::crosshair, update.scp);
            pane->show_snapshot(contact_at(hip, update.scp, 0.3 * (update.scp - hip)));
            layout->addWidget(pane, 0, 2 - axis);
        }
        window.resize(QSize(1200, 420));
        window.show();
        wait_until_exposed(window);
    }
};

TEST(SlicePictures, show_the_ct_of_a_head) {
    if (!there_is("cthead_unc.nrrd")) GTEST_SKIP() << "needs cthead_unc.nrrd";
    const Field field = linear_field(real("cthead_unc.nrrd"));
    ThreePanes shown(field, 500, physical_centre(field.geometry()) + Vec3(30, -140, 20));
    keep_picture(shown.window, "slices_ct_head");
    const QPoint middle = shown.panes[2]->rect().center();
    QTest::mouseMove(shown.panes[2], middle + QPoint(40, 10));
    for (int i = 0; i < 8; ++i) {
        const QPoint at = shown.panes[2]->pixel_of(shown.panes[2]->shown().crosshair).toPoint();
        QWheelEvent zoom(at, shown.panes[2]->mapToGlobal(at), {}, {0, 120}, Qt::NoButton,
                         Qt::ControlModifier, Qt::NoScrollPhase, false);
        QApplication::sendEvent(shown.panes[2], &zoom);
    }
    keep_picture(*shown.panes[2], "slices_ct_head_zoomed");
}

TEST(SlicePictures, show_a_small_pane_under_the_pointer) {
    if (!there_is("cthead_unc.nrrd")) GTEST_SKIP() << "needs cthead_unc.nrrd";
    SlicePane pane(2);
    pane.resize(240, 260);
    pane.set_field(linear_field(real("cthead_unc.nrrd")), 500);
    pane.show();
    wait_until_exposed(pane);
    QMouseEvent move(QEvent::MouseMove, QPointF(140, 120), Qt::NoButton, Qt::NoButton,
                     Qt::NoModifier);
    QApplication::sendEvent(&pane, &move);
    keep_picture(pane, "slices_small");
}

TEST(SlicePictures, show_a_lobster) {
    if (!there_is("lobster.nrrd")) GTEST_SKIP() << "needs lobster.nrrd";
    const Field field = linear_field(real("lobster.nrrd"));
    ThreePanes shown(field, 40, physical_centre(field.geometry()) + Vec3(0, 0, 120));
    keep_picture(shown.window, "slices_lobster");
}

TEST(SlicePictures, mirrored_and_aslant_grids_show_the_same_head_in_the_same_orientation) {
    if (!there_is("cthead_unc.nrrd")) GTEST_SKIP() << "needs cthead_unc.nrrd";
    const Volume head = real("cthead_unc.nrrd");
    // The same bytes, told to run the other way: seen upside down and mirrored.
    Geometry mirrored = head.geometry();
    mirrored.direction = Vec3(-1, 1, -1).asDiagonal();
    Geometry aslant = head.geometry();
    aslant.direction = support::oblique_direction();
    for (const auto& [name, geometry] :
         {std::pair{"slices_mirrored", mirrored}, {"slices_aslant", aslant}}) {
        const auto samples = head.samples<std::uint16_t>();
        const Field field = linear_field(
            Volume(geometry, std::vector<std::uint16_t>(samples.begin(), samples.end())));
        ThreePanes shown(field, 500, physical_centre(geometry) + Vec3(20, -150, 10));
        keep_picture(shown.window, name);
    }
}

TEST(SlicePictures, show_empty_panes_and_focus_in_dark_and_light) {
    const QPalette before = QApplication::palette();
    for (const bool dark : {false, true}) {
        if (dark) {
            QPalette palette(QColor(40, 40, 40), QColor(30, 30, 30));
            palette.setColor(QPalette::Highlight, QColor(80, 140, 220));
            QApplication::setPalette(palette);
        }
        QWidget window;
        auto* layout = new QGridLayout(&window);
        auto* empty = new SlicePane(0);
        auto* full = new SlicePane(2);
        full->set_field(ball_on(support::oblique_direction()), 0.5);
        layout->addWidget(empty, 0, 0);
        layout->addWidget(full, 0, 1);
        window.resize(700, 340);
        window.show();
        QApplication::setActiveWindow(&window);
        wait_until_exposed(window);
        full->setFocus();
        keep_picture(window, dark ? "slices_dark" : "slices_light");
    }
    QApplication::setPalette(before);
}

}  // namespace
}  // namespace palpate::viewer
