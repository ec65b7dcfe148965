// Compressions of TIFF that no library offers apart from reading the file: LZW, and differences
// along rows. "TIFF Revision 6.0", Adobe 1992, sections 13 and 14. See the header.
#include "stream/formats/undo_codecs.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>

#include "io/byte_order.hpp"

namespace palpate::stream {
namespace {

constexpr unsigned clear_code = 256, end_code = 257, first_free = 258, most_codes = 4096;

/// Codes of 9 to 12 bits, the highest bit first.
class CodeReader {
  public:
    explicit CodeReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::optional<unsigned> next(unsigned width) {
        while (held_ < width) {
            if (at_ == bytes_.size()) return std::nullopt;
            bits_ = bits_ << 8 | std::to_integer<std::uint32_t>(bytes_[at_++]);
            held_ += 8;
        }
        held_ -= width;
        return bits_ >> held_ & ((1U << width) - 1);
    }

  private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
    std::uint32_t bits_ = 0;
    unsigned held_ = 0;  ///< bits of bits_ that are not used yet
};

/// The strings of the codes. Each is the beginning of the result that came before: where it began
/// there, and its length.
class CodeTable {
  public:
    void clear() { next_ = first_free; }
    unsigned next() const { return next_; }
    /// Width of the next code. It grows one code earlier than it would have to.
    unsigned width() const {
        unsigned width = 9;
        while (width < 12 && next_ >= (1U << width) - 1) ++width;
        return width;
    }
    void add(std::size_t begin, std::size_t length) {
        if (next_ == most_codes) throw DamagedChunk("is a damaged LZW stream");
        strings_[next_++] = {begin, length};
    }
    std::pair<std::size_t, std::size_t> operator[](unsigned code) const { return strings_[code]; }

  private:
    std::array<std::pair<std::size_t, std::size_t>, most_codes> strings_{};
    unsigned next_ = first_free;
};

template <class T>
void add_up(std::span<std::byte> row) {
    T sum = 0;
    for (std::size_t at = 0; at + sizeof(T) <= row.size(); at += sizeof(T)) {
        T difference;
        std::memcpy(&difference, row.data() + at, sizeof(T));
        sum = static_cast<T>(sum + difference);
        std::memcpy(row.data() + at, &sum, sizeof(T));
    }
}

}  // namespace

std::vector<std::byte> unlzw(std::span<const std::byte> packed, std::size_t most) {
    std::vector<std::byte> out;
    out.reserve(most);
    CodeReader codes(packed);
    CodeTable table;
    std::size_t last_begin = 0, last_length = 0;  // of the string before in `out`
    while (const auto code = codes.next(table.width())) {
        if (*code == end_code) return out;
        if (*code == clear_code) {
            table.clear();
            last_length = 0;
            continue;
        }
        // The string before with one more byte, which is the first of this one: it follows there.
        if (last_length > 0) table.add(last_begin, last_length + 1);
        if (*code >= table.next()) throw DamagedChunk("is a damaged LZW stream");
        const std::size_t begin = out.size();
        if (*code < clear_code) {
            out.push_back(static_cast<std::byte>(*code));
        } else {
            const auto [from, length] = table[*code];
            // A string may end where this one begins, so bytes are taken one by one.
            for (std::size_t i = 0; i < length && out.size() <= most; ++i) {
                out.push_back(out[from + i]);
            }
        }
        if (out.size() > most) unpacks_too_long(most);
        last_begin = begin;
        last_length = out.size() - begin;
    }
    if (out.size() < most) throw DamagedChunk("ends within its LZW stream");
    return out;  // some programs leave the end out
}

void undo_differences(std::span<std::byte> bytes, std::size_t each, std::size_t row, bool swapped) {
    if (swapped) io::swap_bytes(bytes, each);
    for (std::size_t at = 0; at + row * each <= bytes.size(); at += row * each) {
        const auto samples = bytes.subspan(at, row * each);
        switch (each) {
            case 1:
                add_up<std::uint8_t>(samples);
                break;
            case 2:
                add_up<std::uint16_t>(samples);
                break;
            case 4:
                add_up<std::uint32_t>(samples);
                break;
            default:
                add_up<std::uint64_t>(samples);
        }
    }
    if (swapped) io::swap_bytes(bytes, each);
}

void undo_float_differences(std::span<std::byte> bytes, std::size_t each, std::size_t row,
                            bool swapped) {
    const bool is_big = swapped == (std::endian::native == std::endian::little);
    std::vector<std::byte> sums;
    for (std::size_t at = 0; at + row * each <= bytes.size(); at += row * each) {
        const auto samples = bytes.subspan(at, row * each);
        add_up<std::uint8_t>(samples);
        sums.assign(samples.begin(), samples.end());
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const std::size_t place = i / row;  // from the highest byte
            samples[i % row * each + (is_big ? place : each - 1 - place)] = sums[i];
        }
    }
}

}  // namespace palpate::stream
