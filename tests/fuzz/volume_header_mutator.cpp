// Mutates volumes so that they pass the first checks of a reader. A compressed stream is unpacked,
// changed and packed again with its checksum. The samples get the length that the header declares,
// and an element of a DICOM file gets the length of its value.
#include <zlib.h>

#include <cstring>
#include <optional>
#include <sstream>

#include "fuzz/mutation.hpp"

namespace {

using namespace palpate::fuzz;

constexpr std::size_t most_unpacked = 1 << 16;

/// The contents of a gzip or zlib stream, if it is one and not long.
std::optional<Bytes> unpacked(const Bytes& packed) {
    z_stream stream{};
    if (inflateInit2(&stream, 15 + 32) != Z_OK) return {};
    Bytes out(most_unpacked);
    stream.next_in = const_cast<std::uint8_t*>(packed.data());
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    const int status = inflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    inflateEnd(&stream);
    if (status != Z_STREAM_END) return {};
    return out;
}

Bytes packed(const Bytes& bytes, bool gzip) {
    z_stream stream{};
    if (deflateInit2(&stream, 6, Z_DEFLATED, gzip ? 31 : 15, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return {};
    Bytes out(bytes.size() + bytes.size() / 100 + 64);
    stream.next_in = const_cast<std::uint8_t*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

/// Samples that the sizes of a text header ask for; nothing where they cannot be had.
std::optional<std::size_t> declared_samples(const std::string& header, const std::string& field) {
    const std::size_t at = header.find(field);
    if (at == std::string::npos) return {};
    std::istringstream line(
        header.substr(at + field.size(), header.find('\n', at) - at - field.size()));
    line.ignore(3, ' ');
    std::size_t product = 1;
    for (std::int64_t size = 0; line >> size;) {
        if (size < 1 || size > 4096) return {};
        product *= static_cast<std::size_t>(size);
        if (product > most_unpacked) return {};
    }
    return product;
}

/// A text header and its samples: either is changed, then the samples get the declared length.
void mutate_text_volume(Bytes& bytes, Random& random, const std::string& end,
                        const std::string& field, std::size_t room) {
    const auto split = std::search(bytes.begin(), bytes.end(), end.begin(), end.end());
    if (split == bytes.end()) return mutate(bytes, room);
    Bytes header(bytes.begin(), split + std::ptrdiff_t(end.size()));
    Bytes samples(split + std::ptrdiff_t(end.size()), bytes.end());
    const auto inside = unpacked(samples);
    const bool gzip = samples.size() > 1 && samples[0] == 0x1F;
    if (inside) samples = *inside;
    one_in(random, 3) ? mutate(samples, room) : mutate(header, std::min<std::size_t>(room, 256));
    const std::string text(header.begin(), header.end());
    if (const auto count = declared_samples(text, field); count && !one_in(random, 4)) {
        const std::size_t each = std::size_t(1) << random() % 4;
        samples.resize(std::min(*count * each, most_unpacked));
    }
    if (inside) samples = packed(samples, gzip);
    bytes = header;
    bytes.insert(bytes.end(), samples.begin(), samples.end());
}

/// The value of one element, and its length with it. Explicit VR, little-endian, before any
/// sequence.
void mutate_dicom(Bytes& bytes, Random& random, std::size_t room) {
    struct Element {
        std::size_t value, length, length_at;
        bool is_long;
    };
    std::vector<Element> elements;
    for (std::size_t at = 132; at + 12 <= bytes.size();) {
        const std::string kind(bytes.begin() + std::ptrdiff_t(at) + 4,
                               bytes.begin() + std::ptrdiff_t(at) + 6);
        const bool is_long =
            kind == "OB" || kind == "OW" || kind == "SQ" || kind == "UN" || kind == "UT";
        std::uint32_t length = 0;
        std::memcpy(&length, &bytes[at + (is_long ? 8 : 6)], is_long ? 4 : 2);
        const std::size_t value = at + (is_long ? 12 : 8);
        if (value + length > bytes.size()) break;
        elements.push_back({value, length, at + (is_long ? 8U : 6U), is_long});
        at = value + length;
    }
    if (elements.empty() || one_in(random, 4)) return mutate(bytes, room);
    const Element one = elements[random() % elements.size()];
    const auto begin = bytes.begin() + std::ptrdiff_t(one.value);
    Bytes value(begin, begin + std::ptrdiff_t(one.length));
    mutate(value, std::min<std::size_t>(room, 64));
    if (value.size() % 2 == 1) value.push_back(' ');
    const auto length = static_cast<std::uint32_t>(value.size());
    std::memcpy(&bytes[one.length_at], &length, one.is_long ? 4 : 2);
    bytes.erase(begin, begin + std::ptrdiff_t(one.length));
    bytes.insert(bytes.begin() + std::ptrdiff_t(one.value), value.begin(), value.end());
}

/// NIfTI, MGH and MRC: the header's numbers, or the stream that all of it is packed in.
void mutate_nifti(Bytes& bytes, std::size_t room) {
    const auto inside = unpacked(bytes);
    if (!inside) return mutate(bytes, room);
    bytes = *inside;
    mutate(bytes, room);
    bytes = packed(bytes, true);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    if (size < 2) return LLVMFuzzerMutate(data, size, most);
    Random random(seed + 1);
    Bytes bytes(data + 1, data + size);
    const std::size_t room = most > size ? (most - size) / 2 : 0;
    switch (data[0]) {
        case 'd':
            mutate_dicom(bytes, random, room);
            break;
        case 'n':
        case 'g':
        case 'c':
            mutate_nifti(bytes, room);
            break;
        case 'm':
            mutate_text_volume(bytes, random, "LOCAL\n", "DimSize", room);
            break;
        default:
            mutate_text_volume(bytes, random, "\n\n", "sizes:", room);
    }
    bytes.resize(std::min(bytes.size(), most - 1));
    std::copy(bytes.begin(), bytes.end(), data + 1);
    return bytes.size() + 1;
}
