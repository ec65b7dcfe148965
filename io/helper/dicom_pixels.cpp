// Checks of pixel data (PS3.5 chapter 8, annex A.4). See the header.
#include "io/helper/dicom_pixels.hpp"

#include <algorithm>

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

/// Frames without compression, each in a fragment of its own (PS3.5, A.4.11).
constexpr const char* plain_in_fragments = "no compression";

/// Empty for a syntax without fragments, or with a compression that we know nothing of.
std::string compression_of(const std::string& syntax) {
    const std::string family = "1.2.840.10008.1.2.";
    if (syntax.rfind(family, 0) != 0) return {};
    const std::string rest = syntax.substr(family.size());
    if (rest == "1.98") return plain_in_fragments;
    if (rest == "5") return "RLE";
    if (rest == "4.80" || rest == "4.81") return "JPEG-LS";
    if (rest.rfind("4.9", 0) == 0 || rest.rfind("4.20", 0) == 0) return "JPEG 2000";
    if (rest.rfind("4.10", 0) == 0) return "video";
    if (rest.rfind("4.11", 0) == 0) return "JPEG XL";
    return rest.rfind("4.", 0) == 0 ? "JPEG" : "";
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
    if (!ends_code_stream(stream)) fail(file, "has a " + name + " image that is cut off");
}

}  // namespace

std::vector<std::vector<std::byte>> frames_of(const DicomBytes& bytes, const DicomPixels& pixels,
                                              const DicomExtent& declared) {
    const auto frames = static_cast<std::size_t>(declared.frames);
    const std::string name = compression_of(declared.syntax);
    const bool is_code_stream = name != "RLE" && name != plain_in_fragments;
    std::vector<std::span<const std::byte>> fragments;
    for (std::size_t i = 1; i < pixels.fragments.size(); ++i) {
        if (pixels.fragments[i].length == 0) continue;
        fragments.push_back(bytes.view(pixels.fragments[i].at, pixels.fragments[i].length));
    }
    std::vector<std::vector<std::byte>> all;
    for (const auto fragment : fragments) {
        const bool next = all.empty() || !is_code_stream || fragments.size() == frames ||
                          begins_code_stream(fragment);
        if (next) all.emplace_back();
        all.back().insert(all.back().end(), fragment.begin(), fragment.end());
    }
    for (auto& stream : all) {
        while (is_code_stream && ends_code_stream(stream) && stream.back() == std::byte{0}) {
            stream.pop_back();
        }
        if (name == plain_in_fragments && stream.size() == declared.bytes() / frames + 1) {
            stream.pop_back();  // padding to an even length
        }
    }
    return all;
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

std::string check_compressed_pixels(const std::filesystem::path& file, const std::string& syntax,
                                    const DicomBytes& bytes, const DicomPixels& pixels,
                                    const DicomExtent& declared) {
    const std::string name = compression_of(syntax);
    if (name.empty()) {
        fail(file, "has compressed samples, but its transfer syntax '" + syntax +
                       "' names no compression that is read");
    }
    if (name == "video") {
        throw Failure(quoted(file) + " is a video; export it as a series of images");
    }
    if (name == "JPEG XL") {
        throw Failure(quoted(file) +
                      " is compressed with JPEG XL, which is not read; export it again without "
                      "compression");
    }
    if (declared.bits % 8 != 0) fail(file, "has compressed samples of single bits");
    const auto wanted = static_cast<std::size_t>(declared.frames);
    const auto frames = frames_of(bytes, pixels, declared);
    if (frames.size() != wanted) {
        fail(file, "has " + std::to_string(frames.size()) + " compressed images, its header says " +
                       std::to_string(wanted));
    }
    for (const auto& frame : frames) {
        if (name == plain_in_fragments) {
            if (frame.size() == declared.bytes() / wanted) continue;
            fail(file, "has a frame of " + std::to_string(frame.size()) +
                           " bytes, its header asks for " +
                           std::to_string(declared.bytes() / wanted));
        }
        if (name != "RLE") {
            check_code_stream(file, frame, name, declared);
            continue;
        }
        const auto segments = static_cast<std::size_t>(declared.components * declared.bits / 8);
        const auto pixels_each = static_cast<std::uint64_t>(declared.columns * declared.rows);
        if (!is_rle_frame(frame, segments, pixels_each)) {
            fail(file, "has an RLE image that does not have the " +
                           size_text(declared.columns, declared.rows, declared.components,
                                     declared.bits) +
                           " that its header says");
        }
    }
    return name == plain_in_fragments ? "" : name;
}

}  // namespace palpate::io
