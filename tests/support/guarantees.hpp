// The checker of the proxy's guarantees G1-G5 (palpate/proxy.hpp): runs updates and verifies each
// one from the outside, by values of the field along the whole path. Counts the cases met, so that
// a test can show that it covered them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/proxy.hpp"
#include "support/paper_lattice.hpp"
#include "support/random.hpp"

namespace palpate::support {

/// What a run of the checker has met, and the worst it has seen.
struct Tally {
    int updates = 0;
    int constrained = 0;
    int long_moves = 0;                           ///< updates through more than one tetrahedron
    int on_wall = 0, on_edge = 0, on_vertex = 0;  ///< SCPs that ended there
    int corners = 0;                              ///< path corners and wall crossings
    int out_of_budget = 0, recovering = 0, recovered = 0;
    int most_pieces = 0;
    std::vector<int> pieces;
    std::int64_t samples = 0, slow_samples = 0, motions = 0;
    double worst_g1 = -1, worst_g2 = 0;  ///< relative to the range
    double worst_g3 = 0;                 ///< [relative to the length of the motion]
    double worst_g4 = 0;                 ///< [relative]

    double constrained_share() const { return double(constrained) / updates; }
    int percentile(double p) const {
        std::vector<int> sorted = pieces;
        std::sort(sorted.begin(), sorted.end());
        return sorted.empty() ? 0 : sorted[std::size_t(p * double(sorted.size() - 1))];
    }
    double mean_pieces() const {
        double sum = 0;
        for (const int p : pieces) sum += p;
        return sum / double(pieces.size());
    }
};

/// Which guarantees a method with its settings gives.
struct Promises {
    bool locally_optimal = true;   ///< G3
    bool never_farther = true;     ///< G4
    double samples_per_voxel = 6;  ///< G1: density along each straight segment
    int motions = 8;               ///< G3: random motions an update
};

class Guarantees {
  public:
    Guarantees(const Field& f, ProxyMethod m, const ProxySettings& s = {}, const Promises& p = {})
        : field_(f), method_(m), settings_(s), promises_(p), random_(99) {}

    /// One update, checked. Stop at the first failure (testing::Test::HasFailure).
    ProxyUpdate update(Proxy& proxy, const Vec3& hip) {
        const Proxy before = proxy;
        path_.clear();
        const StepObserver observer{[](const Step& step, void* self) {
                                        static_cast<Guarantees*>(self)->path_.push_back(step);
                                    },
                                    this};
        const ProxyUpdate result = method_(proxy, field_, hip, settings_, observer);
        check(before, proxy, hip, result);
        return result;
    }

    const Tally& tally() const { return tally_; }
    /// Prints a row of evidence.
    void print(const std::string& name) const {
        const Tally& t = tally_;
        std::printf(
            "[ evidence ] %-22s updates %d  constrained %.2f  multi-tetrahedron %.2f  wall/edge/"
            "vertex %d/%d/%d  pieces mean %.2f p99 %d p99.9 %d most %d  out of budget %d  G1 %.1e  "
            "G2 %.1e  G3 %.1e  G4 %.1e\n",
            name.c_str(), t.updates, t.constrained_share(), double(t.long_moves) / t.updates,
            t.on_wall, t.on_edge, t.on_vertex, t.mean_pieces(), t.percentile(0.99),
            t.percentile(0.999), t.most_pieces, t.out_of_budget, t.worst_g1, t.worst_g2, t.worst_g3,
            t.worst_g4);
    }

  private:
    double excess(double density, const Proxy& proxy) const {
        const double ahead = field_.sign() * (density - proxy.isovalue) / field_.range();
        if (!proxy.behind) return ahead;
        return std::max(ahead, field_.sign() * (*proxy.behind - density) / field_.range());
    }
    double excess_at(const Vec3& physical, const Proxy& proxy) const {
        return excess(value_at(field_, physical), proxy);
    }

    void check(const Proxy& before, const Proxy& proxy, const Vec3& hip, const ProxyUpdate& r) {
        ++tally_.updates;
        tally_.constrained += r.mode == Mode::constrained;
        tally_.long_moves += r.tetrahedra > 1;
        tally_.corners += static_cast<int>(path_.size());
        tally_.out_of_budget += r.status == UpdateStatus::out_of_budget;
        tally_.recovering += r.status == UpdateStatus::recovering;
        tally_.most_pieces = std::max(tally_.most_pieces, r.tetrahedra);
        tally_.pieces.push_back(r.tetrahedra);
        count_place(proxy);
        ASSERT_TRUE(r.scp.allFinite() && proxy.scp.folded.allFinite() && std::isfinite(r.density))
            << "G5: not a number";
        ASSERT_LE(r.tetrahedra, settings_.step_budget) << "G5: more pieces than the budget";
        ASSERT_LE(r.work, settings_.step_budget) << "G5: more work than the budget";
        ASSERT_EQ(r.scp, proxy.scp_physical);
        ASSERT_EQ(r.mode, proxy.mode);
        const bool recovered = check_path(before, proxy, r);
        tally_.recovered += recovered;
        if (testing::Test::HasFatalFailure()) return;
        if (r.status == UpdateStatus::recovering) return;
        if (r.mode == Mode::constrained) {
            const double off = std::abs(excess_at(r.scp, proxy));
            tally_.worst_g2 = std::max(tally_.worst_g2, off);
            ASSERT_LE(off, 1e-9) << "G2: in contact, not on the surface";
        } else if (r.status == UpdateStatus::done) {
            ASSERT_EQ(r.scp, hip) << "free and done, not at the HIP";
        }
        if (promises_.never_farther && before.placed && !recovered) {
            check_never_farther(before, proxy, hip);
        }
        if (promises_.locally_optimal && r.status == UpdateStatus::done &&
            r.mode == Mode::constrained) {
            check_locally_optimal(proxy, hip, r);
        }
    }

    void count_place(const Proxy& proxy) {
        const int walls = std::popcount(walls_at(proxy.scp.folded));
        tally_.on_wall += walls >= 1;
        tally_.on_edge += walls >= 2;
        tally_.on_vertex += walls >= 3;
    }

    /// G1: free on all of the path. True if the update had to recover first.
    bool check_path(const Proxy& before, const Proxy& proxy, const ProxyUpdate& r) {
        bool recovered = r.status == UpdateStatus::recovering;
        Vec3 from = before.scp_physical;
        for (const Step& step : path_) {
            if (step.kind == StepKind::recover) recovered = true;
            if (step.kind == StepKind::goal) continue;
            const bool jump = step.kind == StepKind::recover || step.kind == StepKind::place;
            if (!jump) check_segment(from, step.point, proxy);
            if (testing::Test::HasFatalFailure()) return recovered;
            from = step.point;
        }
        // The place inside the solid is where recovery starts, if nothing moved after it.
        const double rounding =
            1e-12 * (1 + r.scp.cwiseAbs().maxCoeff() + before.scp_physical.cwiseAbs().maxCoeff());
        if (!path_.empty() || before.placed) {
            EXPECT_LE((from - r.scp).norm(), rounding) << "the reported path ends elsewhere";
        }
        if (r.status != UpdateStatus::recovering) check_sample(r.scp, proxy);
        return recovered;
    }

    void check_segment(const Vec3& a, const Vec3& b, const Proxy& proxy) {
        const Vec3 way = b - a;
        const double voxels = way.norm() / field_.geometry().spacing.minCoeff();
        const int count = 1 + std::min(1000, int(voxels * promises_.samples_per_voxel));
        for (int i = 1; i <= count; ++i) {
            const double t = i == count ? 1 : (i - random_.uniform(0, 1)) / count;
            check_sample(a + t * way, proxy);
            if (testing::Test::HasFatalFailure()) return;
        }
    }

    void check_sample(const Vec3& p, const Proxy& proxy) {
        double inside = excess_at(p, proxy);
        ++tally_.samples;
        if (random_.below(32) == 0) {
            ++tally_.slow_samples;
            const Vec3 index = index_from_physical(field_.geometry(), p);
            const double slow = excess(paper_value(field_, index), proxy);
            ASSERT_NEAR(slow, inside, 1e-9) << "the slow reference disagrees at " << p.transpose();
            inside = std::max(inside, slow);
        }
        tally_.worst_g1 = std::max(tally_.worst_g1, inside);
        ASSERT_LE(inside, 1e-9) << "G1: inside the solid at " << p.transpose();
    }

    /// G4, at every corner of the path.
    void check_never_farther(const Proxy& before, const Proxy& proxy, const Vec3& hip) {
        double last = (before.scp_physical - hip).norm();
        const double rounding =
            1e-13 * (1 + hip.cwiseAbs().maxCoeff() + before.scp_physical.cwiseAbs().maxCoeff());
        const auto check_one = [&](const Vec3& p) {
            const double now = (p - hip).norm();
            if (now > last + rounding) {
                tally_.worst_g4 = std::max(tally_.worst_g4, (now - last) / last);
            }
            ASSERT_LE(now, last * (1 + 1e-9) + rounding) << "G4: farther from the HIP";
            last = now;
        };
        for (const Step& step : path_) {
            if (step.kind == StepKind::goal) continue;
            check_one(step.point);
            if (testing::Test::HasFatalFailure()) return;
        }
        check_one(proxy.scp_physical);
    }

    /// G3: to the HIP, along the surface, and anywhere.
    void check_locally_optimal(const Proxy& proxy, const Vec3& hip, const ProxyUpdate& r) {
        const Vec3 h = hip - r.scp;
        const Vec3 normal = normal_at(proxy, field_);
        const Vec3 along = h - normal * normal.dot(h);
        check_motion(proxy, hip, h);
        check_motion(proxy, hip, along);
        for (int i = 0; i < promises_.motions; ++i) {
            Vec3 v = random_.direction();
            if (i % 2 == 1) v -= normal * normal.dot(v);
            if (v.dot(h) < 0) v = -v;
            check_motion(proxy, hip, v);
        }
    }

    void check_motion(const Proxy& proxy, const Vec3& hip, const Vec3& direction) {
        const double length = direction.norm();
        if (!(length > 1e-9 * field_.geometry().spacing.minCoeff())) return;
        const double step = 1e-3 * field_.geometry().spacing.minCoeff();
        const Vec3 motion = direction * (step / length);
        const Vec3& from = proxy.scp_physical;
        const double before = (from - hip).norm();
        const double closer = (before - (from + motion - hip).norm()) / step;
        ++tally_.motions;
        // A plane met at this angle would still hold the motion within the tolerance of `free`.
        if (closer <= 1e-5) return;
        const Geometry& geometry = field_.geometry();
        const auto greatest = [&](double level, double sign) {
            return greatest_on_segment(
                index_from_physical(geometry, from), index_from_physical(geometry, from + motion),
                sign * field_.sign(),
                [&](const Vec3& index) { return value_at(field_, locate(index)) - level; });
        };
        if (greatest(proxy.isovalue, 1) / field_.range() > 1e-9) return;
        if (proxy.behind && greatest(*proxy.behind, -1) / field_.range() > 1e-9) return;
        tally_.worst_g3 = std::max(tally_.worst_g3, closer);
        ADD_FAILURE() << "G3: a free motion of 1e-3 voxel leads closer by " << closer
                      << " of its length";
        FAIL();
    }

    const Field& field_;
    ProxyMethod method_;
    ProxySettings settings_;
    Promises promises_;
    Random random_;
    std::vector<Step> path_;
    Tally tally_;
};

}  // namespace palpate::support
