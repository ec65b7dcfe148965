// Projection on a convex cone: against a slow reference that tries every set of active half-spaces
// and one that converges by alternating projections.
#include "proxy/cone.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <vector>

#include "support/random.hpp"

using namespace palpate;
using palpate::support::Random;
using palpate::support::scaled;

namespace {

template <int Most>
HalfSpaces<Most> half_spaces(const std::vector<Vec3>& normals) {
    HalfSpaces<Most> cone;
    for (const Vec3& n : normals) cone.add(n);
    return cone;
}

bool is_in(const Vec3& p, const std::vector<Vec3>& normals, double tolerance) {
    for (const Vec3& n : normals) {
        if (n.dot(p) > tolerance * n.norm()) return false;
    }
    return true;
}

/// Every subset of the half-spaces held with equality, by a pseudo-inverse; the nearest feasible
/// candidate. In long double, so that normals 1e-9 from opposite are not a matter of rounding.
Vec3 by_all_subsets(const Vec3& h, const std::vector<Vec3>& normals) {
    using Wide = Eigen::Matrix<long double, 3, Eigen::Dynamic>;
    using Wide3 = Eigen::Matrix<long double, 3, 1>;
    Wide unit(3, normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
        unit.col(static_cast<Eigen::Index>(i)) = normals[i].cast<long double>().normalized();
    }
    const Wide3 from = h.cast<long double>();
    Wide3 best = Wide3::Zero();
    for (unsigned subset = 0; subset < 1U << normals.size(); ++subset) {
        Wide held(3, 0);
        for (Eigen::Index i = 0; i < unit.cols(); ++i) {
            if (!(subset >> i & 1)) continue;
            held.conservativeResize(3, held.cols() + 1);
            held.col(held.cols() - 1) = unit.col(i);
        }
        Wide3 p = from;
        if (held.cols() > 0) {
            const Eigen::JacobiSVD<Wide> svd(held, Eigen::ComputeFullU);
            for (Eigen::Index i = 0; i < svd.singularValues().size(); ++i) {
                const Wide3 u = svd.matrixU().col(i);
                if (svd.singularValues()[i] > 1e-14L) p -= u * u.dot(from);
            }
        }
        const bool feasible =
            unit.cols() == 0 || ((p.transpose() * unit).array() <= 1e-15L * from.norm()).all();
        if (feasible && (p - from).norm() < (best - from).norm()) best = p;
    }
    return best.cast<double>();
}

/// Dykstra's alternating projections: slow to converge, impossible to get wrong.
Vec3 by_dykstra(const Vec3& h, const std::vector<Vec3>& normals, int rounds) {
    Vec3 x = h;
    std::vector<Vec3> correction(normals.size(), Vec3::Zero());
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < normals.size(); ++i) {
            const Vec3 n = normals[i].normalized();
            const Vec3 y = x + correction[i];
            x = y - n * std::max(0.0, n.dot(y));
            correction[i] = y - x;
        }
    }
    return x;
}

/// 0 .. 4 normals: in general position, walls of a tetrahedron, nearly parallel, equal, opposite.
std::vector<Vec3> random_normals(Random& random) {
    static const std::array<Vec3, 4> walls{Vec3(1, 0, 0), Vec3(-1, 1, 0), Vec3(0, -1, 1),
                                           Vec3(0, -1, -1)};
    std::vector<Vec3> normals;
    const int count = random.below(5);
    while (static_cast<int>(normals.size()) < count) {
        Vec3 n = random.direction() * std::pow(10, random.uniform(-3, 3));
        const int kind = random.below(8);
        if (kind < 2) n = walls[static_cast<std::size_t>(random.below(4))];
        if (!normals.empty()) {
            if (kind == 3) n = normals.back() + 1e-5 * normals.back().norm() * random.direction();
            if (kind == 4) n = 3 * normals.front();
            if (kind == 5) n = -2 * normals.front();
            if (kind == 6) n = -normals.back() + 1e-4 * normals.back().norm() * random.direction();
        }
        normals.push_back(n);
    }
    return normals;
}

}  // namespace

TEST(Cone, projection_is_the_nearest_point_of_the_cone) {
    Random random(71);
    std::array<int, 4> by_dimension{};
    for (int i = 0; i < scaled(40000); ++i) {
        const auto normals = random_normals(random);
        const Vec3 h = random.direction() * std::pow(10, random.uniform(-3, 3));
        const ConeProjection p = project_on_cone(h, half_spaces<4>(normals));
        const Vec3 expected = by_all_subsets(h, normals);
        SCOPED_TRACE("seed 71 cone " + std::to_string(i));
        ASSERT_TRUE(is_in(p.point, normals, 1e-12 * h.norm()));
        ASSERT_NEAR((p.point - h).norm(), (expected - h).norm(), 1e-7 * h.norm());
        // The nearest point is known to the root of what its distance is known to.
        ASSERT_LE((p.point - expected).norm(), 1e-4 * h.norm());
        const bool apex = p.point.isZero(1e-12 * h.norm());
        const int active = (p.active[0] >= 0) + (p.active[1] >= 0);
        ++by_dimension[static_cast<std::size_t>(apex ? 0 : 3 - active)];
        for (const int a : p.active) {
            if (a < 0) continue;
            const Vec3& n = normals[static_cast<std::size_t>(a)];
            ASSERT_NEAR(n.dot(p.point), 0, 1e-12 * n.norm() * h.norm());
        }
    }
    for (const int count : by_dimension) EXPECT_GT(count, scaled(40000) / 50);
}

TEST(Cone, projection_agrees_with_alternating_projections) {
    Random random(72);
    int compared = 0;
    for (int i = 0; i < scaled(4000); ++i) {
        std::vector<Vec3> normals;
        const int count = random.below(5);
        for (int k = 0; k < count; ++k) normals.push_back(random.direction());
        const Vec3 h = random.direction();
        const Vec3 slow = by_dykstra(h, normals, 2000);
        const Vec3 slower = by_dykstra(h, normals, 4000);
        if ((slow - slower).norm() > 1e-9) continue;  // not converged
        ++compared;
        const Vec3 p = project_on_cone(h, half_spaces<4>(normals)).point;
        ASSERT_LE((p - slower).norm(), 1e-6) << "seed 72 cone " << i;
    }
    EXPECT_GT(compared, scaled(4000) * 8 / 10);
}

TEST(Cone, projection_leaves_a_point_of_the_cone_where_it_is) {
    Random random(73);
    for (int i = 0; i < scaled(10000); ++i) {
        const auto normals = random_normals(random);
        const Vec3 h = by_all_subsets(random.direction(), normals);
        if (!is_in(h, normals, 0)) continue;
        const ConeProjection p = project_on_cone(h, half_spaces<4>(normals));
        ASSERT_EQ(p.point, h);
        ASSERT_EQ(p.active[0], -1);
    }
    EXPECT_EQ(project_on_cone(Vec3(1, 2, 3), HalfSpaces<4>{}).point, Vec3(1, 2, 3));
    EXPECT_EQ(project_on_cone(Vec3(0, 0, 0), half_spaces<4>({Vec3::UnitX()})).point, Vec3::Zero());
}

TEST(Cone, projection_on_up_to_48_half_spaces_is_feasible_and_no_sampled_point_is_nearer) {
    Random random(74);
    for (int i = 0; i < scaled(2000); ++i) {
        std::vector<Vec3> normals;
        const Vec3 axis = random.direction();
        const int count = 1 + random.below(48);
        for (int k = 0; k < count; ++k) normals.push_back((axis + random.direction()).normalized());
        const Vec3 h = random.direction();
        const Vec3 p = project_on_cone(h, half_spaces<48>(normals)).point;
        ASSERT_TRUE(is_in(p, normals, 1e-12));
        // Moreau: h - p is at a right angle to p, and no point of the cone has a positive product.
        ASSERT_NEAR(p.dot(h - p), 0, 1e-12);
        for (int k = 0; k < 40; ++k) {
            const Vec3 d = k % 2 == 0 ? random.direction() : Vec3(random.direction() - axis);
            ASSERT_TRUE(!is_in(d, normals, 0) || d.dot(h - p) <= 1e-9) << "seed 74 cone " << i;
        }
    }
}
