// Dequantization: which rounds, on which threads.
#include "palpate/filters/dequantize.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "filters/round.hpp"
#include "filters/rows.hpp"
#include "filters/sites.hpp"
#include "palpate/filters/dequantize_parts.hpp"

namespace palpate::filters {
namespace {

/// A hair less than half a level: samples on both sides of a mask's surface must not meet in it.
constexpr double half_level = 511.0 / 1024, half_level_of_mask = 127.0 / 256;
/// The coarsest steps that are chosen. A mask does not tell how far it is straight.
constexpr int usual_coarsest = 16, mask_step = 4;
/// A step is chosen if it bends half of the surfaces by no more than this [levels].
constexpr double chosen_bend = 0.5, enough = 0.5;
constexpr double most_sites = 3e4;
/// From this bend on a coarse step moves a sample less, from twice of it on not at all [levels].
constexpr double most_bend = 0.55, most_bend_of_mask = 0.05;

/// Is a good part of the surfaces straight to within the rounding?
bool straight_over(std::span<const SurfaceSite> sites, double level) {
    double all = 0, straight = 0;
    for (const SurfaceSite& site : sites) {
        all += site.slope;
        if (site.bend <= chosen_bend * level) straight += site.slope;
    }
    return straight >= enough * all && all > 0;
}

/// The coarsest step over which they are; so about as long as the terraces are wide.
int coarsest_for(double level, const std::function<std::vector<SurfaceSite>(int)>& sites) {
    for (int step = usual_coarsest; step > 1; step /= 2) {
        if (straight_over(sites(step), level)) return step;
    }
    return 1;
}

/// Coarse rounds take long waves out of the rounding, and a few too many flatten what is curved.
int rounds_of(int step, int finest, bool mask) {
    if (step == 1) return finest;
    if (step == 2) return 20;
    if (step == 4) return mask ? 10 : 6;
    return 2;
}

void check(const DequantizeOptions& options) {
    if (options.rounds < 1 || options.rounds > most_rounds) {
        throw std::invalid_argument("dequantizing takes 1 to " + std::to_string(most_rounds) +
                                    " rounds, not " + std::to_string(options.rounds));
    }
    const int coarsest = options.coarsest.value_or(1);
    if (coarsest < 1 || coarsest > greatest_step || (coarsest & (coarsest - 1)) != 0) {
        throw std::invalid_argument(
            "the coarsest step of dequantizing is a power of two from 1 to " +
            std::to_string(greatest_step) + ", not " + std::to_string(coarsest));
    }
    if (options.level && !(*options.level > 0 && *options.level < 1e30)) {
        throw std::invalid_argument("the distance between levels must be a number above 0");
    }
    if (options.threads < 0) throw std::invalid_argument("a number of threads is 0 or more");
}

std::vector<float> float_samples(const Volume& volume) {
    std::vector<float> samples(std::size_t(sample_count(volume.geometry())));
    with_type(volume.type(), [&](auto zero) {
        const auto own = volume.samples<decltype(zero)>();
        std::transform(own.begin(), own.end(), samples.begin(),
                       [](auto value) { return static_cast<float>(value); });
    });
    return samples;
}

}  // namespace

std::vector<SurfaceSite> sites_of(const VolumePart& part, const SampleBox& core, int step) {
    std::vector<SurfaceSite> sites;
    for_sites(part.whole, most_sites, core, [&](const Index3& at) {
        const Index3 inside = at - part.low;
        const double slope = slope_at(part.samples, inside);
        if (slope == 0) return;
        const Smooth smooth = smooth_at(part.samples, inside, step);
        sites.push_back({at, slope, std::abs(smooth.mean - smooth.twice)});
    });
    return sites;
}

DequantizePlan plan_of(double level, double minimum, double maximum,
                       const DequantizeOptions& options,
                       const std::function<std::vector<SurfaceSite>(int)>& sites) {
    check(options);
    DequantizePlan plan{level, minimum, maximum, is_mask(minimum, maximum, level), {}};
    const int coarsest = options.coarsest ? *options.coarsest
                         : plan.mask      ? mask_step
                                          : coarsest_for(level, sites);
    for (int step = coarsest; step >= 1; step /= 2) {
        plan.rounds.push_back({step, rounds_of(step, options.rounds, plan.mask)});
    }
    return plan;
}

void run_rounds(const Volume& volume, std::span<float> state, const DequantizePlan& plan,
                const DequantizePlan::Rounds& rounds, int threads,
                const std::function<void()>& at_slice) {
    const double bend = plan.mask ? most_bend_of_mask : most_bend;
    const double half = plan.mask ? half_level_of_mask : half_level;
    const RoundSettings settings{.step = rounds.step,
                                 .half = float(half * plan.level),
                                 .straight = rounds.step == 1
                                                 ? std::numeric_limits<float>::infinity()
                                                 : float(bend * plan.level),
                                 .least = float(plan.minimum),
                                 .greatest = float(plan.maximum)};
    const ForRows rows = rows_in_parallel(threads, volume.geometry().size[0]);
    for (int round = 0; round < rounds.count; ++round) {
        run_round(volume, state, settings, rows, at_slice);
    }
}

Volume dequantized(const Volume& volume, const DequantizeOptions& options) {
    check(options);
    const std::optional<double> level = options.level ? options.level : level_of(volume);
    if (!level) {
        if (volume.type() == SampleType::float32) return volume;
        return {volume.geometry(), float_samples(volume)};
    }
    const VolumePart all_of_it{volume, Index3::Zero(), volume.geometry().size};
    const DequantizePlan plan =
        plan_of(*level, volume.minimum(), volume.maximum(), options,
                [&](int step) { return sites_of(all_of_it, whole_of(volume), step); });
    double all = 0, done = 0;  // slices
    for (const auto& rounds : plan.rounds) all += rounds.count;
    all *= volume.geometry().size[2];

    std::vector<float> state = float_samples(volume);
    for (const auto& rounds : plan.rounds) {
        run_rounds(volume, state, plan, rounds, options.threads, [&] {
            done += 1;
            if (options.progress) options.progress(done / all);
        });
    }
    return {volume.geometry(), std::move(state)};
}

}  // namespace palpate::filters
