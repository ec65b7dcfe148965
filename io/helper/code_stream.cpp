// Reads the headers of compressed images. See the header.
#include "io/helper/code_stream.hpp"

#include <algorithm>

#include "io/byte_order.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t segment_padding = 16;

/// Big-endian numbers of a stream; 0 beyond its end.
class Numbers {
  public:
    explicit Numbers(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::size_t size() const { return bytes_.size(); }
    std::uint32_t at(std::size_t place, std::size_t bytes) const {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i) {
            const bool there = place + i < bytes_.size();
            value = value << 8 | (there ? std::to_integer<std::uint32_t>(bytes_[place + i]) : 0U);
        }
        return value;
    }

  private:
    std::span<const std::byte> bytes_;
};

/// `at` is that of the segment's length; it follows the marker.
CodeStreamSize jpeg_frame(const Numbers& numbers, std::size_t at) {
    return {numbers.at(at + 5, 2), numbers.at(at + 3, 2), static_cast<int>(numbers.at(at + 7, 1)),
            static_cast<int>(numbers.at(at + 2, 1))};
}

std::optional<CodeStreamSize> jpeg_size(const Numbers& numbers) {
    for (std::size_t at = 2; at + 4 <= numbers.size();) {
        if (numbers.at(at, 1) != 0xff) return std::nullopt;
        const std::uint32_t marker = numbers.at(at + 1, 1);
        if (marker == 0xff) {  // padding
            ++at;
            continue;
        }
        at += 2;
        const bool frame = (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 &&
                            marker != 0xcc) ||
                           marker == 0xf7;
        if (frame && at + 8 <= numbers.size()) return jpeg_frame(numbers, at);
        if (frame || marker == 0xda || marker == 0xd9) return std::nullopt;
        if (marker != 0x01 && !(marker >= 0xd0 && marker <= 0xd7)) at += numbers.at(at, 2);
    }
    return std::nullopt;
}

/// `siz` is that of the marker's length.
std::optional<CodeStreamSize> jpeg_2000_size(const Numbers& numbers, std::size_t siz) {
    const auto components = static_cast<int>(numbers.at(siz + 36, 2));
    if (siz + 38 + 3 > numbers.size() || components < 1) return std::nullopt;
    // A component of another resolution or depth than the first is not the image that is declared.
    for (std::size_t i = 0; i < static_cast<std::size_t>(components); ++i) {
        const std::size_t at = siz + 38 + 3 * i;
        if (numbers.at(at, 1) != numbers.at(siz + 38, 1) || numbers.at(at + 1, 2) != 0x0101) {
            return std::nullopt;
        }
    }
    return CodeStreamSize{std::int64_t{numbers.at(siz + 4, 4)} - numbers.at(siz + 12, 4),
                          std::int64_t{numbers.at(siz + 8, 4)} - numbers.at(siz + 16, 4),
                          components, static_cast<int>(numbers.at(siz + 38, 1) & 0x7f) + 1};
}

/// Up to EOI. Within the samples, a byte of 255 is followed by one below 128.
std::optional<std::size_t> jpeg_length(const Numbers& numbers) {
    for (std::size_t at = 2; at + 2 <= numbers.size();) {
        const std::uint32_t marker = numbers.at(at + 1, 1);
        if (numbers.at(at, 1) != 0xff || marker == 0xff) {
            ++at;
            continue;
        }
        at += 2;
        if (marker == 0xd9) return at;
        const bool is_alone = marker < 0xc0 || (marker >= 0xd0 && marker <= 0xd8);
        if (!is_alone) at += numbers.at(at, 2);
    }
    return std::nullopt;
}

/// Where the markers of JPEG 2000 begin, also inside a JP2 file.
std::optional<std::size_t> jpeg_2000_start(const Numbers& numbers) {
    constexpr std::size_t boxes_before_stream = 4096;
    const bool jp2 = numbers.at(4, 4) == 0x6a502020;  // "jP  "
    for (std::size_t at = 0; at < (jp2 ? boxes_before_stream : 1); ++at) {
        if (numbers.at(at, 4) == 0xff4fff51) return at;
    }
    return std::nullopt;
}

/// Up to EOC, by the lengths of the tiles; nothing if one of them has none, as the last may.
std::optional<std::size_t> jpeg_2000_length(const Numbers& numbers) {
    constexpr std::uint32_t tile = 0xff90, end = 0xffd9, least = 12;
    const auto start = jpeg_2000_start(numbers);
    for (std::size_t at = start.value_or(numbers.size()) + 2; at + 2 <= numbers.size();) {
        const std::uint32_t marker = numbers.at(at, 2);
        if (marker == end) return at + 2;
        const std::uint32_t length = marker == tile ? numbers.at(at + 6, 4) : numbers.at(at + 2, 2);
        if (marker >> 8 != 0xff || (marker == tile && length < least)) return std::nullopt;
        at += length + (marker == tile ? 0 : 2);
    }
    return std::nullopt;
}

/// Up to an end marker that nothing but padding follows.
std::optional<std::size_t> unpadded_length(std::span<const std::byte> stream) {
    std::size_t end = stream.size();
    const auto is_padding = [](std::byte b) { return b == std::byte{0} || b == std::byte{0xff}; };
    while (end > 2 && is_padding(stream[end - 1])) --end;
    const bool ends =
        end >= 4 && stream[end - 2] == std::byte{0xff} && stream[end - 1] == std::byte{0xd9};
    return ends ? std::optional(end) : std::nullopt;
}

/// Bytes that a PackBits segment unpacks to; stops above `at_most`.
std::uint64_t unpacked_size(std::span<const std::byte> segment, std::uint64_t at_most) {
    std::uint64_t size = 0;
    std::size_t at = 0;
    while (at + 1 < segment.size() && size < at_most) {
        const auto n = std::to_integer<unsigned>(segment[at]);
        if (n < 128) {
            if (at + 1 + n >= segment.size()) return 0;  // literals beyond the end
            size += n + 1;
            at += n + 2;
        } else {
            if (n > 128) size += 257 - n;
            at += n > 128 ? 2 : 1;
        }
    }
    return segment.size() - at > segment_padding ? at_most + 1 : size;
}

}  // namespace

bool begins_code_stream(std::span<const std::byte> bytes) {
    const Numbers numbers(bytes);
    return numbers.at(0, 3) == 0xffd8ff || numbers.at(0, 4) == 0xff4fff51;
}

std::optional<CodeStreamSize> code_stream_size(std::span<const std::byte> stream) {
    const Numbers numbers(stream);
    if (numbers.at(0, 3) == 0xffd8ff) return jpeg_size(numbers);
    if (const auto start = jpeg_2000_start(numbers)) return jpeg_2000_size(numbers, *start + 4);
    return std::nullopt;
}

std::optional<std::size_t> code_stream_length(std::span<const std::byte> stream) {
    const Numbers numbers(stream);
    const auto length =
        numbers.at(0, 3) == 0xffd8ff ? jpeg_length(numbers) : jpeg_2000_length(numbers);
    return length ? length : unpadded_length(stream);
}

bool is_rle_frame(std::span<const std::byte> frame, std::size_t segments, std::uint64_t bytes) {
    const auto little = [&](std::size_t at) {
        return little_endian<std::uint32_t>(frame.subspan(at));
    };
    if (frame.size() < 64 || segments > 15 || little(0) != segments) return false;
    for (std::size_t i = 0; i < segments; ++i) {
        const std::size_t begin = little(4 + 4 * i);
        const std::size_t end = i + 1 < segments ? little(8 + 4 * i) : frame.size();
        if (begin < 64 || begin > end || end > frame.size()) return false;
        if (unpacked_size(frame.subspan(begin, end - begin), bytes) != bytes) return false;
    }
    return true;
}

}  // namespace palpate::io
