// The planes of a TIFF file by its descriptions. See the header.
#include "io/helper/tiff_layout.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <optional>

#include "io/helper/tiff_descriptions.hpp"
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
    if (!image.type.empty() && image.type != name_of(first.stored)) {
        notes.push_back("its OME-XML tells of samples of type " + image.type + ", its pages are " +
                        text_of(first) + ": the pages were taken");
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

/// The series of tifffile that begins at the current page, if one does. Only the beginning of a
/// description is parsed: there may be a million of them.
std::optional<TiffSeries> series_at(TIFF* tiff, std::size_t page) {
    constexpr std::size_t longest = 200;
    const std::string description = description_of(tiff);
    const std::size_t end = description.find(']');
    if (!description.starts_with("{\"shape\"") || end > longest) return {};
    const nlohmann::json told = told_by_tifffile(description.substr(0, end + 1) + "}");
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    if (told.is_null() || width == 0 || height == 0) return {};
    return TiffSeries{page, samples_in(told) / (static_cast<double>(width) * height),
                      shape_in(told)};
}

/// Whether another page follows the one at this offset. libtiff ends in silence where that is an
/// earlier one.
bool leads_on(const fs::path& file, std::uint64_t offset) {
    std::ifstream in(file, std::ios::binary);
    const auto number = [&](std::uint64_t at, std::size_t bytes, bool is_little) {
        unsigned char read[8] = {};
        in.seekg(static_cast<std::streamoff>(at));
        in.read(reinterpret_cast<char*>(read), static_cast<std::streamsize>(bytes));
        std::uint64_t value = 0;
        for (std::size_t i = 0; in && i < bytes; ++i) {
            value = value << 8 | read[is_little ? bytes - 1 - i : i];
        }
        return value;
    };
    const bool is_little = number(0, 1, true) == 'I';
    const bool is_big_tiff = number(2, 2, is_little) == 43;
    const std::size_t width = is_big_tiff ? 8 : 2, entry = is_big_tiff ? 20 : 12;
    const std::uint64_t entries = number(offset, width, is_little);
    return entries <= 65535 &&
           number(offset + width + entries * entry, is_big_tiff ? 8 : 4, is_little) != 0;
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
            const auto series = series_at(tiff, pages.whole.size());
            if (series) pages.series.push_back(*series);
            pages.whole.push_back(page);
        }
        pages.directories.push_back(TIFFCurrentDirOffset(tiff));
        if (!first_tiff_error().empty()) fail_damaged_tiff(file);
        if (TIFFReadDirectory(tiff) != 0) continue;
        pages.is_circle = leads_on(file, pages.directories.back());
        break;
    }
    if (!first_tiff_error().empty() || pages.whole.empty()) fail_damaged_tiff(file);
    return pages;
}

std::vector<std::uint32_t> pages_of_first_series(const TiffPages& pages) {
    const auto& series = pages.series;
    const auto is_page = [](const TiffSeries& one) { return one.planes <= 1; };
    if (series.size() < 2 || series[0].first != 0 || std::ranges::all_of(series, is_page)) {
        return pages.whole;
    }
    return {pages.whole.begin(), pages.whole.begin() + std::ptrdiff_t(series[1].first)};
}

TiffLayout layout_of(TIFF* tiff, const fs::path& file, std::vector<std::string>& notes) {
    const std::string description = description_of(tiff);
    TiffPages pages = pages_of(tiff, file);
    TIFFSetDirectory(tiff, 0);
    if (pages.is_circle) {
        notes.push_back("its pages lead in a circle: the " +
                        std::to_string(pages.directories.size()) +
                        " before the first one again were taken, and others may be missing");
    }
    TiffLayout layout;
    layout.directories = std::move(pages.directories);
    std::vector<std::string> of_page;  // said again when it is read
    const TiffPage first = page_of(tiff, file, of_page);
    if (is_ome_xml(description)) {
        layout.image = told_by_ome(description, pages, first, notes);
        return layout;
    }
    OmeImage& image = layout.image;
    image.pages = pages_of_first_series(pages);
    if (image.pages.size() < pages.whole.size()) {
        notes.push_back("the first of its " + std::to_string(pages.series.size()) +
                        " series of images was taken, of the shape " + pages.series[0].shape +
                        " (the second one: " + pages.series[1].shape +
                        "); save another one in a file of its own to read it");
    }
    if (pages.whole.size() == 1) {
        const double plane = static_cast<double>(first.width) * first.height;
        const double told = std::max(image_j_planes(description),
                                     samples_in(told_by_tifffile(description)) / plane);
        image.pages.resize(planes_behind(tiff, file, first, told));
        if (image.pages.size() > 1) {
            std::iota(image.pages.begin(), image.pages.end(), 0U);
            layout.plain_from = TIFFGetStrileOffset(tiff, 0);
        }
    }
    image.spacing_note =
        "it does not tell its spacing (as ImageJ and OME-XML would): 1 mm was taken along every "
        "axis; give the spacing";
    take_counts(image, counted_pages(tiff, description, first, image.pages.size(), notes));
    layout.values = image_j_values(description, first.stored, notes);
    set_image_j_spacing(image, tiff, description);
    if (pages.whole.size() == 1 && coarser_levels(tiff).empty()) layout.reduced = pages.reduced;
    return layout;
}

}  // namespace palpate::io
