// The checker of the proxy's guarantees on the smooth field: every update is verified from the
// outside, by the exact maximum of the field on each straight piece of its path.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/proxy.hpp"
#include "support/cubic_reference.hpp"
#include "support/paper_lattice.hpp"
#include "support/random.hpp"

namespace palpate::support {

/// The greatest value on [0, 1] of a cubic that is known at 0, 1/3, 2/3 and 1.
inline long double greatest_of_cubic(const std::array<long double, 4>& f) {
    const long double a = f[0];
    const long double b = -5.5L * f[0] + 9 * f[1] - 4.5L * f[2] + f[3];
    const long double c = 9 * f[0] - 22.5L * f[1] + 18 * f[2] - 4.5L * f[3];
    const long double d = -4.5L * f[0] + 13.5L * f[1] - 13.5L * f[2] + 4.5L * f[3];
    long double greatest = std::max(f[0], f[3]);
    const long double root = c * c - 3 * b * d;
    if (root >= 0) {
        for (const long double q : {-c - std::sqrt(root), -c + std::sqrt(root)}) {
            // Both forms of each root of 3 d t^2 + 2 c t + b.
            for (const long double t : {q / (3 * d), b / q}) {
                if (t > 0 && t < 1) greatest = std::max(greatest, a + t * (b + t * (c + t * d)));
            }
        }
    }
    return greatest;
}

/// The greatest value of a function on a segment (index space), on each part of which between two
/// walls of the smooth field's lattice it is a cubic.
template <class Value>
long double greatest_on_cubic_segment(const Vec3& a, const Vec3& b, Value&& value) {
    static const std::array<Vec3, 9> forms{Vec3(1, 0, 0),  Vec3(0, 1, 0),  Vec3(0, 0, 1),
                                           Vec3(1, 1, 0),  Vec3(1, -1, 0), Vec3(1, 0, 1),
                                           Vec3(1, 0, -1), Vec3(0, 1, 1),  Vec3(0, 1, -1)};
    std::vector<long double> cuts{0, 1};
    const Vec3l from = a.cast<long double>() + Vec3l::Constant(0.5L);
    const Vec3l along = b.cast<long double>() - a.cast<long double>();
    for (const Vec3& form : forms) {
        const long double begin = form.cast<long double>().dot(from);
        const long double rate = form.cast<long double>().dot(along);
        if (rate == 0) continue;
        const long double low = std::min(begin, begin + rate), high = std::max(begin, begin + rate);
        // Rounding puts cuts of a segment along a wall beyond its ends.
        for (long double k = std::ceil(low); k <= high; ++k) {
            cuts.push_back(std::clamp((k - begin) / rate, 0.0L, 1.0L));
        }
    }
    std::ranges::sort(cuts);
    long double greatest = -std::numeric_limits<long double>::infinity();
    for (std::size_t i = 1; i < cuts.size(); ++i) {
        std::array<long double, 4> f;
        for (int j = 0; j < 4; ++j) {
            const long double t = cuts[i - 1] + (cuts[i] - cuts[i - 1]) * j / 3;
            f[j] = value(Vec3l(a.cast<long double>() + t * along));
        }
        greatest = std::max(greatest, greatest_of_cubic(f));
    }
    return greatest;
}

struct CubicTally {
    int updates = 0, constrained = 0, out_of_budget = 0, recovering = 0, long_moves = 0;
    std::vector<int> rounds;  ///< straight motions of each update
    double worst_g1 = -1, worst_g2 = 0, worst_g3 = 0, worst_g4 = 0;
    std::int64_t motions = 0;

    int percentile(double p) const {
        std::vector<int> sorted = rounds;
        std::ranges::sort(sorted);
        return sorted.empty() ? 0 : sorted[std::size_t(p * double(sorted.size() - 1))];
    }
};

class CubicGuarantees {
  public:
    explicit CubicGuarantees(const Field& f, const ProxySettings& s = {}, bool optimal = true)
        : field_(f), settings_(s), optimal_(optimal), random_(99) {}

    /// One update, checked. Stop at the first failure (testing::Test::HasFailure).
    ProxyUpdate update(Proxy& proxy, const Vec3& hip) {
        const Proxy before = proxy;
        path_.clear();
        const StepObserver observer{[](const Step& step, void* self) {
                                        static_cast<CubicGuarantees*>(self)->path_.push_back(step);
                                    },
                                    this};
        const ProxyUpdate r = update_exact(proxy, field_, hip, settings_, observer);
        check(before, proxy, hip, r);
        return r;
    }
    const CubicTally& tally() const { return tally_; }
    void print(const std::string& name) const {
        const CubicTally& t = tally_;
        std::printf(
            "[ evidence ] %-16s updates %d  constrained %.2f  multi-tetrahedron %.2f  motions p50 "
            "%d p99 %d p99.9 %d most %d  out of budget %d  recovering %d  G1 %.1e  G2 %.1e  G3 "
            "%.1e  G4 %.1e\n",
            name.c_str(), t.updates, double(t.constrained) / t.updates,
            double(t.long_moves) / t.updates, t.percentile(0.5), t.percentile(0.99),
            t.percentile(0.999), t.percentile(1), t.out_of_budget, t.recovering, t.worst_g1,
            t.worst_g2, t.worst_g3, t.worst_g4);
    }

  private:
    /// The field by the reference.
    long double reference(const Vec3l& index) const {
        return cubic_value(index, [&](const Index3& at) { return paper_sample(field_, at); }).value;
    }
    /// The same by the field itself: quicker, for most of the samples.
    long double quick(const Vec3l& index) const {
        return value_at(field_, cubic::locate(index.cast<double>()));
    }
    /// Of a density that a surface stops where it rises, in parts of the range.
    long double excess(long double density, double level, double sign) const {
        return sign * field_.sign() * (density - (long double)(level)) / field_.range();
    }
    /// Of the surface that is exceeded most: that ahead or that behind.
    long double excess(const Vec3l& index, const Proxy& proxy) const {
        const long double density = reference(index);
        const long double ahead = excess(density, proxy.isovalue, 1);
        return proxy.behind ? std::max(ahead, excess(density, *proxy.behind, -1)) : ahead;
    }
    long double greatest(const Vec3& a, const Vec3& b, const Proxy& proxy) {
        const bool slow = random_.chance(0.05);
        const auto of_level = [&](double level, double sign) {
            return greatest_on_cubic_segment(a, b, [&](const Vec3l& index) {
                return excess(slow ? reference(index) : quick(index), level, sign);
            });
        };
        const long double ahead = of_level(proxy.isovalue, 1);
        return proxy.behind ? std::max(ahead, of_level(*proxy.behind, -1)) : ahead;
    }

    void check(const Proxy& before, const Proxy& proxy, const Vec3& hip, const ProxyUpdate& r) {
        const Geometry& geometry = field_.geometry();
        ++tally_.updates;
        tally_.constrained += r.mode == Mode::constrained;
        tally_.long_moves += r.tetrahedra > 1;
        tally_.out_of_budget += r.status == UpdateStatus::out_of_budget;
        tally_.recovering += r.status == UpdateStatus::recovering;
        ASSERT_TRUE(r.scp.allFinite() && proxy.scp.folded.allFinite() && std::isfinite(r.density));
        ASSERT_LE(r.tetrahedra, settings_.step_budget);
        ASSERT_LE(r.work, settings_.step_budget);
        // A hand whose first position is deep in the solid; never later, for the field stays.
        const bool recovers = r.status == UpdateStatus::recovering;
        const bool was_free = before.placed && !inside_;
        ASSERT_FALSE(was_free && recovers) << "inside again";
        inside_ = recovers;
        if (recovers) return;
        int rounds = 0;
        if (was_free) {
            Vec3 from = before.scp_physical;
            for (const Step& step : path_) {
                rounds += step.kind != StepKind::cross;
                const double most =
                    double(greatest(index_from_physical(geometry, from),
                                    index_from_physical(geometry, step.point), proxy));
                tally_.worst_g1 = std::max(tally_.worst_g1, most);
                ASSERT_LE(most, 1e-9) << "G1";
                from = step.point;
            }
            ASSERT_LT((from - r.scp).norm(), 1e-6) << "the path ends at the SCP";
        }
        tally_.rounds.push_back(rounds);
        const double at_end =
            double(excess(index_from_physical(geometry, r.scp).cast<long double>(), proxy));
        ASSERT_LE(at_end, 1e-9) << "G1 at the end";
        if (r.mode == Mode::constrained && r.status == UpdateStatus::done) {
            tally_.worst_g2 = std::max(tally_.worst_g2, std::abs(at_end));
            ASSERT_LE(std::abs(at_end), 1e-9) << "G2";
        }
        if (!optimal_) return;
        if (was_free) {
            const double was = (before.scp_physical - hip).norm();
            const double growth =
                ((r.scp - hip).norm() - was) / (was + geometry.spacing.minCoeff());
            tally_.worst_g4 = std::max(tally_.worst_g4, growth);
            ASSERT_LE(growth, 1e-12) << "G4";
        }
        if (r.mode != Mode::constrained || r.status != UpdateStatus::done) return;
        const Vec3 h = hip - r.scp;
        const Vec3 g = field_.sign() * gradient_at(field_, r.scp);
        for (int i = 0; i < 8; ++i) {
            Vec3 v = random_.direction();
            if (i % 2 == 1) v -= g * (g.dot(v) / std::max(1e-300, g.squaredNorm()));
            if (i == 1) v = h - g * (g.dot(h) / std::max(1e-300, g.squaredNorm()));
            if (v.dot(h) < 0) v = -v;
            check_motion(proxy, hip, v);
        }
    }

    void check_motion(const Proxy& proxy, const Vec3& hip, const Vec3& direction) {
        const Geometry& geometry = field_.geometry();
        const double length = direction.norm();
        if (!(length > 1e-9 * geometry.spacing.minCoeff())) return;
        const double step = 1e-3 * geometry.spacing.minCoeff();
        const Vec3 to = proxy.scp_physical + direction * (step / length);
        const double closer = ((proxy.scp_physical - hip).norm() - (to - hip).norm()) / step;
        ++tally_.motions;
        if (closer <= tally_.worst_g3) return;
        const double most = double(greatest(index_from_physical(geometry, proxy.scp_physical),
                                            index_from_physical(geometry, to), proxy));
        if (most > 1.1e-11) return;  // not free
        tally_.worst_g3 = std::max(tally_.worst_g3, closer);
        ASSERT_LE(closer, 2e-3) << "G3";
    }

    const Field& field_;
    ProxySettings settings_;
    bool optimal_;
    bool inside_ = false;  // the last update left the SCP in the solid, where it began
    Random random_;
    std::vector<Step> path_;
    CubicTally tally_;
};

}  // namespace palpate::support
