// Penetrability: Fig. 7 of the paper, with ranges of interest. See docs/penetrability.md.
#include "palpate/proxy.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "palpate/names.hpp"
#include "proxy/update.hpp"

namespace palpate {
namespace {

void check_threshold(double threshold) {
    if (!(threshold >= 0)) {
        throw std::invalid_argument("the penetration threshold must be at least 0 mm, not " +
                                    number_text(threshold));
    }
}

void check_range(const DensityRange& range) {
    if (!(range.low <= range.high)) {
        throw std::invalid_argument("a range of interest needs low <= high, not " +
                                    number_text(range.low) + " to " + number_text(range.high));
    }
}

/// The level felt at a density when the hand comes from the free side: the density itself inside a
/// range of interest, else the near end of the next range.
struct Level {
    double isovalue;
    bool inside;  ///< the density lies in a range: the proxy is in contact there
};
Level level_at(const Penetrability& p, double sign, double density) {
    for (int i = 0; i < p.range_count; ++i) {
        const DensityRange& range = p.ranges[i];
        const double near = sign > 0 ? range.low : range.high;
        const double far = sign > 0 ? range.high : range.low;
        if (sign * density < sign * near) return {near, false};
        if (sign * density <= sign * far) return {density, true};
    }
    return {sign * std::numeric_limits<double>::infinity(), false};  // past the last: all free
}

double threshold_now(const Penetrability& p, const Pressing& pressing) {
    if (!p.function) return p.threshold;
    const double answer = p.function(pressing, p.context);
    return answer > 0 ? answer : 0;
}

void put_scp(Proxy& proxy, ProxyUpdate& update, const Field& field, const Vec3& physical) {
    proxy.scp_physical = update.scp = physical;
    put_on_lattice(proxy, field);
    update.density = value_at(field, proxy.scp);
}

void put_level(Proxy& proxy, ProxyUpdate& update, const Level& level) {
    proxy.isovalue = level.isovalue;
    proxy.mode = level.inside ? Mode::constrained : Mode::free;
    update.isovalue = proxy.isovalue;
    update.mode = proxy.mode;
}

}  // namespace

Penetrability no_penetrability() {
    return {};
}

Penetrability penetrability_threshold(double threshold, double minimum, Solid solid) {
    DensityRange range;
    (solid == Solid::above ? range.low : range.high) = minimum;
    return penetrability_ranges(threshold, std::span(&range, 1), solid);
}

Penetrability penetrability_ranges(double threshold, std::span<const DensityRange> ranges,
                                   Solid solid) {
    check_threshold(threshold);
    if (ranges.empty()) throw std::invalid_argument("no range of interest is given");
    std::vector<DensityRange> sorted(ranges.begin(), ranges.end());
    for (const DensityRange& range : sorted) check_range(range);
    std::ranges::sort(sorted, {}, &DensityRange::low);
    std::vector<DensityRange> disjoint;
    for (const DensityRange& range : sorted) {
        if (!disjoint.empty() && range.low <= disjoint.back().high) {
            disjoint.back().high = std::max(disjoint.back().high, range.high);
        } else {
            disjoint.push_back(range);
        }
    }
    if (disjoint.size() > Penetrability::most_ranges) {
        throw std::invalid_argument("more than 16 ranges of interest");
    }
    if (solid == Solid::below) std::ranges::reverse(disjoint);
    Penetrability p;
    p.on = true;
    p.threshold = threshold;
    p.range_count = static_cast<int>(disjoint.size());
    std::ranges::copy(disjoint, p.ranges.begin());
    return p;
}

void check(const Penetrability& p, Solid solid) {
    if (!p.on) return;
    check_threshold(p.threshold);
    if (p.range_count < 1 || p.range_count > Penetrability::most_ranges) {
        throw std::invalid_argument("penetrability needs 1 to 16 ranges of interest, not " +
                                    std::to_string(p.range_count));
    }
    for (int i = 0; i < p.range_count; ++i) {
        const DensityRange& range = p.ranges[i];
        check_range(range);
        if (i == 0) continue;
        const DensityRange& before = p.ranges[i - 1];
        if (solid == Solid::above ? before.high < range.low : range.high < before.low) continue;
        throw std::invalid_argument(
            "the ranges of interest are not in the order in which the hand meets them, or overlap "
            "(penetrability_ranges() sorts and merges them)");
    }
}

void apply_penetrability(const Penetrability& p, const Field& field, double device_per_volume,
                         Proxy& proxy, ProxyUpdate& update, StepObserver observer) {
    if (!p.on || update.status != UpdateStatus::done) return;
    const double sign = field.sign();
    if (update.mode == Mode::constrained) {
        const Vec3 pull = update.scp - update.hip;
        const double length = pull.norm();
        const Pressing pressing{update.isovalue, length * device_per_volume, update.scp,
                                update.hip};
        const double threshold = threshold_now(p, pressing);
        if (!(pressing.pull > threshold)) return;
        put_scp(proxy, update, field, update.hip + pull * (threshold / pressing.pull));
        Level level = level_at(p, sign, update.density);
        put_level(proxy, update, level);
        if (observer.on_step) {
            observer.on_step({StepKind::press, update.scp, update.hip, proxy.scp.tetrahedron},
                             observer.context);
        }
        return;
    }
    // Free, and deeper than the levels of interest begin: the level follows the hand.
    put_level(proxy, update, level_at(p, sign, update.density));
}

}  // namespace palpate
