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

namespace palpate::filters {
namespace {

/// A hair less than half a level: samples on both sides of a mask's surface must not meet in it.
constexpr double half_level = 511.0 / 1024, half_level_of_mask = 127.0 / 256;
/// The coarsest steps that are chosen. A mask does not tell how far it is straight.
constexpr int usual_coarsest = 16, mask_step = 4;
/// A step is chosen if it bends half of the surfaces by no more than this [levels].
constexpr double chosen_bend = 0.5, enough = 0.5;
/// From this bend on a coarse step moves a sample less, from twice of it on not at all [levels].
constexpr double most_bend = 0.55, most_bend_of_mask = 0.05;

/// The coarsest step over which a good part of the surfaces is straight to within the rounding; so
/// about as long as the terraces are wide.
int coarsest_for(const Volume& volume, double level) {
    if (is_mask(volume, level)) return mask_step;
    for (int step = usual_coarsest; step > 1; step /= 2) {
        double all = 0, straight = 0;
        for_sites(volume, 3e4, [&](const Index3& at) {
            const double slope = slope_at(volume, at);
            if (slope == 0) return;
            all += slope;
            const Smooth smooth = smooth_at(volume, at, step);
            const bool bent = std::abs(smooth.mean - smooth.twice) > chosen_bend * level;
            if (!bent) straight += slope;
        });
        if (straight >= enough * all && all > 0) return step;
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

std::vector<int> steps_from(int coarsest) {
    std::vector<int> steps;
    for (int step = coarsest; step >= 1; step /= 2) steps.push_back(step);
    return steps;
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

Volume dequantized(const Volume& volume, const DequantizeOptions& options) {
    check(options);
    const std::optional<double> level = options.level ? options.level : level_of(volume);
    if (!level) {
        if (volume.type() == SampleType::float32) return volume;
        return {volume.geometry(), float_samples(volume)};
    }
    const std::vector<int> steps =
        steps_from(options.coarsest ? *options.coarsest : coarsest_for(volume, *level));
    const bool mask = is_mask(volume, *level);
    const double bend = mask ? most_bend_of_mask : most_bend;
    const double half = mask ? half_level_of_mask : half_level;
    double all = 0, done = 0;  // slices
    for (const int step : steps) all += rounds_of(step, options.rounds, mask);
    all *= volume.geometry().size[2];

    std::vector<float> state = float_samples(volume);
    const ForRows rows = rows_in_parallel(options.threads, volume.geometry().size[0]);
    for (const int step : steps) {
        const RoundSettings settings{
            .step = step,
            .half = float(half * *level),
            .straight = step == 1 ? std::numeric_limits<float>::infinity() : float(bend * *level)};
        for (int round = 0; round < rounds_of(step, options.rounds, mask); ++round) {
            run_round(volume, state, settings, rows, [&] {
                done += 1;
                if (options.progress) options.progress(done / all);
            });
        }
    }
    return {volume.geometry(), std::move(state)};
}

}  // namespace palpate::filters
