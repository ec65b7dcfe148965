// Reads TIFF stacks with libtiff: one file of many pages, or a folder of numbered slices. ITK's
// reader accepts a cut-off file as complete; libtiff reports it.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>

#include "io/byte_order.hpp"
#include "io/helper/numbered_names.hpp"
#include "io/helper/readers.hpp"
#include "io/helper/tiff_layout.hpp"
#include "io/helper/tiff_page.hpp"
#include "io/inflate.hpp"
#include "io/tiff_peek.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// libtiff stops when it has enough bytes, before zlib's checksum; this reads on to it.
void check_deflate(TIFF* tiff, const fs::path& file, std::uint32_t piece, bool tiled) {
    std::uint16_t compression = 0;
    TIFFGetField(tiff, TIFFTAG_COMPRESSION, &compression);
    if (compression != COMPRESSION_ADOBE_DEFLATE && compression != COMPRESSION_DEFLATE) return;
    const std::uint64_t bytes = TIFFGetStrileByteCount(tiff, piece);
    if (bytes > fs::file_size(file)) fail_damaged_tiff(file);
    std::vector<std::byte> raw(bytes);
    const auto size = static_cast<tmsize_t>(bytes);
    const tmsize_t got = tiled ? TIFFReadRawTile(tiff, piece, raw.data(), size)
                               : TIFFReadRawStrip(tiff, piece, raw.data(), size);
    if (got != size) fail_damaged_tiff(file);
    std::uint16_t order = FILLORDER_MSB2LSB;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_FILLORDER, &order);
    if (order == FILLORDER_LSB2MSB) {
        TIFFReverseBits(reinterpret_cast<std::uint8_t*>(raw.data()), size);
    }
    try {
        const auto most =
            static_cast<std::uint64_t>(tiled ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff));
        inflate_checked(raw, most + std::min<std::uint64_t>(4096, most - 1));
    } catch (const DamagedStream& e) {
        throw Failure(quoted(file) + ": " + e.what() + "; copy it again");
    }
}

/// Refuses pieces without compression that have twice the bytes of the page, or more: its samples
/// are wider, or more, than the header says.
void check_surplus(TIFF* tiff, const fs::path& file, const TiffPage& page) {
    constexpr std::uint64_t padding_allowed = 4096;
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    if (compression != COMPRESSION_NONE) return;
    const bool tiled = TIFFIsTiled(tiff) != 0;
    const std::uint32_t pieces = tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
    const std::uint64_t need = tiled ? pieces * std::uint64_t{TIFFTileSize64(tiff)}
                                     : page.height * std::uint64_t{page.bytes_of(page.width)};
    std::uint64_t have = 0;
    for (std::uint32_t i = 0; i < pieces; ++i) have += TIFFGetStrileByteCount(tiff, i);
    if (have < 2 * need || have - need < padding_allowed) return;
    throw Failure(quoted(file) + " has a page of " + std::to_string(have) +
                  " bytes, and its header tells of " + std::to_string(need) +
                  "; correct its size or BitsPerSample, or export it again");
}

/// Some writers store no tiles or strips that have nothing but zeros: they lie nowhere.
bool is_left_out(TIFF* tiff, std::uint32_t piece) {
    return TIFFGetStrileOffset(tiff, piece) == 0 && TIFFGetStrileByteCount(tiff, piece) == 0;
}

/// Strips are tiles as wide as the page, the last of which has the rows that are left.
void read_pieces(TIFF* tiff, const fs::path& file, const TiffPage& page, std::byte* to,
                 const Request& request, std::vector<std::string>& notes) {
    const bool tiled = TIFFIsTiled(tiff) != 0;
    std::uint32_t width = page.width, height = page.height;
    if (tiled) {
        TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
        TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
    } else {
        TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &height);
        height = std::clamp<std::uint32_t>(height, 1, page.height);
    }
    check_surplus(tiff, file, page);
    const std::int64_t sizes[] = {width, height};
    std::vector<std::byte> piece(checked_bytes(sizes, size_of(page.stored), UINT64_MAX, request));
    const std::size_t row = page.bytes_of(page.width), piece_row = page.bytes_of(width);
    if (tiled && TIFFTileSize(tiff) != static_cast<tmsize_t>(height * piece_row)) {
        fail_damaged_tiff(file);
    }
    for (std::uint32_t y = 0; y < page.height; y += height) {
        const std::uint32_t rows = std::min(height, page.height - y);
        for (std::uint32_t x = 0; x < page.width; x += width) {
            const std::uint32_t number = tiled ? TIFFComputeTile(tiff, x, y, 0, 0) : y / height;
            const auto bytes = static_cast<tmsize_t>((tiled ? height : rows) * piece_row);
            const auto read = tiled ? TIFFReadEncodedTile : TIFFReadEncodedStrip;
            if (is_left_out(tiff, number)) {
                std::ranges::fill(piece, std::byte{0});
                add_note(notes, "some parts of its pages are not stored: their samples are 0");
            } else {
                check_deflate(tiff, file, number, tiled);
                if (read(tiff, number, piece.data(), bytes) != bytes) fail_damaged_tiff(file);
            }
            const std::size_t columns = std::min(width, page.width - x);
            for (std::uint32_t r = 0; r < rows; ++r) {
                std::memcpy(to + (y + r) * row + std::size_t{x} * page.bits / 8,
                            piece.data() + r * piece_row, page.bytes_of(columns));
            }
        }
    }
}

/// Gives each sample bytes of its own. They lie bit behind bit, the highest first, whatever the
/// order of bytes.
void unpack_bits(const TiffPage& page, std::vector<std::byte>& samples) {
    const std::vector<std::byte> packed = samples;
    for (std::size_t i = 0; i < std::size_t{page.width} * page.height; ++i) {
        const std::byte* const row = packed.data() + i / page.width * page.bytes_of(page.width);
        unsigned value = 0;
        for (std::size_t bit = i % page.width * page.bits, end = bit + page.bits; bit < end;
             ++bit) {
            value = value << 1 | (std::to_integer<unsigned>(row[bit / 8]) >> (7 - bit % 8) & 1);
        }
        const auto sample = static_cast<std::uint16_t>(value);
        if (size_of(page.stored) == 1) {
            samples[i] = static_cast<std::byte>(sample);
        } else {
            std::memcpy(samples.data() + 2 * i, &sample, 2);
        }
    }
}

/// Planes without a page of their own (TiffLayout::plain_from).
void read_plain(TIFF* tiff, const fs::path& file, std::uint64_t from, std::size_t each,
                std::span<std::byte> to) {
    std::ifstream in(file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(from));
    in.read(reinterpret_cast<char*>(to.data()), std::ssize(to));
    if (!in) fail_damaged_tiff(file);
    if (TIFFIsByteSwapped(tiff) != 0) swap_bytes(to, each);
}

/// One page of one file, or one plane.
struct Slice {
    fs::path file;
    std::uint32_t page = 0;
};

void go_to_slice(TIFF* tiff, const Slice& slice) {
    const std::uint32_t now = TIFFCurrentDirectory(tiff);
    // libtiff looks for a page from the first one on, unless it is the next one.
    const bool there =
        slice.page == now ||
        (slice.page == now + 1 ? TIFFReadDirectory(tiff) : TIFFSetDirectory(tiff, slice.page));
    if (!there) fail_damaged_tiff(slice.file);
}

/// Notes the first file for which libtiff guessed.
void note_guess(const fs::path& file, std::vector<std::string>& notes) {
    const std::string what =
        " does not say, or says wrongly, how long the samples of a page are (StripByteCounts): as "
        "many as the page has were taken from where they begin, do not trust the surface there";
    const auto is_said = [&](const std::string& note) { return note.ends_with(what); };
    if (!guessed_tiff_lengths() || std::ranges::any_of(notes, is_said)) return;
    notes.push_back(quoted(file) + what);
}

/// `layout`: what the file, or the first of a folder, says of spacing and values.
Result read_slices(const std::vector<Slice>& slices, const TiffLayout& layout,
                   const Request& request) {
    Result result;
    TiffPage first;
    std::span<std::byte> samples;
    std::vector<std::byte> page_samples;
    Tiff tiff(nullptr, &TIFFClose);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        const Slice& slice = slices[i];
        say_doing(slice.file.filename().string());
        // c: strips as long as they are stored, not cut by libtiff, which forgets their lengths.
        if (i == 0 || slice.file != slices[i - 1].file) tiff = open_to_read(slice.file, "c");
        if (layout.plain_from == 0) go_to_slice(tiff.get(), slice);
        const TiffPage page = page_of(tiff.get(), slice.file, result.notes);
        if (i == 0) {
            first = page;
            const std::int64_t sizes[] = {page.width, page.height,
                                          static_cast<std::int64_t>(slices.size())};
            const std::int64_t plane[] = {page.width, page.height};
            const auto file_bytes = fs::file_size(slice.file);
            bound_memory(4 * file_bytes +
                         4 * checked_bytes(plane, size_of(page.stored), file_bytes, request));
            result.type = kept_as(page.stored, layout.values);
            samples =
                shared_samples(checked_bytes(sizes, size_of(result.type), UINT64_MAX, request));
            page_samples.resize(std::size_t{page.width} * page.height * size_of(page.stored));
        }
        note_guess(slice.file, result.notes);
        if (!(page == first)) {
            throw Failure("its slice " + std::to_string(i) + " is " + text_of(page) +
                          ", the first " + text_of(first) + "; put slices of one kind together");
        }
        if (layout.plain_from > 0) {
            read_plain(tiff.get(), slice.file, layout.plain_from + slice.page * page_samples.size(),
                       size_of(page.stored), page_samples);
        } else {
            read_pieces(tiff.get(), slice.file, page, page_samples.data(), request, result.notes);
        }
        if (!first_tiff_error().empty()) fail_damaged_tiff(slice.file);
        if (page.is_packed()) unpack_bits(page, page_samples);
        const std::size_t count = std::size_t{page.width} * page.height;
        convert(page.stored, page_samples.data(), result.type,
                samples.data() + i * count * size_of(result.type), count, layout.values);
        say_progress(static_cast<double>(i + 1) / static_cast<double>(slices.size()));
    }
    note_conversion(first.stored, layout.values, result.notes);
    result.geometry.size = {static_cast<int>(first.width), static_cast<int>(first.height),
                            static_cast<int>(slices.size())};
    const auto& spacing = layout.image.spacing;
    result.geometry.spacing = {spacing[2], spacing[1], spacing[0]};
    const std::string& note = layout.image.note_on_spacing(std::ssize(slices));
    if (!request.grid.spacing && !note.empty()) result.notes.push_back(note);
    result.geometry.oriented = false;
    result.geometry.measured = note.empty();
    finish(result, request, samples);
    return result;
}

/// Pages far more in number than they are wide may be moments of one slice.
void note_stick(Result& result) {
    const Index3& size = result.geometry.size;
    if (size[2] <= 8 * std::max(size[0], size[1])) return;
    result.notes.push_back("its " + std::to_string(size[2]) + " pages of " +
                           std::to_string(size[0]) + "x" + std::to_string(size[1]) +
                           " were taken as slices; if they are moments, say so in the file "
                           "(ImageJ: Image > Properties, frames) and it is a sequence");
}

/// Spacing and values of a file in a folder. The names of the files give the order.
TiffLayout layout_in_folder(TIFF* tiff, const fs::path& file, std::vector<std::string>& notes) {
    if (!is_ome_xml(description_of(tiff))) {
        TiffLayout layout = layout_of(tiff, file, notes);
        if (layout.plain_from == 0) return layout;
        throw Failure(quoted(file) + " is a stack in a folder of slices; give that file alone");
    }
    notes.emplace_back(
        "the OME-XML of its files was not used: they were put together by the numbers in their "
        "names");
    TiffLayout layout;
    layout.image.spacing_note =
        "without the OME-XML, 1 mm was taken along every axis; give the spacing";
    return layout;
}

/// One spacing and one meaning of the samples hold for the whole stack.
void check_alike(const TiffLayout& first, const TiffLayout& one, const fs::path& file,
                 const Request& request) {
    constexpr double rounding = 1e-3;
    if (one.values.slope != first.values.slope || one.values.intercept != first.values.intercept) {
        throw Failure(quoted(file) +
                      " has another calibration of its values (c0, c1) than the first "
                      "slice; save all slices with one calibration, or without any");
    }
    const bool are_known = one.image.spacing_note.empty() && first.image.spacing_note.empty();
    if (!are_known || request.grid.spacing) return;
    const auto &a = first.image.spacing, &b = one.image.spacing;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::abs(b[axis] - a[axis]) <= rounding * a[axis]) continue;
        throw Failure(quoted(file) + " has a spacing of " + text_of(b[axis]) + " mm along " +
                      "zyx"[axis] + ", the first slice of " + text_of(a[axis]) +
                      " mm; give the spacing (--spacing) if it is the same for all");
    }
}

Result read_file(const Request& request) {
    std::vector<std::string> notes;
    const TiffLayout layout = layout_of(open_to_read(request.path).get(), request.path, notes);
    const OmeImage& image = layout.image;
    const int step = checked_time_step(request, image.sizes[2]);
    std::vector<Slice> slices;
    for (std::int64_t z = 0; z < image.sizes[0]; ++z) {
        slices.push_back({request.path, image.pages.at(image.plane(z, 0, step))});
    }
    if (image.sizes[1] > 1) {
        notes.push_back("channel 0 (" + image.channels.at(0).substr(0, 60) + ") of " +
                        std::to_string(image.sizes[1]) + " was taken");
    }
    Result result = read_slices(slices, layout, request);
    result.format = image.format;
    result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
    take_step(request, image.sizes[2], {image.frame_interval, 0}, result);
    note_stick(result);
    return result;
}

Result read_folder(const Request& request) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(request.path)) {
        if (!is_tiff_name(entry.path())) continue;
        if (is_dangling_link(entry)) {
            throw Failure(quoted(entry.path()) +
                          " is a link to a file that is not there; get that file (git-annex: git "
                          "annex get), or take the link away");
        }
        if (is_shown_file(entry)) files.push_back(entry.path());
    }
    const NumberedSlices numbered = numbered_slices(std::move(files));
    const auto times = static_cast<std::int64_t>(numbered.times.size());
    const int step = checked_time_step(request, times);
    std::vector<Slice> slices;
    std::vector<std::string> notes = numbered.notes;
    std::optional<TiffLayout> layout;  // of the first
    for (const fs::path& file : numbered.times[static_cast<std::size_t>(step)]) {
        const Tiff tiff = open_to_read(file);
        const TiffPages pages = pages_of(tiff.get(), file);
        if (pages.whole.size() != 1 && numbered.times[0].size() * numbered.times.size() > 1) {
            throw Failure(quoted(file) + " has " + std::to_string(pages.whole.size()) +
                          " pages in a folder of slices; give that file alone");
        }
        for (const std::uint32_t page : pages_of_first_series(pages)) {
            slices.push_back({file, page});
        }
        TIFFSetDirectory(tiff.get(), 0);
        std::vector<std::string> of_others;
        const TiffLayout one = layout_in_folder(tiff.get(), file, layout ? of_others : notes);
        if (layout) check_alike(*layout, one, file, request);
        if (!layout) layout = one;
    }
    Result result = read_slices(slices, *layout, request);
    result.format = "TIFF slices";
    result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
    take_step(request, times, {}, result);
    note_stick(result);
    return result;
}

}  // namespace

Result read_tiff(const Request& request) {
    return fs::is_directory(request.path) ? read_folder(request) : read_file(request);
}

}  // namespace palpate::io
