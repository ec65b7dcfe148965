// The levels on which samples lie, and the effect of rounding to them on surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <type_traits>
#include <unordered_set>
#include <vector>

#include "filters/terraced_bricks.hpp"

namespace palpate::filters {
namespace {

constexpr std::size_t most_levels = 65536;
constexpr std::size_t between_reports = std::size_t{1} << 20;  // samples

/// The values that occur, ascending; empty if there are more than most_levels.
template <class T>
std::vector<double> values_in(std::span<const T> samples, const OnProgress& progress) {
    std::vector<double> values;
    ReportedItems reported(progress, samples.size(), between_reports);
    if constexpr (std::is_integral_v<T>) {
        constexpr int lowest = std::numeric_limits<T>::lowest();
        std::vector<std::uint8_t> occurs(std::size_t(std::numeric_limits<T>::max() - lowest) + 1);
        for (std::span<const T> rest = samples; !rest.empty();) {
            const std::span<const T> some = rest.first(std::min(rest.size(), between_reports));
            for (const T s : some) occurs[std::size_t(s - lowest)] = 1;
            reported.done(some.size());
            rest = rest.subspan(some.size());
        }
        for (std::size_t i = 0; i < occurs.size(); ++i) {
            if (occurs[i] != 0) values.push_back(double(i) + lowest);
        }
    } else {
        std::unordered_set<T> found;
        T last = samples[0];
        found.insert(last);
        for (const T s : samples) {
            reported.done();
            if (s == last) continue;
            last = s;
            found.insert(s);
            if (found.size() > most_levels) return {};
        }
        values.assign(found.begin(), found.end());
        std::ranges::sort(values);
    }
    return values;
}

/// Are these gaps whole numbers of the smallest? Rounding to float disturbs them a little, and
/// large ones more than a fiftieth of the smallest, so only small ones can tell.
bool on_levels(std::span<const double> values, double smallest) {
    for (std::size_t i = 1; i < values.size(); ++i) {
        const double count = (values[i] - values[i - 1]) / smallest;
        if (count < 8 && std::abs(count - std::round(count)) > 0.02) return false;
    }
    return true;
}

constexpr double most_sites = 3e4;  ///< for the choice of the coarsest step

/// Calls work for up to about `most` samples of a grid, at even distances, none on the border; only
/// for those in `core`.
template <class Work>
void for_sites(const Index3& size, double most, const SampleBox& core, const Work& work) {
    const double apart = std::cbrt(double(size.cast<std::int64_t>().prod()) / most);
    const int stride = std::max(1, int(std::ceil(apart)));
    // The first of 1, 1 + stride, ... in the core, and the last sample before its end or the
    // border.
    const Index3 first =
        Index3::Ones() + (core.low.cwiseMax(1).array() - 1 + stride - 1).matrix() / stride * stride;
    const Index3 last = core.high.cwiseMin(size - 2 * Index3::Ones());
    for (int k = first[2]; k <= last[2]; k += stride) {
        for (int j = first[1]; j <= last[1]; j += stride) {
            for (int i = first[0]; i <= last[0]; i += stride) work({i, j, k});
        }
    }
}

double near_sample(const Volume& volume, const Index3& at) {
    const Index3 last = volume.geometry().size - Index3::Ones();
    return volume.sample(at.cwiseMax(0).cwiseMin(last));
}

/// Slope over four samples, so that a terrace or two is no plateau [data units a sample].
double slope_at(const Volume& volume, const Index3& at) {
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
        const Index3 two = 2 * Index3::Unit(axis);
        slope[axis] = (near_sample(volume, at + two) - near_sample(volume, at - two)) / 4;
    }
    return slope.norm();
}

struct Smooth {
    double mean;   ///< b, the binomial mean of the 27 neighbours `step` apart [data units]
    double twice;  ///< Bb
};
/// As dequantized() has them. Samples beyond the border count as those on it.
Smooth smooth_at(const Volume& volume, const Index3& at, int step) {
    constexpr double once[5] = {0, 0.25, 0.5, 0.25, 0};
    constexpr double twice[5] = {0.0625, 0.25, 0.375, 0.25, 0.0625};
    Smooth smooth{0, 0};
    for (int k = 0; k < 5; ++k) {
        for (int j = 0; j < 5; ++j) {
            for (int i = 0; i < 5; ++i) {
                const double s = near_sample(volume, at + step * Index3(i - 2, j - 2, k - 2));
                smooth.mean += once[i] * once[j] * once[k] * s;
                smooth.twice += twice[i] * twice[j] * twice[k] * s;
            }
        }
    }
    return smooth;
}

/// As many labels as a map without names may have, and the background.
constexpr std::size_t most_labels = 65;

bool are_labels(std::span<const double> values) {
    return values.size() > 2 && values.size() <= most_labels && values.front() >= 0 &&
           std::ranges::all_of(values, [](double value) { return value == std::round(value); });
}

/// Mean tilt of normals by rounding where a sample is one level above its neighbour [degrees].
constexpr double tilt_at_slope_1 = 12.6;
/// Where a sample is so many levels above its neighbour, rounding tilts by two degrees: not felt.
constexpr double steepest = 6;

}  // namespace

std::vector<double> values_of(const Volume& volume, const OnProgress& progress) {
    return with_type(volume.type(), [&](auto zero) {
        return values_in(volume.samples<decltype(zero)>(), progress);
    });
}

std::optional<double> level_of(std::span<const double> values, bool whole_numbers) {
    if (values.size() < 2) return std::nullopt;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < values.size(); ++i) {
        smallest = std::min(smallest, values[i] - values[i - 1]);
    }
    if (!whole_numbers && !on_levels(values, smallest)) return std::nullopt;
    // A distance so small is that of numbers, not of levels.
    const bool has_levels = smallest > 1e-30 && values.back() - values.front() < 1e9 * smallest;
    return has_levels ? std::optional(smallest) : std::nullopt;
}

std::optional<double> level_of(const Volume& volume, const OnProgress& progress) {
    return level_of(values_of(volume, progress), volume.type() != SampleType::float32);
}

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

std::optional<Terraces> terraces_of(const Volume& volume, const OnProgress& progress) {
    const std::vector<double> values = values_of(volume, progress);
    const std::optional<double> level = level_of(values, volume.type() != SampleType::float32);
    if (!level) return std::nullopt;
    Terraces terraces;
    terraces.labels = are_labels(values);
    terraces.level = *level;
    terraces.mask = is_mask(volume.minimum(), volume.maximum(), *level);
    if (terraces.mask) return terraces;
    double all = 0, stepped = 0, tilt = 0;
    for_sites(volume.geometry().size, 2e5, whole_box(volume.geometry()), [&](const Index3& at) {
        const double slope = slope_at(volume, at) / *level;
        all += slope;
        if (slope == 0 || slope > steepest) return;
        const Smooth smooth = smooth_at(volume, at, 1);
        const double expected = 2 * smooth.mean - smooth.twice;
        if (std::abs(volume.sample(at) - expected) > 0.5 * *level) return;
        stepped += slope;
        tilt += slope * tilt_at_slope_1 / std::max(slope, 0.25);
    });
    if (stepped > 0) {
        terraces.share = stepped / all;
        terraces.tilt = tilt / stepped;
    }
    return terraces;
}

std::string reason_to_dequantize(const Terraces& terraces) {
    if (!terraces.wide()) return {};
    if (terraces.mask) return "the samples have two values, so surfaces are stair steps";
    std::array<char, 160> text{};
    std::snprintf(
        text.data(), text.size(),
        "rounding to levels of %g makes terraces of %.0f%% of the surfaces and tilts them "
        "by %.0f degrees",
        terraces.level, 100 * terraces.share, terraces.tilt);
    return text.data();
}

}  // namespace palpate::filters
