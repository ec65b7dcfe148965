// Descriptions of TIFF files other than OME-XML. ImageJ: lines of key=value after a first line
// ImageJ=VERSION. Lengths are in its unit. XResolution and YResolution are pixels per unit,
// whatever ResolutionUnit says. ImageJ2 writes SCIFIO=VERSION, and lists of axes with their
// lengths, scales and units. Zeiss LSM: "LSM File Format", Carl Zeiss Jena, a structure in tag
// 34412. ScanImage: lines in the tag Software or in descriptions, https://docs.scanimage.org.
// tifffile: JSON.
#include "io/helper/tiff_descriptions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include "io/byte_order.hpp"
#include "io/system/number.hpp"
#include "io/units.hpp"

namespace palpate::io {
namespace {

using Description = std::map<std::string, std::string>;

/// Empty if it has none of that name.
std::string text_in(const Description& description, const char* name) {
    const auto found = description.find(name);
    return found == description.end() ? "" : found->second;
}

/// A number of the description; nothing if it has none of that name.
std::optional<double> number_in(const Description& description, const char* name) {
    return number_from<double>(text_in(description, name));
}

/// A count of the description; 1 if it does not say.
double count_in(const Description& description, const char* name) {
    return number_in(description, name).value_or(1);
}

/// The parts of a list such as "X,Y,Z".
std::vector<std::string> listed(const Description& description, const char* name) {
    std::vector<std::string> parts;
    std::istringstream text(text_in(description, name));
    for (std::string part; std::getline(text, part, ',');) parts.push_back(trimmed(part));
    return parts;
}

/// Says the axes of SCIFIO (ImageJ2) in ImageJ's words: channels, frames, slices, units, distances.
/// Axes that ImageJ does not have count as channels. An axis of no known kind holds the slices, if
/// no other does.
void take_scifio_axes(Description& description) {
    auto axes = listed(description, "axes");
    for (std::string& axis : axes) axis = lower(axis);
    const auto unknown = std::ranges::find(axes, "unknown");
    if (unknown != axes.end() && std::ranges::find(axes, "z") == axes.end()) {
        *unknown = "z";
        description["unknown"] = "z";
    }
    auto lengths = listed(description, "lengths"), scales = listed(description, "scales"),
         units = listed(description, "units");
    for (auto* list : {&lengths, &scales, &units}) list->resize(axes.size());
    double channels = 1, frames = 1;
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const std::string& axis = axes[i];
        const double length = number_from<double>(lengths[i]).value_or(1);
        if (axis == "x" || axis == "y" || axis == "z") {
            description[axis + "scale"] = scales[i];
            description[axis == "x" ? "unit" : axis + "unit"] = units[i];
        }
        if (axis == "z") {
            if (frames > 1 && length > 1) {
                throw Failure(
                    "counts its times before its slices, which is not read; save it "
                    "with the slices of a time together");
            }
            description["slices"] = lengths[i];
            description["spacing"] = scales[i];
        } else if (axis == "time") {
            description["frames"] = lengths[i];
            if (!scales[i].empty()) description["finterval"] = scales[i];
            if (!units[i].empty()) description["tunit"] = units[i];
            frames = length;
        } else if (axis != "x" && axis != "y") {
            channels *= length;
        }
    }
    if (!axes.empty()) description["channels"] = std::to_string(channels);
}

/// Empty unless ImageJ or SCIFIO wrote it.
Description fields_of(const std::string& text) {
    std::istringstream lines(text);
    Description description;
    for (std::string line; std::getline(lines, line);) {
        const auto equals = line.find('=');
        if (equals == std::string::npos) continue;
        description.emplace(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
    }
    if (description.contains("SCIFIO")) {
        take_scifio_axes(description);
    } else if (!description.contains("ImageJ")) {
        description.clear();
    }
    return description;
}

/// The distance between slices in ImageJ's unit; NaN where it gives none. ImageJ leaves out a 1
/// where there are slices.
double slice_distance(const Description& description) {
    if (description.contains("spacing")) {
        return std::abs(number_in(description, "spacing").value_or(std::nan("")));
    }
    return description.contains("slices") ? 1 : std::nan("");
}

/// The unit of an axis: its own, or that of all.
std::string unit_in(const Description& description, const char* own) {
    return text_in(description, description.contains(own) ? own : "unit");
}

/// ImageJ leaves out a resolution of 1 pixel.
double resolution_of(TIFF* tiff, std::uint32_t tag, const std::string& unit) {
    float resolution = 0;
    const bool given = TIFFGetField(tiff, tag, &resolution) != 0;
    return given || millimetres_in(unit) ? double(resolution) : 1;
}

/// As slices, if it does not say. Throws Failure where it has channels of a single slice, or other
/// counts than there are pages.
CountedPages told_by_image_j(const std::string& text, std::size_t pages,
                             std::vector<std::string>& notes) {
    const Description description = fields_of(text);
    const double channels = std::max(count_in(description, "channels"), 1.0);
    if (channels > 1 && description.contains("SCIFIO")) {  // in an order of its own
        throw Failure("holds " + text_of(channels) +
                      " channels slice by slice; save one of them (ImageJ: Image > Duplicate)");
    }
    if (channels > 1 && !(count_in(description, "slices") > 1)) {
        throw Failure("holds " + text_of(channels) +
                      " channels of one slice; if they are slices, say so in the file (ImageJ: "
                      "Image > Properties)");
    }
    if (description.contains("unknown") && count_in(description, "slices") > 1) {
        notes.emplace_back(
            "its description gives an axis of no known kind: it was taken as slices");
    }
    const double images = count_in(description, "images");
    if (images > static_cast<double>(pages)) {
        throw Failure("tells of " + text_of(images) + " slices, but has " + std::to_string(pages) +
                      "; it is cut off: copy it again");
    }
    if (description.contains("images") && images < static_cast<double>(pages)) {
        notes.push_back("its description counts " + text_of(images) + " of its " +
                        std::to_string(pages) + " pages: all of them were taken");
    }
    const double frames = std::max(count_in(description, "frames"), 1.0);
    const double slices = static_cast<double>(pages) / frames / channels;
    if (slices != std::floor(slices) || channels != std::floor(channels)) {
        throw Failure("tells of " + (channels > 1 ? text_of(channels) + " channels and " : "") +
                      text_of(frames) + " times, but has " + std::to_string(pages) +
                      " pages; save it again");
    }
    // Micro-Manager knows another order than ImageJ.
    CountedPages counted{"TIFF", lower(text_in(description, "order")) == "zct" ? "XYZCT" : "XYCZT"};
    counted.sizes = {static_cast<std::int64_t>(slices), static_cast<std::int64_t>(channels),
                     static_cast<std::int64_t>(frames)};
    if (frames > 1 && description.contains("finterval")) {
        counted.seconds =
            frame_times(number_in(description, "finterval").value_or(0), 0,
                        description.contains("tunit") ? text_in(description, "tunit") : "s", notes)
                .interval;
    }
    return counted;
}

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

/// What ScanImage counts. Pages follow each other by channel, frame, slice and volume.
struct ScanImageCounts {
    std::int64_t channels = 1;
    std::int64_t frames = 1;  ///< of a slice, as they are stored; 0: as many as there are
    std::int64_t slices = 1;
    std::int64_t flyback = 0;  ///< frames behind each volume that belong to no slice
    std::int64_t volumes = 1;
};

std::optional<ScanImageCounts> scan_image_counts(const std::string& lines) {
    const auto number = [&](const std::string& key, std::int64_t missing = 1) {
        const std::string text = value_of(lines, key);
        if (text.empty()) return missing;
        const double told = number_from<double>(text).value_or(0);
        return told >= 1 && told <= 1 << 20 && told == std::floor(told) ? std::int64_t(told) : 0;
    };
    std::string saved;
    for (const char* key : {"hChannels.channelSave", "SI5.channelsSave", "SI4.channelsSave"}) {
        if (saved.empty()) saved = value_of(lines, key);
    }
    if (saved.empty()) return {};
    ScanImageCounts counts{std::max<std::int64_t>(length_of(saved), 1)};
    counts.frames = number("hStackManager.framesPerSlice");
    const std::int64_t averaged = number("hScan2D.logAverageFactor");
    if (averaged > 1 && counts.frames % averaged == 0) counts.frames /= averaged;
    counts.slices = std::max<std::int64_t>(
        number("hStackManager.actualNumSlices", number("hStackManager.numSlices")), 1);
    counts.volumes = std::max<std::int64_t>(number("hStackManager.numVolumes"), 1);
    if (value_of(lines, "hFastZ.enable") == "true") {
        const std::int64_t kept = number("hStackManager.numFramesPerVolume", 0),
                           all = number("hStackManager.numFramesPerVolumeWithFlyback", 0);
        counts.flyback =
            kept > 0 && all >= kept ? all - kept : number("hFastZ.numDiscardFlybackFrames", 0);
    }
    return counts;
}

/// Its frames of a slice follow each other, or its volumes do, with or without the frames between.
std::optional<CountedPages> told_by_scan_image(TIFF* tiff, const std::string& description,
                                               std::size_t planes,
                                               std::vector<std::string>& notes) {
    const char* software = nullptr;
    TIFFGetField(tiff, TIFFTAG_SOFTWARE, &software);
    const std::string lines = (software ? std::string(software) + '\n' : "") + description;
    const auto counts = scan_image_counts(lines);
    if (!counts) return {};
    auto [channels, frames, slices, flyback, volumes] = *counts;
    const auto all = static_cast<std::int64_t>(planes) / channels;
    CountedPages told{"ScanImage", "XYCZT", {all, channels, 1}};
    if (frames == 0) told.sizes = {1, channels, all};
    if (frames == 0 || all * channels != static_cast<std::int64_t>(planes)) return told;
    const bool lacks_slices = frames > 1 && slices == 1 && volumes == 1;
    // A scan that was ended early has fewer slices.
    if ((all < frames * slices || lacks_slices) && all % frames == 0) slices = all / frames;
    std::int64_t period = frames * slices + flyback;
    if (all % period != 0 || all == volumes * frames * slices) period = frames * slices;
    if ((frames == 1 && slices == 1 && all > 1) || all % period != 0) {
        notes.emplace_back(
            "ScanImage does not say whether its pages are slices or times: they were taken as "
            "slices");
        return told;
    }
    told.sizes = {slices, channels, all / period * frames};
    for (std::int64_t t = 0; t < told.sizes[2]; ++t) {
        for (std::int64_t z = 0; z < slices; ++z) {
            for (std::int64_t c = 0; c < channels; ++c) {
                const std::int64_t page = t / frames * period + z * frames + t % frames;
                told.planes.push_back(static_cast<std::size_t>(page * channels + c));
            }
        }
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

double image_j_planes(const std::string& text) {
    return count_in(fields_of(text), "images");
}

void set_image_j_spacing(OmeImage& image, TIFF* tiff, const std::string& text) {
    const Description description = fields_of(text);
    if (description.empty()) return;
    const std::array units = {unit_in(description, "unit"), unit_in(description, "yunit"),
                              unit_in(description, "zunit")};
    Vec3 spacings(0, 0, slice_distance(description));
    if (description.contains("SCIFIO")) {  // its resolution is that of ResolutionUnit
        spacings[0] = number_in(description, "xscale").value_or(0);
        spacings[1] = number_in(description, "yscale").value_or(0);
    } else {
        spacings[0] = 1 / resolution_of(tiff, TIFFTAG_XRESOLUTION, units[0]);
        spacings[1] = 1 / resolution_of(tiff, TIFFTAG_YRESOLUTION, units[1]);
    }
    set_spacing(image, spacings, units, "its description");
}

ValueMap image_j_values(const std::string& text, Stored stored, std::vector<std::string>& notes) {
    constexpr double straight_line = 0, none = 20;  // ij.measure.Calibration
    const Description description = fields_of(text);
    const auto function = number_in(description, "cf");
    if (!function || *function == none) return {};
    ValueMap values{number_in(description, "c1").value_or(0),
                    number_in(description, "c0").value_or(0)};
    // ImageJ adds 32768 to signed numbers, and its calibration is that of the sums.
    if (stored == Stored::int16) values.intercept += 32768 * values.slope;
    if (*function == straight_line && !is_real(stored) && std::isfinite(values.slope) &&
        values.slope != 0 && std::isfinite(values.intercept)) {
        return values;
    }
    notes.emplace_back("ImageJ's calibration of its values (cf=" + text_of(*function) +
                       ") was ignored: the samples are as they are stored");
    return {};
}

void write_image_j_spacing(TIFF* tiff, const Vec3& spacing, int slices) {
    std::string text = "ImageJ=1.54f\nimages=" + std::to_string(slices) +
                       "\nslices=" + std::to_string(slices) + "\nunit=mm\nspacing=";
    append_number(text, spacing.z());
    text += "\nloop=false\n";
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, text.c_str());
}

void set_resolution(TIFF* tiff, const Vec3& spacing) {
    TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_NONE);
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 1 / spacing.x());
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 1 / spacing.y());
}

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

CountedPages counted_pages(TIFF* tiff, const std::string& description, const TiffPage& first,
                           std::size_t planes, std::vector<std::string>& notes) {
    const nlohmann::json by_tifffile = told_by_tifffile(description);
    auto told = told_by_lsm(tiff);
    if (!told) told = told_by_scan_image(tiff, description, planes, notes);
    if (!told) {
        told = told_by_axes(by_tifffile, planes);
        check_shape(by_tifffile, first, planes, told.has_value(), notes);
    }
    if (told && told->planes.empty()) check_product(*told, planes);
    if (!told && planes > 1 && description.empty()) note_own_tags(tiff, notes);
    return told ? *told : told_by_image_j(description, planes, notes);
}

}  // namespace palpate::io
