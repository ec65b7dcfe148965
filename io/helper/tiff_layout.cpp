// The planes of a TIFF file by its descriptions. See the header.
#include "io/helper/tiff_layout.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "io/helper/tiff_calibration.hpp"
#include "io/helper/tiff_page.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

OmeImage told_by_ome(const std::string& description, const TiffPages& pages, const TiffPage& first,
                     std::vector<std::string>& notes) {
    OmeImage image = ome_image(description, notes);
    const auto [width, height] = image.plane_size;
    if ((width > 0 && width != first.width) || (height > 0 && height != first.height)) {
        notes.push_back("its OME-XML tells of planes of " + std::to_string(width) + "x" +
                        std::to_string(height) + ", its pages are " + text_of(first) +
                        ": the pages were taken");
    }
    const std::size_t known = pages.whole.size() + pages.reduced.size();
    for (const std::uint32_t page : image.pages) {
        if (page < known) continue;
        throw Failure("its OME-XML tells of page " + std::to_string(page) + ", but it has " +
                      std::to_string(known) + "; it is cut off: copy it again");
    }
    if (image.pages.size() < pages.whole.size()) {
        notes.push_back("its OME-XML tells of " + std::to_string(image.pages.size()) + " of its " +
                        std::to_string(pages.whole.size()) + " pages: the others were ignored");
    }
    return image;
}

/// tifffile's description, such as {"shape": [5, 7, 8], "axes": "ZYX"}; null if it is another one.
nlohmann::json told_by_tifffile(const std::string& description) {
    nlohmann::json told = nlohmann::json::parse(description, nullptr, false);
    if (!told.is_object() || !told.contains("shape") || !told["shape"].is_array()) return nullptr;
    const auto is_size = [](const nlohmann::json& size) { return size.is_number_unsigned(); };
    return std::ranges::all_of(told["shape"], is_size) ? told : nullptr;
}

double samples_in(const nlohmann::json& told) {
    if (told.is_null()) return 0;
    double samples = 1;
    for (const nlohmann::json& size : told["shape"]) samples *= size.get<double>();
    return samples;
}

/// Of a file of one page, tifffile's shape may be the only word of the rest.
void check_shape(const nlohmann::json& told, const TiffPage& page, std::size_t pages,
                 std::vector<std::string>& notes) {
    if (told.is_null()) return;
    std::string text;
    int axes = 0;
    for (const nlohmann::json& size : told["shape"]) {
        text += (text.empty() ? "" : "x") + std::to_string(size.get<std::uint64_t>());
        axes += size.get<std::uint64_t>() > 1 ? 1 : 0;
    }
    if (samples_in(told) > static_cast<double>(pages) * page.width * page.height) {
        throw Failure("its description gives it the shape " + text.substr(0, 60) + ", but it has " +
                      std::to_string(pages) +
                      " pages as TIFF counts them; save each slice as a page");
    }
    const nlohmann::json names = told.value("axes", nlohmann::json());  // such as "TYX"
    const bool has_others =
        names.is_string() && names.get<std::string>().find_first_of("TC") != std::string::npos;
    if (axes > 3 || (axes > 2 && has_others)) {
        notes.push_back("its description gives it the shape " + text.substr(0, 60) +
                        (has_others ? " of axes " + names.get<std::string>().substr(0, 20) : "") +
                        ": all its pages were taken as slices");
    }
}

/// ImageJ above 4 GB, and tifffile if asked to, write the planes one behind the other, of which a
/// page tells only the first. Returns how many there are; 1 if the only page is of another kind.
std::size_t planes_behind(TIFF* tiff, const fs::path& file, const TiffPage& page, double told) {
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    if (compression != COMPRESSION_NONE || TIFFIsTiled(tiff) != 0 || page.is_packed()) return 1;
    std::uint64_t end = TIFFGetStrileOffset(tiff, 0);
    const auto begin = static_cast<double>(end),
               directory = static_cast<double>(TIFFCurrentDirOffset(tiff));
    const double bytes =
        told * page.width * page.height * static_cast<double>(size_of(page.stored));
    if (begin < directory && directory < begin + bytes) return 1;  // it is no plane
    const bool is_there = begin + bytes <= static_cast<double>(fs::file_size(file));
    if (!(told > 1 && told <= 1 << 20 && told == std::floor(told) && is_there)) return 1;
    for (std::uint32_t strip = 0; strip < TIFFNumberOfStrips(tiff); ++strip) {
        if (TIFFGetStrileOffset(tiff, strip) != end) return 1;
        end += TIFFGetStrileByteCount(tiff, strip);
    }
    return static_cast<std::size_t>(told);
}

/// ImageJ's channels are the pages of a slice.
void take_channels(const Moments& moments, OmeImage& image) {
    const auto pages = static_cast<std::int64_t>(image.pages.size());
    image.sizes = {pages / (moments.count * moments.channels), moments.channels, moments.count};
    if (moments.channels == 1) return;
    const std::vector<std::uint32_t> in_file = image.pages;
    for (std::int64_t i = 0; i < pages; ++i) {
        const std::int64_t slice = i / moments.channels, channel = i % moments.channels;
        const std::int64_t z = slice % image.sizes[0], time = slice / image.sizes[0];
        image.pages[image.plane(z, channel, time)] = in_file[static_cast<std::size_t>(i)];
    }
    for (std::int64_t c = 0; c < moments.channels; ++c) {
        image.channels.push_back("channel " + std::to_string(c));
    }
}

}  // namespace

std::string description_of(TIFF* tiff) {
    const char* text = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) == 0 || !text) return "";
    return text;
}

std::vector<std::uint64_t> coarser_levels(TIFF* tiff) {
    std::uint16_t count = 0;
    const std::uint64_t* offsets = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_SUBIFD, &count, &offsets) == 0 || !offsets) return {};
    return {offsets, offsets + std::min<std::size_t>(count, most_tiff_levels)};
}

TiffPages pages_of(TIFF* tiff, const fs::path& file) {
    constexpr std::uint32_t most = 1 << 20;
    TiffPages pages;
    for (std::uint32_t page = 0; page < most; ++page) {
        std::uint32_t kind = 0;
        TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind);
        if ((kind & FILETYPE_REDUCEDIMAGE) != 0) {
            pages.reduced.push_back(page);
        } else if ((kind & FILETYPE_MASK) == 0) {
            pages.whole.push_back(page);
        }
        pages.directories.push_back(TIFFCurrentDirOffset(tiff));
        if (!first_tiff_error().empty()) fail_damaged_tiff(file);
        if (TIFFReadDirectory(tiff) == 0) break;
    }
    if (!first_tiff_error().empty() || pages.whole.empty()) fail_damaged_tiff(file);
    return pages;
}

TiffLayout layout_of(TIFF* tiff, const fs::path& file, std::vector<std::string>& notes) {
    const std::string description = description_of(tiff);
    TiffPages pages = pages_of(tiff, file);
    TIFFSetDirectory(tiff, 0);
    TiffLayout layout;
    layout.directories = std::move(pages.directories);
    std::vector<std::string> of_page;  // said again when it is read
    const TiffPage first = page_of(tiff, file, of_page);
    if (is_ome_xml(description)) {
        layout.image = told_by_ome(description, pages, first, notes);
        return layout;
    }
    OmeImage& image = layout.image;
    image.format = "TIFF";
    image.pages = pages.whole;
    const nlohmann::json by_tifffile = told_by_tifffile(description);
    if (pages.whole.size() == 1) {
        const double plane = static_cast<double>(first.width) * first.height;
        const double told = std::max(image_j_planes(description), samples_in(by_tifffile) / plane);
        image.pages.resize(planes_behind(tiff, file, first, told));
        if (image.pages.size() > 1) {
            std::iota(image.pages.begin(), image.pages.end(), 0U);
            layout.plain_from = TIFFGetStrileOffset(tiff, 0);
        }
    }
    check_shape(by_tifffile, first, image.pages.size(), notes);
    const Moments moments = image_j_moments(description, image.pages.size(), notes);
    layout.values = image_j_values(description, first.stored, notes);
    take_channels(moments, image);
    image.frame_interval = moments.times.interval;
    if (pages.whole.size() == 1 && coarser_levels(tiff).empty()) layout.reduced = pages.reduced;
    if (!set_image_j_spacing(image, tiff, description)) {
        image.spacing_note =
            "it does not tell its spacing (as ImageJ and OME-XML would): 1 mm was taken along "
            "every axis; give the spacing";
    }
    return layout;
}

}  // namespace palpate::io
