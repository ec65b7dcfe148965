// Zeiss LSM: "LSM File Format", Carl Zeiss Jena, a structure in tag 34412. ScanImage: lines in the
// tag Software or in descriptions, https://docs.scanimage.org. tifffile: JSON in the description.
#include "io/helper/tiff_counts.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "io/byte_order.hpp"
#include "io/helper/decode.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

bool fits(const CountedPages& told, std::size_t planes) {
    const auto [slices, channels, times] = told.sizes;
    return static_cast<double>(slices) * static_cast<double>(channels) *
               static_cast<double>(times) ==
           static_cast<double>(planes);
}

void check_product(const CountedPages& told, std::size_t planes) {
    if (fits(told, planes)) return;
    const auto [slices, channels, times] = told.sizes;
    throw Failure("tells of " + std::to_string(slices) + " slices, " + std::to_string(channels) +
                  " channels and " + std::to_string(times) + " times, but has " +
                  std::to_string(planes) +
                  " pages: it is cut off, or has several positions; copy it again, or save one of "
                  "them");
}

/// Channels are in each page, so that only slices and times are counted.
std::optional<CountedPages> told_by_lsm(TIFF* tiff) {
    constexpr std::uint32_t tag = 34412;
    constexpr std::size_t least_bytes = 120;
    std::uint32_t bytes = 0;
    const void* data = nullptr;
    if (TIFFGetField(tiff, tag, &bytes, &data) == 0 || !data || bytes < least_bytes) return {};
    const std::span header(static_cast<const std::byte*>(data), bytes);
    const auto whole = [&](std::size_t at) {
        return std::int64_t{little_endian<std::int32_t>(header.subspan(at))};
    };
    const auto real = [&](std::size_t at) { return little_endian<double>(header.subspan(at)); };
    if (whole(0) != 0x0300494C && whole(0) != 0x0400494C) return {};
    const auto scan = little_endian<std::uint16_t>(header.subspan(88));
    const bool times_first = scan == 3 || scan == 5 || scan == 7 || scan == 9;
    return CountedPages{"Zeiss LSM",
                        times_first ? "XYCTZ" : "XYCZT",
                        {whole(16), 1, whole(24)},
                        {real(40), real(48), real(56)},
                        real(112)};
}

/// The text behind "KEY = " in a line. Empty if there is none.
std::string value_of(const std::string& lines, const std::string& key) {
    const auto at = lines.find(key + " = ");
    if (at == std::string::npos) return "";
    const std::size_t begin = at + key.size() + 3;
    return trimmed(lines.substr(begin, lines.find_first_of("\r\n", begin) - begin));
}

/// How many numbers a list of MATLAB has, such as "[1;2]".
std::int64_t length_of(const std::string& list) {
    std::int64_t count = 0;
    bool in_number = false;
    for (const char c : list) {
        const bool digit = c >= '0' && c <= '9';
        count += digit && !in_number ? 1 : 0;
        in_number = digit;
    }
    return count;
}

/// Its frames of a slice follow each other, or its volumes do.
std::optional<CountedPages> told_by_scan_image(TIFF* tiff, const std::string& description,
                                               std::size_t planes,
                                               std::vector<std::string>& notes) {
    const char* software = nullptr;
    TIFFGetField(tiff, TIFFTAG_SOFTWARE, &software);
    const std::string lines = (software ? std::string(software) + '\n' : "") + description;
    std::string saved;
    for (const char* key : {"hChannels.channelSave", "SI5.channelsSave", "SI4.channelsSave"}) {
        if (saved.empty()) saved = value_of(lines, key);
    }
    if (saved.empty()) return {};
    const auto number = [&](const char* key) {
        const double told = number_from<double>(value_of(lines, key)).value_or(1);
        return told >= 1 && told <= 1 << 20 && told == std::floor(told) ? std::int64_t(told) : 0;
    };
    const auto all = static_cast<std::int64_t>(planes);
    const std::int64_t channels = std::max<std::int64_t>(length_of(saved), 1);
    const std::int64_t frames = number("hStackManager.framesPerSlice");  // 0: as many as there are
    const std::int64_t slices = number(value_of(lines, "hStackManager.actualNumSlices").empty()
                                           ? "hStackManager.numSlices"
                                           : "hStackManager.actualNumSlices");
    CountedPages told{"ScanImage", "XYCZT", {all / channels, channels, 1}};
    if (frames == 0) {
        told.sizes = {1, channels, all / channels};
    } else if (frames > 1) {
        told.order = "XYCTZ";
        told.sizes = {all / channels / frames, channels, frames};
    } else if (slices > 1 && all % (channels * slices) == 0) {
        told.sizes = {slices, channels, all / channels / slices};
    } else if (all > channels) {
        notes.emplace_back(
            "ScanImage does not say whether its pages are slices or times: they were taken as "
            "slices");
    }
    return told;
}

/// Counts of a description with axes such as "TCZYX". It may describe the first page alone, to
/// which others were added.
std::optional<CountedPages> told_by_axes(const nlohmann::json& told, std::size_t planes) {
    const nlohmann::json names = told.is_null() ? told : told.value("axes", nlohmann::json());
    if (!names.is_string() || names.get<std::string>().size() != told["shape"].size()) return {};
    std::string axes = names.get<std::string>();
    if (!axes.ends_with("YX")) return {};
    axes.resize(axes.size() - 2);
    CountedPages counted{"TIFF", "XY", {1, 1, 1}};
    static const std::string letters = "ZCT";
    for (std::size_t i = axes.size(); i-- > 0;) {
        const std::size_t axis = letters.find(axes[i]);
        if (axis == std::string::npos || counted.order.find(axes[i]) != std::string::npos)
            return {};
        counted.order += axes[i];
        counted.sizes[axis] = std::int64_t(told["shape"][i].get<std::uint64_t>());
    }
    for (const char letter : letters) {
        if (counted.order.find(letter) == std::string::npos) counted.order += letter;
    }
    if (!fits(counted, planes)) return {};
    return counted;
}

/// tifffile's shape may be the only word of planes that TIFF does not know.
void check_shape(const nlohmann::json& told, const TiffPage& page, std::size_t planes,
                 bool is_counted, std::vector<std::string>& notes) {
    if (told.is_null()) return;
    const std::string text = shape_in(told);
    int axes = 0;
    for (const nlohmann::json& size : told["shape"]) {
        axes += size.get<std::uint64_t>() > 1 ? 1 : 0;
    }
    if (samples_in(told) > static_cast<double>(planes) * page.width * page.height) {
        throw Failure("its description gives it the shape " + text.substr(0, 60) + ", but it has " +
                      std::to_string(planes) +
                      " pages as TIFF counts them; save each slice as a page");
    }
    const nlohmann::json names = told.value("axes", nlohmann::json());  // such as "TYX"
    const bool has_others =
        names.is_string() && names.get<std::string>().find_first_of("TC") != std::string::npos;
    if (!is_counted && (axes > 3 || (axes > 2 && has_others))) {
        notes.push_back("its description gives it the shape " + text.substr(0, 60) +
                        (has_others ? " of axes " + names.get<std::string>().substr(0, 20) : "") +
                        ": all its pages were taken as slices");
    }
}

/// Programs that say in tags of their own how they count pages, which are not read.
void note_own_tags(TIFF* tiff, std::vector<std::string>& notes) {
    constexpr std::pair<std::uint32_t, const char*> programs[] = {{34361, "FluoView"},
                                                                  {51123, "Micro-Manager"}};
    for (const auto& [tag, name] : programs) {
        std::uint32_t count = 0;
        const void* data = nullptr;
        if (TIFFGetField(tiff, tag, &count, &data) == 0) continue;
        notes.push_back("what " + std::string(name) +
                        " says of its pages was not used: all of them were taken as slices");
    }
}

}  // namespace

nlohmann::json told_by_tifffile(const std::string& description) {
    nlohmann::json told = nlohmann::json::parse(description, nullptr, false);
    if (!told.is_object() || !told.contains("shape") || !told["shape"].is_array()) return nullptr;
    const auto is_size = [](const nlohmann::json& size) { return size.is_number_unsigned(); };
    return std::ranges::all_of(told["shape"], is_size) ? told : nullptr;
}

std::string shape_in(const nlohmann::json& told) {
    std::string text;
    for (const nlohmann::json& size : told["shape"]) {
        text += (text.empty() ? "" : "x") + std::to_string(size.get<std::uint64_t>());
    }
    return text;
}

double samples_in(const nlohmann::json& told) {
    if (told.is_null()) return 0;
    double samples = 1;
    for (const nlohmann::json& size : told["shape"]) samples *= size.get<double>();
    return samples;
}

std::optional<CountedPages> counted_pages(TIFF* tiff, const std::string& description,
                                          const TiffPage& first, std::size_t planes,
                                          std::vector<std::string>& notes) {
    const nlohmann::json by_tifffile = told_by_tifffile(description);
    auto told = told_by_lsm(tiff);
    if (!told) told = told_by_scan_image(tiff, description, planes, notes);
    if (!told) {
        told = told_by_axes(by_tifffile, planes);
        check_shape(by_tifffile, first, planes, told.has_value(), notes);
    }
    if (told) check_product(*told, planes);
    if (!told && planes > 1 && description.empty()) note_own_tags(tiff, notes);
    return told;
}

}  // namespace palpate::io
