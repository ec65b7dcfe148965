// Tiled TIFF with levels of detail: OME-TIFF (https://docs.openmicroscopy.org/ome-model,
// "OME-TIFF"), whose planes have coarser ones in their SubIFDs, and other tiled files of one page
// for each slice.
#include <algorithm>
#include <bit>
#include <cstdio>

#include "io/helper/images.hpp"
#include "io/helper/tiff_layout.hpp"
#include "io/helper/tiff_page.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// Tiles of a page, and what unpacks them.
struct Tiling {
    TiffPage page;
    std::uint32_t tile_width = 0, tile_height = 0;
    std::vector<std::string> codecs;  ///< in the order of decoding
    bool operator==(const Tiling&) const = default;
};

std::vector<std::string> codecs_of(TIFF* tiff, Stored stored) {
    std::uint16_t compression = COMPRESSION_NONE, predictor = 1, order = FILLORDER_MSB2LSB;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_FILLORDER, &order);
    if (order != FILLORDER_MSB2LSB) {
        throw Failure("its bits are in reverse order, which is not read; save it again");
    }
    const char* name = nullptr;
    switch (compression) {
        case COMPRESSION_NONE:
            return {};
        case COMPRESSION_ADOBE_DEFLATE:
        case COMPRESSION_DEFLATE:
            name = "gzip";
            break;
        case COMPRESSION_LZW:
            name = "lzw";
            break;
        case COMPRESSION_ZSTD:
            name = "zstd";
            break;
        default:
            throw Failure("its compression (TIFF number " + std::to_string(compression) +
                          ") is not read by the tile; save it with deflate, LZW or zstd");
    }
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PREDICTOR, &predictor);
    if (predictor == PREDICTOR_NONE) return {name};
    if (predictor == PREDICTOR_HORIZONTAL) return {name, "difference"};
    if (predictor == PREDICTOR_FLOATINGPOINT && is_real(stored)) return {name, "float_difference"};
    throw Failure("its predictor " + std::to_string(predictor) +
                  " is not read by the tile; save it without or with the horizontal one");
}

Tiling tiling_of(TIFF* tiff, const fs::path& file, std::vector<std::string>& notes) {
    if (TIFFIsTiled(tiff) == 0) {
        throw Failure(
            "it has a page in strips; only tiled pages can be read while they are touched");
    }
    Tiling tiling;
    tiling.page = page_of(tiff, file, notes);
    if (tiling.page.is_packed()) {
        throw Failure("its samples of " + std::to_string(tiling.page.bits) +
                      " bits are not read by the tile; save it with 8 or 16 bits");
    }
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tiling.tile_width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tiling.tile_height);
    if (tiling.page.width == 0 || tiling.page.height == 0 || tiling.tile_width == 0 ||
        tiling.tile_height == 0) {
        fail_damaged_tiff(file);
    }
    tiling.codecs = codecs_of(tiff, tiling.page.stored);
    return tiling;
}

/// The one file that this process looks into: its directories are read once, not for each question.
struct Explored {
    explicit Explored(const fs::path& path)
        : tiff(open_to_read(path, "O")),  // O: offsets of tiles only when they are asked for
          layout(layout_of(tiff.get(), path, notes)) {}
    Tiff tiff;
    std::vector<std::string> notes;
    TiffLayout layout;
};

const Explored& explored(const fs::path& path) {
    static const Explored file(path);
    return file;
}

void go_to(TIFF* tiff, const fs::path& file, const TiffLayout& layout, std::uint32_t page,
           std::size_t level) {
    if (level > 0 && !layout.reduced.empty()) page = layout.reduced.at(level - 1);
    if (TIFFSetSubDirectory(tiff, layout.directories.at(page)) == 0) fail_damaged_tiff(file);
    if (level == 0 || !layout.reduced.empty()) return;
    const auto offsets = coarser_levels(tiff);
    if (level > offsets.size()) {
        throw Failure("its planes have different numbers of levels; save it again");
    }
    if (TIFFSetSubDirectory(tiff, offsets[level - 1]) == 0) fail_damaged_tiff(file);
}

std::string id_of(std::size_t level, int channel, int time) {
    return std::to_string(level) + " " + std::to_string(channel) + " " + std::to_string(time);
}

/// Coarser levels are planes of coarser pixels; a sample is the mean of whole ones.
ImageArray level_from(const Tiling& tiling, std::int64_t depth, bool swapped,
                      const ValueMap& values) {
    ImageArray array;
    array.shape = {depth, tiling.page.height, tiling.page.width};
    array.chunk = {1, tiling.tile_height, tiling.tile_width};
    array.stored = tiling.page.stored;
    array.swapped = swapped && size_of(array.stored) > 1;
    array.values = values;
    array.codecs = tiling.codecs;
    return array;
}

}  // namespace

ChunkedImage tiff_image(const fs::path& path, int channel, int time) {
    const auto& [tiff, notes, layout] = explored(path);
    ChunkedImage found;
    found.notes = notes;
    const OmeImage& image = layout.image;
    const std::string& note = image.note_on_spacing(image.sizes[0]);
    found.measured = note.empty();
    if (!found.measured) found.notes.push_back(note);
    found.format = image.format;
    found.unit = "millimeter";
    found.channels = image.channels;
    found.times = static_cast<int>(image.sizes[2]);
    found.frame_interval = image.frame_interval;
    if (channel >= image.sizes[1] || time >= image.sizes[2]) return found;
    const std::uint32_t first = image.pages.at(image.plane(0, channel, time));
    go_to(tiff.get(), path, layout, first, 0);
    const std::size_t levels =
        1 + (layout.reduced.empty() ? coarser_levels(tiff.get()).size() : layout.reduced.size());
    std::array<double, 3> factor = {1, 1, 1};
    for (std::size_t l = 0; l < std::min(levels, most_tiff_levels); ++l) {
        go_to(tiff.get(), path, layout, first, l);
        const Tiling tiling = tiling_of(tiff.get(), path, found.notes);
        ImageArray level =
            level_from(tiling, image.sizes[0], TIFFIsByteSwapped(tiff.get()) != 0, layout.values);
        level.id = id_of(l, channel, time);
        for (std::size_t a = 0; a < 3; ++a) {
            if (l > 0) factor[a] *= factor_between(found.levels.back().shape[a], level.shape[a]);
        }
        place(level, image.spacing, {0, 0, 0}, factor);
        found.levels.push_back(level);
    }
    return found;
}

void tiff_places(const fs::path& path, const ChunkBox& box, std::span<ChunkPlace> places) {
    std::size_t level = 0;
    int channel = 0, time = 0;
    if (std::sscanf(box.array.c_str(), "%zu %d %d", &level, &channel, &time) != 3) {
        throw Failure("got a request for an unknown image");
    }
    const Explored& file = explored(path);
    const Tiff& tiff = file.tiff;
    const TiffLayout& layout = file.layout;
    std::vector<std::string> notes;
    const auto page_at = [&](std::int64_t z) {
        return layout.image.pages.at(layout.image.plane(z, channel, time));
    };
    go_to(tiff.get(), path, layout, page_at(0), level);
    const Tiling usual = tiling_of(tiff.get(), path, notes);
    std::size_t at = 0;
    for (std::int64_t z = box.first[0]; z < box.first[0] + box.count[0]; ++z) {
        go_to(tiff.get(), path, layout, page_at(z), level);
        if (!(tiling_of(tiff.get(), path, notes) == usual)) {
            throw Failure(
                "its plane " + std::to_string(z) +
                " has another size, Orientation or compression than the first; save it again");
        }
        for (std::int64_t y = box.first[1]; y < box.first[1] + box.count[1]; ++y) {
            for (std::int64_t x = box.first[2]; x < box.first[2] + box.count[2]; ++x, ++at) {
                const std::uint32_t tile =
                    TIFFComputeTile(tiff.get(), static_cast<std::uint32_t>(x) * usual.tile_width,
                                    static_cast<std::uint32_t>(y) * usual.tile_height, 0, 0);
                places[at] = {TIFFGetStrileOffset(tiff.get(), tile),
                              TIFFGetStrileByteCount(tiff.get(), tile), 0};
            }
        }
        if (!first_tiff_error().empty()) fail_damaged_tiff(path);
    }
}

}  // namespace palpate::io
