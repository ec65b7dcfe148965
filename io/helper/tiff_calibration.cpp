// ImageJ's description: lines of key=value after a first line ImageJ=VERSION. Lengths are in its
// unit; XResolution and YResolution are pixels a unit, whatever ResolutionUnit says.
#include "io/helper/tiff_calibration.hpp"

#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "io/number.hpp"

namespace palpate::io {
namespace {

using Description = std::map<std::string, std::string>;

Description description_of(TIFF* tiff) {
    const char* text = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) == 0 || text == nullptr) return {};
    std::istringstream lines(text);
    Description description;
    for (std::string line; std::getline(lines, line);) {
        const auto equals = line.find('=');
        if (equals == std::string::npos) continue;
        description.emplace(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
    }
    return description;
}

/// The distance between slices in ImageJ's unit. ImageJ leaves out a 1 where there are slices.
std::optional<double> slice_distance(const Description& description) {
    if (const auto spacing = description.find("spacing"); spacing != description.end()) {
        const auto distance = number_from<double>(spacing->second);
        return distance ? std::optional(std::abs(*distance)) : std::nullopt;
    }
    if (description.contains("slices")) return 1.0;
    return std::nullopt;
}

/// A count of the description; 1 if it does not say.
double count_in(const Description& description, const char* name) {
    const auto found = description.find(name);
    if (found == description.end()) return 1;
    return number_from<double>(found->second).value_or(1);
}

}  // namespace

Moments image_j_moments(TIFF* tiff, std::size_t pages, std::vector<std::string>& notes) {
    const Description description = description_of(tiff);
    if (!description.contains("ImageJ")) return {};
    if (const double channels = count_in(description, "channels"); channels > 1) {
        throw Failure("holds " + text_of(channels) +
                      " channels slice by slice; save one of them (ImageJ: Image > Duplicate)");
    }
    const double images = count_in(description, "images");
    if (images > static_cast<double>(pages)) {
        throw Failure("tells of " + text_of(images) + " slices, but has " + std::to_string(pages) +
                      " as TIFF counts them; save it as BigTIFF (Bio-Formats) or as NRRD");
    }
    const double frames = count_in(description, "frames");
    if (!(frames > 1)) return {};
    const double slices = static_cast<double>(pages) / frames;
    if (slices != std::floor(slices)) {
        throw Failure("tells of " + text_of(frames) + " times, but has " + std::to_string(pages) +
                      " pages; save it again");
    }
    Moments moments{static_cast<std::int64_t>(frames), {}};
    if (const auto interval = description.find("finterval"); interval != description.end()) {
        const auto unit = description.find("tunit");
        moments.times = frame_times(number_from<double>(interval->second).value_or(0), 0,
                                    unit == description.end() ? "s" : unit->second, notes);
    }
    return moments;
}

std::optional<Vec3> image_j_spacing(TIFF* tiff) {
    const Description description = description_of(tiff);
    const auto unit = description.find("unit");
    if (!description.contains("ImageJ") || unit == description.end()) return std::nullopt;
    const auto length = millimetres_of(unit->second);
    const auto distance = slice_distance(description);
    float x = 0, y = 0;
    TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x);
    TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y);
    if (!length || !distance || !(x > 0) || !(y > 0)) return std::nullopt;
    const Vec3 spacing = *length * Vec3(1.0 / double(x), 1.0 / double(y), *distance);
    if (!spacing.allFinite() || !(spacing.minCoeff() > 0)) return std::nullopt;
    return spacing;
}

void set_image_j_spacing(TIFF* tiff, const Vec3& spacing, int slices) {
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
