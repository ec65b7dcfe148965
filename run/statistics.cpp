// Histograms and Otsu's thresholds.
#include "palpate/run/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "palpate/field.hpp"

namespace palpate::run {
namespace {

/// Calls visit(sample) for all samples, and reports after each million: after milliseconds.
template <class T, class Visit>
void for_each_sample(const Volume& volume, const OnProgress& progress, const Visit& visit) {
    constexpr std::size_t block = std::size_t{1} << 20;
    std::span<const T> left = volume.samples<T>();
    ReportedItems reported(progress, left.size(), block);
    while (!left.empty()) {
        const auto now = left.first(std::min(block, left.size()));
        std::ranges::for_each(now, visit);
        reported.done(now.size());
        left = left.subspan(now.size());
    }
}

/// How many samples have the least value, and the least of the others.
template <class T>
std::pair<std::int64_t, double> above_least(const Volume& volume, const OnProgress& progress) {
    const T least = static_cast<T>(volume.minimum());
    std::int64_t count = 0;
    T next = static_cast<T>(volume.maximum());
    for_each_sample<T>(volume, progress, [&](const T s) {
        count += s == least;
        if (s > least && s < next) next = s;
    });
    return {count, static_cast<double>(next)};
}

template <class T>
void count(const Volume& volume, std::optional<double> padding, Histogram& h,
           const OnProgress& progress) {
    const double scale = static_cast<double>(h.counts.size()) / (h.high - h.low);
    const auto last = static_cast<std::int64_t>(h.counts.size()) - 1;
    double sum = 0;
    double squares = 0;
    std::int64_t counted = 0;
    for_each_sample<T>(volume, progress, [&](const T s) {
        if (padding && static_cast<double>(s) == *padding) return;
        ++counted;
        const double value = static_cast<double>(s) - h.low;
        const auto bin = std::min(last, static_cast<std::int64_t>(value * scale));
        ++h.counts[static_cast<std::size_t>(bin)];
        sum += value;
        squares += value * value;
    });
    const auto n = static_cast<double>(counted);
    h.mean = h.low + sum / n;
    h.deviation = std::sqrt(std::max(0.0, squares / n - (sum / n) * (sum / n)));
}

/// Samples between two levels.
struct Class {
    double share;  ///< of all samples
    double mean;   ///< [bins]
};

/// Whether the middle class is what an object was put into (resin, gel, a box): much of it, and
/// hardly denser than air next to the object.
bool is_filler(const Class& below, const Class& middle, const Class& above) {
    constexpr double least_share = 0.2, most_contrast = 0.2;
    return middle.share >= least_share && above.share > 0 &&
           middle.mean - below.mean < most_contrast * (above.mean - below.mean);
}

}  // namespace

std::optional<double> padding_of(const Volume& volume, std::optional<double> header,
                                 const OnProgress& progress) {
    constexpr double least_gap = 0.1, least_share = 0.001;
    const double least = volume.minimum(), greatest = volume.maximum();
    if (!(least < 0) || !(greatest > least)) return std::nullopt;
    const auto [count, next] = with_type(
        volume.type(), [&](auto zero) { return above_least<decltype(zero)>(volume, progress); });
    if (!(next < greatest)) return std::nullopt;  // a mask
    const auto all = static_cast<double>(sample_count(volume.geometry()));
    const bool stands_apart = next - least >= least_gap * (greatest - next) &&
                              static_cast<double>(count) >= least_share * all;
    return stands_apart || header == least ? std::optional(least) : std::nullopt;
}

Histogram histogram_of(const Volume& volume, int bins, std::optional<double> padding,
                       const OnProgress& progress) {
    Histogram h{volume.minimum(), volume.maximum(), {}, volume.minimum(), 0};
    if (padding) {
        h.low = with_type(volume.type(), [&](auto zero) {
            return above_least<decltype(zero)>(volume, progress).second;
        });
    }
    h.greatest = volume.maximum();
    if (h.high == h.low) {
        h.counts = {sample_count(volume.geometry())};
        return h;
    }
    // Integers get bins of a whole number of values each, or some bins would hold one more.
    if (volume.type() != SampleType::float32) {
        const double values = h.high - h.low + 1;
        const double width = std::max(1.0, std::ceil(values / bins));
        bins = static_cast<int>(std::ceil(values / width));
        h.high = h.low + width * bins;
        h.whole_numbers = true;
    }
    h.counts.assign(static_cast<std::size_t>(bins), 0);
    with_type(volume.type(),
              [&](auto zero) { count<decltype(zero)>(volume, padding, h, progress); });
    return h;
}

Histogram gradients_of(const Volume& volume, int bins) {
    constexpr double most_samples = 200'000;
    const Field field(volume, Solid::above, std::nullopt, Interpolation::cubic);
    const Index3& size = volume.geometry().size;
    const auto all = static_cast<double>(sample_count(volume.geometry()));
    const int step = std::max(1, static_cast<int>(std::ceil(std::cbrt(all / most_samples))));
    std::vector<double> magnitudes;
    for (int z = 0; z < size[2]; z += step) {
        for (int y = 0; y < size[1]; y += step) {
            for (int x = 0; x < size[0]; x += step) {
                const Vec3 at = physical_from_index(volume.geometry(), Vec3(x, y, z));
                magnitudes.push_back(gradient_at(field, at).norm());
            }
        }
    }
    Histogram h;
    const double greatest = std::ranges::max(magnitudes);
    h.high = greatest > 0 ? greatest : 1;
    h.greatest = h.high;
    h.counts.assign(static_cast<std::size_t>(bins), 0);
    const double scale = bins / h.high;
    for (const double magnitude : magnitudes) {
        const int bin = std::min(bins - 1, static_cast<int>(magnitude * scale));
        ++h.counts[static_cast<std::size_t>(bin)];
    }
    return h;
}

std::vector<double> suggested_isovalues(const Histogram& h) {
    const auto n = h.counts.size();
    if (n < 2) return {};
    // Sums below each bin border; the variance between classes is the sum of sum^2 / weight.
    std::vector<double> weight(n + 1, 0);
    std::vector<double> sum(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
        const auto c = static_cast<double>(h.counts[i]);
        weight[i + 1] = weight[i] + c;
        sum[i + 1] = sum[i] + c * (static_cast<double>(i) + 0.5);
    }
    const auto part = [&](std::size_t from, std::size_t to) {
        const double w = weight[to] - weight[from];
        const double s = sum[to] - sum[from];
        return w > 0 ? s * s / w : 0;
    };
    double best = -1;
    std::array<std::size_t, 2> cut{1, 1};
    for (std::size_t a = 1; a < n; ++a) {
        for (std::size_t b = a; b < n; ++b) {
            const double between = part(0, a) + part(a, b) + part(b, n);
            if (between > best) {
                best = between;
                cut = {a, b};
            }
        }
    }
    // Any cut in a gap is as good: its middle is farthest from both classes. (In a mask of 0 and 1
    // the level must be between them, or nothing is solid.)
    const double width = (h.high - h.low) / static_cast<double>(n);
    const double bin_middle = h.whole_numbers ? 0.5 * (width - 1) : 0.5 * width;
    std::vector<double> levels;
    for (const std::size_t c : cut) {
        std::size_t below = c - 1;
        std::size_t above = c;
        while (below > 0 && h.counts[below] == 0) --below;
        while (above + 1 < n && h.counts[above] == 0) ++above;
        const double level = h.low + bin_middle + 0.5 * width * static_cast<double>(below + above);
        if (levels.empty() || level > levels.back()) levels.push_back(level);
    }
    const auto class_of = [&](std::size_t from, std::size_t to) {
        const double w = weight[to] - weight[from];
        return Class{w / weight[n], w > 0 ? (sum[to] - sum[from]) / w : 0};
    };
    if (levels.size() == 2 &&
        is_filler(class_of(0, cut[0]), class_of(cut[0], cut[1]), class_of(cut[1], n))) {
        std::swap(levels[0], levels[1]);
    }
    return levels;
}

}  // namespace palpate::run
