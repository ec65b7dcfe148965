// ImageJ's description: lines of key=value after a first line ImageJ=VERSION. Lengths are in its
// unit. XResolution and YResolution are pixels per unit, whatever ResolutionUnit says. ImageJ2
// writes SCIFIO=VERSION, and lists of axes with their lengths, scales and units.
#include "io/helper/tiff_calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "io/system/number.hpp"
#include "io/units.hpp"

namespace palpate::io {
namespace {

using Description = std::map<std::string, std::string>;

/// The parts of a list such as "X,Y,Z".
std::vector<std::string> listed(const Description& description, const char* name) {
    std::vector<std::string> parts;
    const auto found = description.find(name);
    std::istringstream text(found == description.end() ? "" : found->second);
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

/// A number of the description; nothing if it has none of that name.
std::optional<double> number_in(const Description& description, const char* name) {
    const auto found = description.find(name);
    if (found == description.end()) return std::nullopt;
    return number_from<double>(found->second);
}

/// The distance between slices in ImageJ's unit; NaN where it gives none. ImageJ leaves out a 1
/// where there are slices.
double slice_distance(const Description& description) {
    if (description.contains("spacing")) {
        return std::abs(number_in(description, "spacing").value_or(std::nan("")));
    }
    return description.contains("slices") ? 1 : std::nan("");
}

/// A count of the description; 1 if it does not say.
double count_in(const Description& description, const char* name) {
    return number_in(description, name).value_or(1);
}

/// The unit of an axis: its own, or that of all.
std::string unit_in(const Description& description, const char* own) {
    const auto found = description.find(description.contains(own) ? own : "unit");
    return found == description.end() ? "" : found->second;
}

/// ImageJ leaves out a resolution of 1 pixel.
double resolution_of(TIFF* tiff, std::uint32_t tag, const std::string& unit) {
    float resolution = 0;
    const bool given = TIFFGetField(tiff, tag, &resolution) != 0;
    return given || millimetres_in(unit) ? double(resolution) : 1;
}

}  // namespace

double image_j_planes(const std::string& text) {
    return count_in(fields_of(text), "images");
}

Moments image_j_moments(const std::string& text, std::size_t pages,
                        std::vector<std::string>& notes) {
    const Description description = fields_of(text);
    if (description.empty()) return {};
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
    const double frames = std::max(count_in(description, "frames"), 1.0);
    const double slices = static_cast<double>(pages) / frames / channels;
    if (slices != std::floor(slices) || channels != std::floor(channels)) {
        throw Failure("tells of " + (channels > 1 ? text_of(channels) + " channels and " : "") +
                      text_of(frames) + " times, but has " + std::to_string(pages) +
                      " pages; save it again");
    }
    Moments moments;
    moments.count = static_cast<std::int64_t>(frames);
    moments.channels = static_cast<std::int64_t>(channels);
    // Of Micro-Manager. ImageJ knows no other order.
    if (const auto order = description.find("order"); order != description.end()) {
        if (lower(order->second) == "zct") moments.order = "XYZCT";
    }
    if (frames == 1) return moments;
    if (const auto interval = description.find("finterval"); interval != description.end()) {
        const auto unit = description.find("tunit");
        moments.times = frame_times(number_from<double>(interval->second).value_or(0), 0,
                                    unit == description.end() ? "s" : unit->second, notes);
    }
    return moments;
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

}  // namespace palpate::io
