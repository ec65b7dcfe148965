// Loads a volume and takes grey levels and a first isovalue from its histogram.
#include "apps/viewer/model/opening.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace palpate::viewer {
namespace {

constexpr int bins = 256;
/// Part of the samples, at either end, that may be all black or all white.
constexpr double outliers = 0.002;

/// The level below which this part of the samples lies, but for a background that is most of them.
double quantile(const run::Histogram& histogram, double part) {
    auto counts = histogram.counts;
    const auto most = std::ranges::max_element(counts);
    const auto sum = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
    if (2 * *most > sum && *most < sum) *most = 0;
    const double all =
        static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
    double below = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        below += static_cast<double>(counts[i]);
        if (below >= part * all) {
            return histogram.low + (histogram.high - histogram.low) * double(i + (part > 0.5)) /
                                       double(counts.size());
        }
    }
    return histogram.high;
}

/// As run::load(); io::SeriesChoice comes with pictures.
run::LoadedVolume loaded_from(const run::Source& source, const io::Progress& progress) {
    try {
        return run::load(source, progress);
    } catch (const io::SeriesChoice&) {
        const auto& file = std::get<run::FileSource>(source.from);
        io::ReadOptions options;
        options.series = file.series;
        options.series_pictures = true;
        options.progress = progress;
        (void)io::read_volume(file.path, options);
        throw;
    }
}

}  // namespace

double Opened::dark() const {
    if (const auto& window = loaded.values.window) return window->centre - 0.5 * window->width;
    return quantile(histogram, outliers);
}

double Opened::bright() const {
    if (const auto& window = loaded.values.window) return window->centre + 0.5 * window->width;
    const double level = quantile(histogram, 1 - outliers);
    return level > dark() ? level : loaded.volume.maximum();
}

Opened open(const run::Source& source, const io::Progress& progress) {
    // Counting takes at most a tenth of the time of reading.
    run::LoadedVolume loaded = loaded_from(source, [&](double part) { progress(0.9 * part); });
    const OnProgress counting = [&](double) { progress(0.9); };
    run::Histogram histogram = run::histogram_of(
        loaded.volume, bins, run::padding_of(loaded.volume, loaded.values.padding, counting),
        counting);
    // An overview's rounding says nothing about the samples that are felt.
    const bool none = source.dequantize > 0 || loaded.streamed;
    auto terraces = none ? std::nullopt : filters::terraces_of(loaded.volume, counting);
    progress(1);
    return {std::move(loaded), std::move(histogram), std::move(terraces)};
}

double first_isovalue(const Opened& opened) {
    if (opened.loaded.isovalue) return *opened.loaded.isovalue;
    const std::vector<double> levels = run::suggested_isovalues(opened.histogram);
    if (levels.empty()) {
        throw std::invalid_argument(opened.loaded.name +
                                    ": the data are constant, there is nothing to feel");
    }
    return levels.front();
}

}  // namespace palpate::viewer
