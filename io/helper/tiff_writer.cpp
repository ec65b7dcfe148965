// Writes TIFF stacks with libtiff: a page a slice, grey, the spacing as ImageJ writes it.
#include <algorithm>
#include <type_traits>

#include "io/helper/readers.hpp"
#include "io/helper/tiff_descriptions.hpp"

namespace palpate::io {
namespace {

int format_of(SampleType type) {
    return with_type(type, [](auto zero) {
        using T = decltype(zero);
        return std::is_floating_point_v<T> ? SAMPLEFORMAT_IEEEFP
               : std::is_signed_v<T>       ? SAMPLEFORMAT_INT
                                           : SAMPLEFORMAT_UINT;
    });
}

[[noreturn]] void fail_unfinished() {
    throw Failure(not_written_whole);
}

/// Rows of some 256 KB: large enough to be packed well, small enough to be read piece by piece.
std::uint32_t rows_per_strip(std::uint32_t height, std::size_t row_bytes) {
    const std::size_t rows = std::max<std::size_t>(1, (256 << 10) / row_bytes);
    return static_cast<std::uint32_t>(std::min<std::size_t>(height, rows));
}

void write_page(TIFF* tiff, const Geometry& geometry, SampleType type, int z, bool compress,
                std::byte* samples) {
    const auto width = static_cast<std::uint32_t>(geometry.size.x());
    const auto height = static_cast<std::uint32_t>(geometry.size.y());
    const std::size_t row = width * size_of(type);
    const std::uint32_t rows = rows_per_strip(height, row);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * size_of(type)));
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, format_of(type));
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION,
                 compress ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_NONE);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, rows);
    // Without it ImageJ takes the samples of all pages as one piece after the first page's.
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    set_resolution(tiff, geometry.spacing);
    if (z == 0) write_image_j_spacing(tiff, geometry.spacing, geometry.size.z());
    for (std::uint32_t strip = 0, y = 0; y < height; ++strip, y += rows) {
        const auto bytes = static_cast<tmsize_t>(std::min(rows, height - y) * row);
        if (TIFFWriteEncodedStrip(tiff, strip, samples + y * row, bytes) != bytes) {
            fail_unfinished();
        }
    }
    if (TIFFWriteDirectory(tiff) == 0) fail_unfinished();
}

}  // namespace

void write_tiff(const std::filesystem::path& path, const WrittenVolume& volume) {
    const Index3& size = volume.geometry.size;
    const std::size_t page = static_cast<std::size_t>(size.x()) *
                             static_cast<std::size_t>(size.y()) * size_of(volume.type);
    const auto pages = static_cast<std::size_t>(size.z());
    // Classic TIFF points to 4 GB; some of them are for its directories and for what does not pack.
    const bool big = pages * (page + 4096) > 0xF0000000;
    // tifffile takes samples that fit before the second page's directory for one piece.
    const bool tiny = pages * page < 4096;
    Tiff tiff = open_tiff(path, big ? "w8" : "w");
    if (!tiff) fail_unfinished();
    std::vector<std::byte> slice(page);  // libtiff may turn what it is given
    for (std::size_t z = 0; z < pages; ++z) {
        const auto* const from = static_cast<const std::byte*>(volume.samples) + z * page;
        std::copy_n(from, page, slice.begin());
        write_page(tiff.get(), volume.geometry, volume.type, static_cast<int>(z),
                   volume.compress || tiny, slice.data());
        say_progress(static_cast<double>(z + 1) / static_cast<double>(pages));
    }
    tiff.reset();  // writes what is left
    if (!first_tiff_error().empty()) fail_unfinished();
}

}  // namespace palpate::io
