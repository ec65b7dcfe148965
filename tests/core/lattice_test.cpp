// The lattice: every point has a tetrahedron, walls are shared, the field is continuous; against
// the paper's own form with explicit tetrahedra and barycentric coordinates.
#include "palpate/lattice.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>

#include "support/fields.hpp"
#include "support/paper_lattice.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

bool is_inside(const Vec3& u) {
    return u[0] <= 0.5 && u[0] >= u[1] && u[1] >= std::abs(u[2]);
}

/// The centroid of a tetrahedron in index space, from its folded form: what names it.
Vec3 centroid(const Tetrahedron& t) {
    const Vec3 folded = (Vec3(0.5, 0, 0) + Vec3(0.5, 0.5, 0.5) + Vec3(0.5, 0.5, -0.5)) / 4;
    return index_of({t, folded});
}

/// A point of a random kind: general, on walls, on edges, on vertices; with exact coordinates.
Vec3 random_index(Random& random, double low, double high) {
    Vec3 p = random.point(low, high);
    switch (random.below(8)) {
        case 0:
            p[random.below(3)] = double(int(low)) + random.below(int(high - low));
            break;
        case 1:
            p = (p * 2).array().round() / 2;
            break;
        case 2:
            p = (p * 8).array().round() / 8;
            break;
        case 3:
            p[1] = p[0];
            break;
        case 4:
            p[2] = 5 - p[0];
            break;
        case 5:
            p[0] = std::floor(p[0]) + 0.5;
            break;
        default:
            break;
    }
    return p;
}

/// A random point of the folded tetrahedron, often exactly on walls.
Vec3 random_folded(Random& random) {
    const double d = random.chance(0.3) ? 0.5 : random.uniform(0, 0.5);
    const double s = random.chance(0.3) ? d : random.uniform(0, d);
    const int kind = random.below(4);
    const double e = kind == 0 ? s : kind == 1 ? -s : random.uniform(-s, s);
    return {d, s, e};
}

LatticePoint random_point(Random& random) {
    LatticePoint p = locate(random.point(-3, 9));
    p.folded = random_folded(random);
    return p;
}

std::vector<TestField> every_sample_type() {
    return {
        noise_field(),
        anisotropic_field(),
        oblique_field(),
        {"float", linear_field(noise_volume<float>(grid({7, 9, 8}), 6, -3, 9), Solid::below), 2}};
}

}  // namespace

TEST(Lattice, a_located_point_is_the_point_it_was_located_from) {
    Random random(111);
    for (int i = 0; i < scaled(100000); ++i) {
        const Vec3 p = random_index(random, -10, 30);
        const LatticePoint at = locate(p);
        ASSERT_TRUE(is_inside(at.folded)) << p.transpose();
        ASSERT_LE((index_of(at) - p).cwiseAbs().maxCoeff(), 4e-15) << p.transpose();
        auto axes = at.tetrahedron.axis;
        std::sort(axes.begin(), axes.end());
        ASSERT_EQ(axes, (std::array<std::int8_t, 3>{0, 1, 2}));
    }
    for (const Vec3& far : {Vec3(1e9, -1e9, 1e9), Vec3(-1e9, 0.25, 999999999.5)}) {
        EXPECT_EQ(index_of(locate(far)), far);
        EXPECT_TRUE(is_inside(locate(far).folded));
    }
}

TEST(Lattice, value_and_gradient_are_those_of_the_papers_barycentric_form) {
    Random random(112);
    for (const TestField& test : every_sample_type()) {
        const Field& field = test.field;
        const Vec3 size = field.geometry().size.cast<double>();
        for (int i = 0; i < scaled(20000); ++i) {
            const Vec3 index = random_index(random, -2, size.maxCoeff() + 2);
            const PaperPlace paper = paper_locate(index);
            const double expected = paper_value(field, index);
            const LatticePoint at = locate(index);
            ASSERT_NEAR(value_at(field, at), expected, 1e-13 * field.range()) << index.transpose();
            const Vec3 physical = physical_from_index(field.geometry(), index);
            ASSERT_NEAR(value_at(field, physical), expected, 1e-11 * field.range());
            // The gradient is one of a tetrahedron that contains the point; inside one, its own.
            if (paper.barycentric.minCoeff() < 1e-9) continue;
            const LinearPiece piece = piece_of(at.tetrahedron, field.cell(at.tetrahedron.cell));
            const Vec3 gradient = unfold(at.tetrahedron, piece.gradient);
            ASSERT_LE((gradient - paper_gradient(field, paper)).norm(), 1e-12 * field.range());
        }
    }
}

TEST(Lattice, gradient_in_physical_space_agrees_with_central_differences) {
    Random random(113);
    for (const TestField& test : every_sample_type()) {
        const Field& field = test.field;
        const Geometry& geometry = field.geometry();
        int compared = 0;
        for (int i = 0; i < scaled(4000); ++i) {
            const Vec3 index = random.point(-1, geometry.size.cast<double>().maxCoeff());
            if (paper_locate(index).barycentric.minCoeff() < 1e-3) continue;
            const Vec3 p = physical_from_index(geometry, index);
            const double h = 1e-4 * geometry.spacing.minCoeff();
            Vec3 differences;
            for (int a = 0; a < 3; ++a) {
                const Vec3 step = h * Vec3::Unit(a);
                differences[a] = (value_at(field, p + step) - value_at(field, p - step)) / (2 * h);
            }
            ++compared;
            ASSERT_LE((gradient_at(field, p) - differences).norm(), 1e-7 * field.range());
        }
        EXPECT_GT(compared, scaled(4000) / 2);
    }
}

TEST(Lattice, field_is_background_outside_the_padded_grid_and_has_no_gradient_there) {
    for (const TestField& test : every_sample_type()) {
        Random random(114);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 index = random.point(2, 7) - 12 * Vec3::Unit(random.below(3));
            const Vec3 p = physical_from_index(test.field.geometry(), index);
            ASSERT_EQ(value_at(test.field, p), test.field.background());
            ASSERT_EQ(gradient_at(test.field, p), Vec3::Zero());
        }
        EXPECT_EQ(value_at(test.field, Vec3(1e12, 0, 0)), test.field.background());
        EXPECT_EQ(gradient_at(test.field, Vec3(0, -1e300, 0)), Vec3::Zero());
    }
}

TEST(Lattice, walls_are_the_faces_of_the_tetrahedron) {
    Random random(115);
    const std::array<Vec3, 4> vertex{Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(0.5, 0.5, 0.5),
                                     Vec3(0.5, 0.5, -0.5)};
    // Which vertices each wall holds, by geometry: all but one.
    std::array<int, 4> left_out{};
    for (unsigned w = 0; w < wall_count; ++w) {
        int on = 0;
        for (int v = 0; v < 4; ++v) {
            on += slack(vertex[v], w) == 0;
            if (slack(vertex[v], w) > 0) left_out[w] = v;
        }
        EXPECT_EQ(on, 3);
        EXPECT_GT(slack(Vec3(0.4, 0.2, 0.05), w), 0);
        EXPECT_EQ(
            wall_normal(w).dot(vertex[left_out[w]] - Vec3(0.5, 0.5, 0.5)) < 0 || left_out[w] == 2,
            true);
    }
    std::sort(left_out.begin(), left_out.end());
    EXPECT_EQ(left_out, (std::array<int, 4>{0, 1, 2, 3}));
    for (int i = 0; i < 2000; ++i) {
        const Vec3 u = random_folded(random);
        const Vec3 d = random.direction();
        const unsigned on = walls_at(u);
        for (unsigned w = 0; w < wall_count; ++w) {
            ASSERT_EQ(has(on, w), slack(u, w) == 0);
            // approach is the rate of the slack, and the product with the outward normal.
            ASSERT_NEAR(slack(u, w) - slack(u + 0.25 * d, w), 0.25 * approach(d, w), 1e-15);
            ASSERT_NEAR(approach(d, w), wall_normal(w).dot(d), 1e-15);
        }
    }
}

TEST(Lattice, across_a_wall_is_another_tetrahedron_with_the_same_points_on_the_wall) {
    Random random(116);
    for (int i = 0; i < scaled(50000); ++i) {
        LatticePoint p = random_point(random);
        for (unsigned w = 0; w < wall_count; ++w) {
            const Tetrahedron& t = p.tetrahedron;
            const Tetrahedron next = across(t, w);
            ASSERT_FALSE(same_tetrahedron(t, next));
            const Tetrahedron back = across(next, w);
            ASSERT_TRUE(same_tetrahedron(t, back));
            ASSERT_EQ(back.sign, t.sign);
            // On the wall the folded coordinates are the same, so the point is, bit for bit.
            const Vec3 on_wall = snap(p.folded, 1U << w);
            ASSERT_EQ(slack(on_wall, w), 0);
            ASSERT_EQ(index_of({next, on_wall}), index_of({t, on_wall}));
            // Vectors are mirrored: they are the same in index space.
            const Vec3 v = random.direction();
            ASSERT_EQ(unfold(next, reflect(fold(t, v), w)), v);
            ASSERT_EQ(approach(reflect(fold(t, v), w), w), -approach(fold(t, v), w));
            const Vec3 lengths = random.point(0.1, 3);
            ASSERT_EQ(fold_lengths(next, lengths), fold(next, lengths).cwiseAbs());
            // The two tetrahedra are mirror images in the wall.
            const Vec3 n = unfold(t, wall_normal(w)).normalized();
            const Vec3 middle = centroid(t);
            const Vec3 mirrored = middle - 2 * n * n.dot(middle - index_of({t, on_wall}));
            ASSERT_LE((centroid(next) - mirrored).norm(), 1e-14);
        }
    }
}

TEST(Lattice, field_is_continuous_across_every_wall) {
    Random random(117);
    for (const TestField& test : every_sample_type()) {
        for (int i = 0; i < scaled(20000); ++i) {
            LatticePoint p = random_point(random);
            for (unsigned w = 0; w < wall_count; ++w) {
                const Vec3 on_wall = snap(p.folded, 1U << w);
                const double here = value_at(test.field, LatticePoint{p.tetrahedron, on_wall});
                const double there =
                    value_at(test.field, LatticePoint{across(p.tetrahedron, w), on_wall});
                ASSERT_NEAR(here, there, 1e-14 * test.field.range());
            }
        }
    }
}

TEST(Lattice, a_walk_through_across_never_leaves_the_straight_line) {
    Random random(118);
    for (int i = 0; i < scaled(500); ++i) {
        LatticePoint p = locate(random_index(random, 0, 9));
        const Vec3 start = index_of(p);
        const Vec3 way =
            i % 3 == 0 ? Vec3(random.below(3) - 1, random.below(3) - 1, 1) : random.direction();
        Vec3 direction = fold(p.tetrahedron, way);
        double walked = 0;
        for (int step = 0; step < 200; ++step) {
            double t = 1e9;
            unsigned wall = 0;
            for (unsigned w = 0; w < wall_count; ++w) {
                const double speed = approach(direction, w);
                if (speed > 0 && slack(p.folded, w) / speed < t) {
                    t = slack(p.folded, w) / speed;
                    wall = w;
                }
            }
            ASSERT_LT(t, 2) << "no wall ahead";
            p.folded = snap(p.folded + t * direction, 1U << wall);
            walked += t;
            p.tetrahedron = across(p.tetrahedron, wall);
            direction = reflect(direction, wall);
            ASSERT_TRUE(is_inside(p.folded));
            ASSERT_EQ(unfold(p.tetrahedron, direction), way);
            ASSERT_LE((index_of(p) - (start + walked * way)).norm(), 1e-12);
        }
        EXPECT_GT(walked, 5);
    }
}

TEST(Lattice, incident_tetrahedra_are_those_that_contain_the_point) {
    Random random(119);
    std::array<int, 49> seen{};
    for (int i = 0; i < scaled(6000); ++i) {
        const Vec3 index = random_index(random, -3, 9);
        const LatticePoint at = locate(index);
        const Incident incident = incident_tetrahedra(at);
        const std::vector<Vec3> expected = paper_incident(index);
        // Within rounding of a wall but not on it: the reference's tolerance takes more.
        if (paper_incident(index, 1e-18).size() != expected.size()) continue;
        ASSERT_EQ(static_cast<std::size_t>(incident.count), expected.size()) << index.transpose();
        ++seen[static_cast<std::size_t>(incident.count)];
        ASSERT_TRUE(same_tetrahedron(incident.tetrahedra[0], at.tetrahedron));
        for (int k = 0; k < incident.count; ++k) {
            const Vec3 c = centroid(incident.tetrahedra[static_cast<std::size_t>(k)]);
            int found = 0;
            for (const Vec3& e : expected) found += (e - c).norm() < 1e-9;
            ASSERT_EQ(found, 1) << "not incident, or twice";
            ASSERT_LE(
                (index_of({incident.tetrahedra[static_cast<std::size_t>(k)], at.folded}) - index)
                    .norm(),
                1e-14);
        }
    }
    for (const int count : {1, 2, 4, 8, 24, 48}) {
        EXPECT_GT(seen[static_cast<std::size_t>(count)], scaled(6000) / 100) << count;
    }
}

TEST(Lattice, counts_of_incident_tetrahedra_at_known_places) {
    struct Known {
        Vec3 index;
        int count;
    };
    const std::array<Known, 10> places{
        Known{{4.1, 3.8, 2.33}, 1},    // inside
        Known{{4, 3.3, 2.4}, 2},       // in a face between two cells
        Known{{4.25, 3.25, 2.4}, 2},   // between the tetrahedra of one cell
        Known{{4.25, 3.5, 2.5}, 4},    // from a cell's centre to a face's
        Known{{4, 3.25, 2.25}, 4},     // in a face, from its centre to a sample
        Known{{4.25, 3.25, 2.25}, 6},  // from a cell's centre to a sample
        Known{{4, 3, 2.5}, 8},         // along an edge of the grid
        Known{{4, 3.5, 2.5}, 8},       // the centre of a face
        Known{{4.5, 3.5, 2.5}, 24},    // the centre of a cell
        Known{{4, 3, 2}, 48},          // a sample
    };
    for (const Known& known : places) {
        EXPECT_EQ(incident_tetrahedra(locate(known.index)).count, known.count)
            << known.index.transpose();
        EXPECT_EQ(paper_incident(known.index).size(), static_cast<std::size_t>(known.count))
            << known.index.transpose();
    }
}

TEST(Lattice, snap_is_exact_and_idempotent_and_pulls_back_inside) {
    Random random(120);
    for (int i = 0; i < scaled(50000); ++i) {
        const Vec3 u = random_folded(random);
        ASSERT_EQ(snap(u, 0), u);
        ASSERT_EQ(snap(u, walls_at(u)), u);
        const Vec3 off = u + 1e-13 * random.direction();
        for (unsigned walls = 0; walls < 16; ++walls) {
            // The face and both walls through its centre meet there; with the fourth, nowhere.
            if (walls == 0b1111) continue;
            const Vec3 s = snap(off, walls);
            ASSERT_TRUE(is_inside(s)) << walls;
            ASSERT_EQ(walls_at(s) & walls, walls);
            ASSERT_EQ(snap(s, walls), s);
            ASSERT_TRUE((walls_at(u) & walls) != walls || (s - u).cwiseAbs().maxCoeff() <= 1e-12);
        }
    }
}

TEST(Lattice, translation_by_whole_voxels_is_bit_exact) {
    Random random(121);
    const Field field = linear_field(noise_volume<std::uint8_t>(grid({8, 8, 8}), 6, 0, 256));
    const Index3 shift(16, 32, 8);
    // The same samples, moved by whole voxels inside a larger grid.
    const Field moved = linear_field(
        volume_of<std::uint8_t>(grid({32, 48, 24}),
                                [&](const Index3& i) { return paper_sample(field, i - shift); }),
        Solid::above, field.background());
    for (int i = 0; i < scaled(20000); ++i) {
        // Multiples of 2^-40: exact at every place.
        const Vec3 p = (random.point(0, 7) * 0x1p40).array().round() * 0x1p-40;
        const LatticePoint here = locate(p);
        const LatticePoint there = locate(p + shift.cast<double>());
        ASSERT_EQ(here.folded, there.folded);
        ASSERT_EQ(here.tetrahedron.axis, there.tetrahedron.axis);
        ASSERT_EQ(here.tetrahedron.sign, there.tetrahedron.sign);
        ASSERT_EQ(value_at(field, here), value_at(moved, there));
        ASSERT_EQ(there.tetrahedron.cell, here.tetrahedron.cell + shift);
    }
}
