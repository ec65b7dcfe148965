// Loads a volume, and reads names and single slices of raw files.
#include "apps/viewer/model/opening.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numeric>
#include <regex>
#include <span>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "io/byte_order.hpp"
#include "io/system/number.hpp"

namespace palpate::viewer {
namespace {

constexpr int bins = 256;
/// Part of the samples, at either end, that may be all black or all white, of all of them and of
/// those that are not background.
constexpr double outliers = 0.002, foreground_outliers = 0.02;

/// Of values, as those of labels and masks, whose background is one of them.
constexpr auto few = 32;

double sum_of(std::span<const std::int64_t> counts) {
    return static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
}

/// The bins without a background that is most of the samples: a peak, as wide as its noise, and
/// what lies beyond it at its end of the range.
std::span<const std::int64_t> foreground_of(std::span<const std::int64_t> counts) {
    constexpr double foot = 0.01;   // of the peak's height
    constexpr double spread = 2.5;  // of the peak's half width at half its height: 3 deviations
    const auto values = std::ranges::count_if(counts, [](auto count) { return count > 0; });
    if (values <= few) return counts;
    const auto peak = std::ranges::max_element(counts);
    const auto end_of_peak = [&](auto from, auto end) {
        const auto below = [&](double part) {
            return std::find_if(from, end,
                                [&](auto n) { return double(n) < part * double(*peak); });
        };
        const auto width = static_cast<double>(below(0.5) - from);
        const auto most = static_cast<std::ptrdiff_t>(1 + std::ceil(spread * width));
        return from + std::min(below(foot) - from, most);
    };
    const auto after = end_of_peak(peak, counts.end());
    const auto before = end_of_peak(std::reverse_iterator(peak + 1), counts.rend()).base();
    if (2 * sum_of({before, after}) <= sum_of(counts)) return counts;
    if (peak - counts.begin() < counts.end() - peak) return {after, counts.end()};
    return {counts.begin(), before};
}

/// The level with the brightest or the darkest samples, which may be all white or all black,
/// beyond it.
double end_of_window(const run::Histogram& histogram, bool brightest) {
    const std::span<const std::int64_t> all(histogram.counts);
    const auto counts = foreground_of(all);
    const double most = std::min(outliers * sum_of(all), foreground_outliers * sum_of(counts));
    const auto first = static_cast<std::size_t>(counts.data() - all.data());
    const auto level = [&](std::size_t bin) {
        return std::lerp(histogram.low, histogram.high, double(first + bin) / double(all.size()));
    };
    double beyond = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const std::size_t bin = brightest ? counts.size() - 1 - i : i;
        beyond += static_cast<double>(counts[bin]);
        if (beyond > most) return level(bin + (brightest ? 1 : 0));
    }
    return brightest ? histogram.high : histogram.low;
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

/// The earliest time for what is no file or folder, or is not there.
std::filesystem::file_time_type time_of(const run::Source& source) {
    const auto* file = std::get_if<run::FileSource>(&source.from);
    std::error_code error;
    const auto time = file ? std::filesystem::last_write_time(file->path, error)
                           : std::filesystem::file_time_type::min();
    return error ? std::filesystem::file_time_type::min() : time;
}

}  // namespace

double Opened::dark() const {
    if (const auto& window = loaded.values.window) return window->centre - 0.5 * window->width;
    return end_of_window(histogram, false);
}

double Opened::bright() const {
    if (const auto& window = loaded.values.window) return window->centre + 0.5 * window->width;
    // The last bin of few whole numbers ends beyond them.
    const double most = loaded.volume.maximum();
    const double level = std::min(end_of_window(histogram, true), most);
    return level > dark() ? level : most;
}

bool is_outdated(const Opened& opened) {
    const auto time = time_of(opened.loaded.source);
    return time != opened.written && time != std::filesystem::file_time_type::min();
}

Opened open(const run::Source& source, const io::Progress& progress) {
    const auto written = time_of(source);  // before it is read
    // Counting takes at most a tenth of the time of reading.
    run::LoadedVolume loaded = loaded_from(source, [&](double part) { progress(0.9 * part); });
    const OnProgress counting = [&](double) { progress(0.9); };
    run::Histogram histogram = run::histogram_of(
        loaded.volume, bins, run::padding_of(loaded.volume, loaded.values.padding, counting),
        counting);
    // The rounding of an overview differs from that of the touched samples.
    const bool none = source.dequantize > 0 || loaded.streamed;
    auto terraces = none ? std::nullopt : filters::terraces_of(loaded.volume, counting);
    progress(1);
    return {std::move(loaded), std::move(histogram), std::move(terraces), written, {}};
}

double first_isovalue(const Opened& opened) {
    if (opened.loaded.isovalue) return *opened.loaded.isovalue;
    const std::vector<double> levels = run::suggested_isovalues(opened.histogram);
    if (levels.empty()) {
        throw std::invalid_argument(opened.loaded.name +
                                    ": the data is constant, so there is no surface to touch");
    }
    return levels.front();
}

namespace {

constexpr double largest_slice = 256e6;  // bytes

/// Grey levels of samples as they lie in a file of this machine's byte order.
template <class T>
std::vector<std::uint8_t> grey_of(const std::vector<std::byte>& bytes) {
    std::vector<T> samples(bytes.size() / sizeof(T));
    std::memcpy(samples.data(), bytes.data(), samples.size() * sizeof(T));
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const T sample : samples) {
        const auto value = static_cast<double>(sample);
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    std::vector<std::uint8_t> grey(samples.size());
    const double scale = high > low ? 255 / (high - low) : 0;
    std::ranges::transform(samples, grey.begin(), [&](T sample) {
        const double level = scale * (static_cast<double>(sample) - low);
        return static_cast<std::uint8_t>(std::isfinite(level) ? level : 0);
    });
    return grey;
}

/// The whole number whose cube this is, or 0.
int cube_root(std::uint64_t samples) {
    const auto root = static_cast<std::uint64_t>(std::lround(std::cbrt(double(samples))));
    return root * root * root == samples ? static_cast<int>(root) : 0;
}

/// 0 where the text is no number that can be a size.
int size_from(const std::string& text) {
    return io::number_from<int>(text).value_or(0);
}

}  // namespace

bool lacks_layout(const run::Source& source) {
    const auto* file = std::get_if<run::FileSource>(&source.from);
    const std::regex names("\\.(raw|bin|dat)(\\.gz)?$", std::regex::icase);
    return file && !file->raw && std::regex_search(file->path, names) &&
           std::filesystem::is_regular_file(file->path);
}

io::RawLayout guessed_layout(const std::filesystem::path& path, std::uint64_t bytes) {
    io::RawLayout layout;
    const std::string name = path.filename().string();
    std::smatch found;
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        // "int16" is a part of "uint16", which comes after it.
        if (name.find(name_of(type)) != std::string::npos) layout.type = type;
    }
    layout.big_endian = std::regex_search(name, std::regex("[-_.](be|big)[-_.]"));
    if (std::regex_search(name, found, std::regex("(\\d+)[xX](\\d+)[xX](\\d+)"))) {
        for (int a = 0; a < 3; ++a) layout.size[a] = size_from(found[std::size_t(a) + 1].str());
        if ((layout.size.array() > 0).all()) return layout;
    }
    layout.size.setConstant(256);
    for (const SampleType type : {layout.type, SampleType::uint8, SampleType::uint16}) {
        const std::size_t each = size_of(type);
        const int side = bytes % each == 0 ? cube_root(bytes / each) : 0;
        if (side == 0) continue;
        layout.size.setConstant(side);
        layout.type = type;
        break;
    }
    return layout;
}

double bytes_of(const io::RawLayout& layout) {
    return layout.size.cast<double>().prod() * double(size_of(layout.type)) + double(layout.skip);
}

std::optional<io::Thumbnail> raw_slice(const std::filesystem::path& path,
                                       const io::RawLayout& layout, int z) {
    const double bytes =
        double(size_of(layout.type)) * double(layout.size[0]) * double(layout.size[1]);
    if (path.extension() == ".gz" || !(bytes > 0 && bytes <= largest_slice)) return std::nullopt;
    std::ifstream file(path, std::ios::binary);
    std::vector<std::byte> slice(static_cast<std::size_t>(bytes));
    file.seekg(static_cast<std::streamoff>(double(layout.skip) + bytes * z));
    file.read(reinterpret_cast<char*>(slice.data()), static_cast<std::streamsize>(slice.size()));
    if (!file) return std::nullopt;
    if (layout.big_endian) io::swap_bytes(slice, size_of(layout.type));
    io::Thumbnail picture;
    picture.width = layout.size[0];
    picture.height = layout.size[1];
    picture.grey =
        with_type(layout.type, [&](auto zero) { return grey_of<decltype(zero)>(slice); });
    return picture;
}

}  // namespace palpate::viewer
