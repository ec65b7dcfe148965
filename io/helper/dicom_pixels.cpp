// Checks of pixel data (PS3.5 chapter 8, annex A.4). See the header.
#include "io/helper/dicom_pixels.hpp"

#include <zlib.h>

#include <algorithm>
#include <new>
#include <utility>

#include "io/helper/code_stream.hpp"

namespace palpate::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
    throw Failure(quoted(file) + " " + what + "; it is damaged: copy or export it again");
}

[[noreturn]] void fail_size(const std::filesystem::path& file, std::uint64_t bytes,
                            std::uint64_t needed) {
    fail(file, "has " + std::to_string(bytes) + " bytes of samples, its header asks for " +
                   std::to_string(needed));
}

/// Frames without compression, each in a fragment of its own (PS3.5, A.4.11), and deflated ones.
constexpr const char *plain_in_fragments = "no compression", *deflated = "deflate";

/// Whether a decoder of images has to unpack the frames.
bool is_code_stream(const std::string& name) {
    return name != "RLE" && name != plain_in_fragments && name != deflated;
}

/// Empty for a syntax without fragments, or with a compression that we know nothing of.
std::string compression_of(const std::string& syntax) {
    const std::string family = "1.2.840.10008.1.2.";
    if (syntax.rfind(family, 0) != 0) return {};
    const std::string rest = syntax.substr(family.size());
    if (rest == "1.98") return plain_in_fragments;
    if (rest == "8.1") return deflated;
    if (rest == "5") return "RLE";
    if (rest == "4.80" || rest == "4.81") return "JPEG-LS";
    if (rest.rfind("4.9", 0) == 0 || rest.rfind("4.20", 0) == 0) return "JPEG 2000";
    if (rest.rfind("4.10", 0) == 0) return "video";
    if (rest.rfind("4.11", 0) == 0) return "JPEG XL";
    return rest.rfind("4.", 0) == 0 ? "JPEG" : "";
}

/// Samples are not in fragments.
bool is_plain_syntax(const std::string& syntax) {
    const std::string family = "1.2.840.10008.1.2";
    return syntax == family || syntax == family + ".1" || syntax == family + ".2" ||
           syntax == family + ".1.99";
}

std::string size_text(std::int64_t columns, std::int64_t rows, std::int64_t components,
                      std::int64_t bits) {
    return std::to_string(columns) + "x" + std::to_string(rows) + " pixels" +
           (components == 1 ? "" : " of " + std::to_string(components) + " values") + ", " +
           std::to_string(bits) + " bits";
}

void check_code_stream(const std::filesystem::path& file, std::span<const std::byte> stream,
                       const std::string& name, const DicomExtent& declared) {
    const auto size = code_stream_size(stream);
    if (!size) fail(file, "has a " + name + " image without a size that can be read");
    if (size->columns != declared.columns || size->rows != declared.rows ||
        size->components != declared.components || size->bits > declared.bits) {
        fail(file,
             "has a " + name + " image of " +
                 size_text(size->columns, size->rows, size->components, size->bits) +
                 ", its header says " +
                 size_text(declared.columns, declared.rows, declared.components, declared.bits));
    }
    if (!code_stream_length(stream)) fail(file, "has a " + name + " image that is cut off");
}

/// Of one frame without compression. Those of single bits begin with a byte.
std::uint64_t frame_bytes(const DicomExtent& declared) {
    const auto frames = static_cast<std::uint64_t>(declared.frames);
    const std::int64_t bits =
        declared.rows * declared.columns * declared.components * declared.bits;
    return declared.bits == 1 ? static_cast<std::uint64_t>(bits + 7) / 8
                              : declared.bytes() / frames;
}

/// A deflated stream without a header (PS3.5, A.4.13), of exactly so many bytes.
std::vector<std::byte> inflated(const std::filesystem::path& file, std::vector<std::byte> stream,
                                std::uint64_t bytes) {
    std::vector<std::byte> frame(bytes + 1);  // one more shows that there are too many
    if (std::max<std::uint64_t>(stream.size(), frame.size()) > UINT32_MAX) {
        fail(file, "has a deflated frame of more than 4 GB");
    }
    z_stream state{};
    if (inflateInit2(&state, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    state.next_in = reinterpret_cast<Bytef*>(stream.data());
    state.avail_in = static_cast<uInt>(stream.size());
    state.next_out = reinterpret_cast<Bytef*>(frame.data());
    state.avail_out = static_cast<uInt>(frame.size());
    const int status = ::inflate(&state, Z_FINISH);
    const std::uint64_t made = frame.size() - state.avail_out;
    inflateEnd(&state);
    if (status != Z_STREAM_END || made != bytes) {
        fail(file, "has a deflated frame that is damaged or has another size than its header says");
    }
    frame.pop_back();
    return frame;
}

}  // namespace

DicomStreams streams_of(const DicomBytes& bytes, const DicomPixels& pixels,
                        const DicomExtent& declared) {
    constexpr std::size_t usual_padding = 16;
    const auto frames = static_cast<std::size_t>(declared.frames);
    const bool is_image = is_code_stream(compression_of(declared.syntax));
    std::vector<std::span<const std::byte>> fragments;
    for (std::size_t i = 1; i < pixels.fragments.size(); ++i) {
        if (pixels.fragments[i].length == 0) continue;
        fragments.push_back(bytes.view(pixels.fragments[i].at, pixels.fragments[i].length));
    }
    DicomStreams all;
    for (const auto fragment : fragments) {
        const bool next = all.frames.empty() || !is_image || fragments.size() == frames ||
                          begins_code_stream(fragment);
        if (next) all.frames.emplace_back();
        all.frames.back().insert(all.frames.back().end(), fragment.begin(), fragment.end());
    }
    for (auto& stream : all.frames) {
        const auto length = is_image ? code_stream_length(stream) : std::nullopt;
        if (!length) continue;
        const auto behind = std::span(stream).subspan(*length);
        const bool is_padding =
            std::ranges::all_of(behind, [](std::byte b) { return b == std::byte{0}; });
        if (!is_padding || behind.size() > usual_padding) all.surplus += behind.size();
        stream.resize(*length);
    }
    return all;
}

std::vector<std::byte> frame_of(const std::filesystem::path& file, std::vector<std::byte> stream,
                                const DicomExtent& declared) {
    const std::string name = compression_of(declared.syntax);
    const std::uint64_t needed = frame_bytes(declared);
    if (name == deflated) return inflated(file, std::move(stream), needed);
    if (name != plain_in_fragments) return stream;
    if (stream.size() == needed + 1) stream.pop_back();  // padding to an even length
    if (stream.size() != needed) {
        fail(file, "has a frame of " + std::to_string(stream.size()) +
                       " bytes, its header asks for " + std::to_string(needed));
    }
    return stream;
}

bool is_known_syntax(const std::string& syntax) {
    return is_plain_syntax(syntax) || !compression_of(syntax).empty();
}

void check_plain_size(const std::filesystem::path& file, std::uint64_t bytes,
                      const DicomExtent& declared) {
    const std::uint64_t needed = declared.bytes();
    const std::uint64_t frame = needed / static_cast<std::uint64_t>(declared.frames);
    if (bytes < needed || bytes - needed >= std::max<std::uint64_t>(frame, 2)) {
        fail_size(file, bytes, needed);
    }
}

std::optional<std::string> check_plain_pixels(const std::filesystem::path& file,
                                              const DicomBytes& bytes, const DicomPixels& pixels,
                                              const DicomExtent& declared) {
    check_plain_size(file, *pixels.plain, declared);
    const std::uint64_t needed = declared.bytes(), more = *pixels.plain - needed;
    if (more <= 1) return std::nullopt;  // padding to an even length
    // A row more, and it is the number of rows that is wrong, unless all of it is padding.
    const std::uint64_t row = needed / static_cast<std::uint64_t>(declared.rows * declared.frames);
    const auto surplus = bytes.view(pixels.at + needed, more);
    const bool is_padding = declared.frames == 1 && std::ranges::all_of(surplus, [](std::byte b) {
                                return b == std::byte{0};
                            });
    if (more >= std::max<std::uint64_t>(row, 2) && !is_padding) {
        fail_size(file, *pixels.plain, needed);
    }
    return "there are " + std::to_string(more) +
           " bytes more of samples in a file than its header asks for; they were ignored";
}

void check_compressed_pixels(const std::filesystem::path& file, const DicomBytes& bytes,
                             const DicomPixels& pixels, DicomExtent& declared) {
    const std::string name = compression_of(declared.syntax);
    if (is_plain_syntax(declared.syntax)) {
        fail(file, "has compressed samples, but its transfer syntax '" + declared.syntax +
                       "' names no compression");
    }
    if (name == "video") {
        throw Failure(quoted(file) + " is a video; export it as a series of images");
    }
    if (name.empty() || name == "JPEG XL") {
        throw Failure(
            quoted(file) + " is compressed with " +
            (name.empty() ? "a method of the transfer syntax '" + declared.syntax + "'" : name) +
            ", which is not read; export it again without compression");
    }
    if (declared.bits % 8 != 0 && (is_code_stream(name) || name == "RLE")) {
        fail(file, "has compressed samples of single bits");
    }
    const auto wanted = static_cast<std::size_t>(declared.frames);
    const DicomStreams streams = streams_of(bytes, pixels, declared);
    if (streams.frames.size() != wanted) {
        fail(file, "has " + std::to_string(streams.frames.size()) +
                       " compressed images, its header says " + std::to_string(wanted));
    }
    for (const auto& stream : streams.frames) {
        (void)frame_of(file, stream, declared);
        if (is_code_stream(name)) check_code_stream(file, stream, name, declared);
        if (name != "RLE") continue;
        const auto segments = static_cast<std::size_t>(declared.components * declared.bits / 8);
        const auto pixels_each = static_cast<std::uint64_t>(declared.columns * declared.rows);
        if (!is_rle_frame(stream, segments, pixels_each)) {
            fail(file, "has an RLE image that does not have the " +
                           size_text(declared.columns, declared.rows, declared.components,
                                     declared.bits) +
                           " that its header says");
        }
    }
    if (streams.surplus > 0) {
        declared.notes.push_back("there are " + std::to_string(streams.surplus) +
                                 " bytes behind the end of compressed images in a file; they were "
                                 "ignored");
    }
    declared.compression = name == plain_in_fragments ? "" : name;
}

}  // namespace palpate::io
