// Dequantization: which rounds, on which threads.
#include "palpate/filters/dequantize.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "filters/parallel.hpp"
#include "filters/pyramid.hpp"
#include "palpate/filters/dequantize_parts.hpp"

namespace palpate::filters {
namespace {

/// The coarsest steps that are chosen. A mask does not tell how far it is straight.
constexpr int usual_coarsest = 16, mask_step = 4;
/// A step is chosen if it bends half of the surfaces by no more than this [levels].
constexpr double chosen_bend = 0.5, enough = 0.5;

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
/// They leave little to the rounds of step 1.
int rounds_of(int step, int coarsest, int finest, bool mask) {
    if (step == 1) return mask || coarsest == 1 ? finest : (finest + 19) / 20;
    if (step == 2) return mask ? 20 : 24;
    if (step == 4) return mask ? 5 : 6;
    return step == 8 ? 4 : 2;
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
    if (options.level && !(*options.level > 1e-30 && *options.level < 1e30)) {
        throw std::invalid_argument("the distance between levels must be a number above 0");
    }
    if (options.threads < 0) throw std::invalid_argument("a number of threads is 0 or more");
}

/// Whole numbers above the least one.
template <class T>
void copy_whole(const T* from, std::size_t count, T least, std::uint16_t* to) {
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<std::uint16_t>(from[i] - least);
}

/// Samples where they were moved to. `own` are the volume's, or above its least one.
template <class T>
void restore(const T* own, double least_own, const std::int16_t* moved, std::size_t count,
             const DequantizePlan& plan, float* to) {
    const auto unit = float(plan.level / 65536), offset = float(least_own);
    const auto least = float(plan.minimum), greatest = float(plan.maximum);
    for (std::size_t i = 0; i < count; ++i) {
        const float sample =
            (static_cast<float>(own[i]) + offset) + static_cast<float>(moved[i]) * unit;
        to[i] = std::min(std::max(sample, least), greatest);
    }
}

/// 4 bytes for each sample of a volume: at first its own value and how far it is moved, slice by
/// slice, at last the result. So the volume itself is not needed meanwhile.
class Workspace {
  public:
    Workspace(Volume volume, const Parallel& parallel)
        : geometry_(volume.geometry()),
          parallel_(parallel),
          slice_(std::size_t(geometry_.size[0]) * std::size_t(geometry_.size[1])),
          memory_(static_cast<float*>(
                      std::calloc(std::size_t(geometry_.size[2]) * slice_, sizeof(float))),
                  &std::free) {
        if (!memory_) throw std::bad_alloc();
        with_type(volume.type(), [&](auto zero) {
            using T = decltype(zero);
            if constexpr (std::is_integral_v<T>) {
                const T* from = volume.samples<T>().data();
                const T least = static_cast<T>(volume.minimum());
                parallel_(geometry_.size[2], [&](int z) {
                    const std::size_t at = std::size_t(z) * slice_;
                    copy_whole(from + at, slice_, least, whole(z));
                });
            } else {
                floats_ = std::move(volume);
            }
        });
    }

    MovedSamples samples() const {
        const auto slice = std::ptrdiff_t(slice_);
        MovedSamples samples{geometry_.size, nullptr,   nullptr,          moved(0),
                             2 * slice,      2 * slice, geometry_.size[0]};
        if (floats_) {
            samples.floats = floats_->samples<float>().data();
            samples.own_slice = slice;
        } else {
            samples.whole = whole(0);
        }
        return samples;
    }

    Volume result(const DequantizePlan& plan) && {
        parallel_(geometry_.size[2], [&](int z) {
            std::vector<float> slice(slice_);
            if (floats_) {
                const float* own = floats_->samples<float>().data() + std::size_t(z) * slice_;
                restore(own, 0, moved(z), slice_, plan, slice.data());
            } else {
                restore(whole(z), plan.minimum, moved(z), slice_, plan, slice.data());
            }
            std::copy(slice.begin(), slice.end(), at(z));
        });
        floats_.reset();
        return {geometry_, SampleType::float32, std::move(memory_),
                sizeof(float) * slice_ * std::size_t(geometry_.size[2])};
    }

  private:
    float* at(int z) const { return memory_.get() + std::size_t(z) * slice_; }
    std::uint16_t* whole(int z) const { return reinterpret_cast<std::uint16_t*>(at(z)); }
    std::int16_t* moved(int z) const { return reinterpret_cast<std::int16_t*>(at(z)) + slice_; }

    Geometry geometry_;
    const Parallel& parallel_;
    std::size_t slice_;  ///< samples
    std::shared_ptr<float> memory_;
    std::optional<Volume> floats_;  ///< they take all of the 4 bytes
};

/// The samples of a volume without levels.
Volume as_float32(const Volume& volume) {
    if (volume.type() == SampleType::float32) return volume;
    const std::vector<std::int16_t> moved(std::size_t(sample_count(volume.geometry())));
    return moved_samples(volume, moved, {1, volume.minimum(), volume.maximum(), false, {}});
}

}  // namespace

DequantizePlan plan_of(double level, double minimum, double maximum,
                       const DequantizeOptions& options,
                       const std::function<std::vector<SurfaceSite>(int)>& sites) {
    check(options);
    if (!(maximum - minimum < 1e9 * level)) {
        throw std::invalid_argument("the distance between levels is too small for these samples");
    }
    DequantizePlan plan{level, minimum, maximum, is_mask(minimum, maximum, level), {}};
    const int coarsest = options.coarsest ? *options.coarsest
                         : plan.mask      ? mask_step
                                          : coarsest_for(level, sites);
    using Way = DequantizePlan::Rounds::Way;
    for (int step = 1; step < coarsest; step *= 2) plan.rounds.push_back({step, 1, Way::down});
    for (int step = coarsest; step >= 1; step /= 2) {
        plan.rounds.push_back({step, rounds_of(step, coarsest, options.rounds, plan.mask),
                               step < coarsest ? Way::up : Way::stay});
    }
    return plan;
}

void run_rounds(const VolumePart& part, std::span<std::int16_t> moved, const DequantizePlan& plan,
                std::span<const DequantizePlan::Rounds> rounds, int threads) {
    const Index3& size = part.samples.geometry().size;
    const std::ptrdiff_t slice = std::ptrdiff_t{size[0]} * size[1];
    MovedSamples samples{size,    nullptr, nullptr, moved.data(), slice, slice,
                         size[0], 1,       1,       part.low};
    std::vector<std::uint16_t> whole;
    with_type(part.samples.type(), [&](auto zero) {
        using T = decltype(zero);
        const auto own = part.samples.samples<T>();
        if constexpr (std::is_integral_v<T>) {
            whole.resize(own.size());
            copy_whole(own.data(), own.size(), static_cast<T>(plan.minimum), whole.data());
            samples.whole = whole.data();
        } else {
            samples.floats = own.data();
        }
    });
    const Parallel parallel = in_parallel(threads);
    Pyramid pyramid(samples, plan, terraced_bricks(samples, plan, parallel), parallel);
    for (const auto& some : rounds) pyramid.run(some, [](double) {});
    pyramid.go_to(1);
}

Volume moved_samples(const Volume& volume, std::span<const std::int16_t> moved,
                     const DequantizePlan& plan) {
    std::vector<float> samples(std::size_t(sample_count(volume.geometry())));
    if (moved.size() != samples.size()) {
        throw std::invalid_argument("samples and how far they were moved are of one box");
    }
    with_type(volume.type(), [&](auto zero) {
        const auto own = volume.samples<decltype(zero)>();
        restore(own.data(), 0, moved.data(), samples.size(), plan, samples.data());
    });
    return {volume.geometry(), std::move(samples)};
}

Volume dequantized(Volume volume, const DequantizeOptions& options) {
    check(options);
    const auto tell = [&](double part) {
        if (options.progress) options.progress(part);
    };
    constexpr double first = 0.05;  // of the time
    const auto at_level = [&](double part) { tell(first * part); };
    const std::optional<double> level = options.level ? options.level : level_of(volume, at_level);
    if (!level) return as_float32(volume);
    const VolumePart all_of_it{volume, Index3::Zero(), volume.geometry().size};
    const DequantizePlan plan =
        plan_of(*level, volume.minimum(), volume.maximum(), options,
                [&](int step) { return sites_of(all_of_it, whole_box(volume.geometry()), step); });
    double all = volume.type() == SampleType::float32 ? 2 : 3, done = 0;  // sweeps of all samples
    const auto cost = [](int step) { return 1.0 / (step * step * step); };
    for (const auto& rounds : plan.rounds) {
        const bool is_up = rounds.way == DequantizePlan::Rounds::Way::up;
        all += (rounds.count + int(is_up)) * cost(rounds.step);
    }
    const auto swept = [&](double part) {
        done += part;
        tell(first + (1 - first) * done / all);
    };

    const Parallel parallel = in_parallel(options.threads);
    // A few pieces at a time, so that the work can be stopped between them.
    const Parallel told = [&](int pieces, const std::function<void(int)>& work) {
        constexpr int few = 64;
        for (int from = 0; from < pieces; from += few) {
            const int count = std::min(few, pieces - from);
            parallel(count, [&](int i) { work(from + i); });
            swept(double(count) / pieces);
        }
    };
    Workspace workspace(std::move(volume), told);
    const MovedSamples samples = workspace.samples();
    Pyramid pyramid(samples, plan, terraced_bricks(samples, plan, told), parallel);
    for (const auto& rounds : plan.rounds) {
        pyramid.run(rounds, [&](double part) { swept(part * cost(rounds.step)); });
    }
    return std::move(workspace).result(plan);
}

}  // namespace palpate::filters
