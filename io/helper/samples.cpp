// Reads the samples that a header describes: raw, compressed or as text.
#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <limits>
#include <locale>

#include "io/byte_order.hpp"
#include "io/helper/headers.hpp"
#include "io/system/number.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

constexpr std::uint64_t padding_allowed = 4096, longest_footer = 1 << 20;
constexpr std::uint64_t most_before_end = 1 << 26;
constexpr std::size_t chunk_bytes = 1 << 20;
constexpr int longest_word = 512;  // a double has up to some 320 digits

/// Cuts the samples out of a stream of bytes of any piece sizes, puts every sample's bytes in the
/// machine's order and says how far it is.
class SampleBytes {
  public:
    /// `place`: one of the header's.
    SampleBytes(const VolumeHeader& header, const DataPlace& place, const ByteSink& sink)
        : sample_bytes_(size_of(header.stored)),
          begin_(place.skip),
          end_(place.skip + header.bytes_each()),
          swapped_(place.swapped),
          sink_(sink),
          before_(static_cast<double>(&place - header.places.data())),
          files_(static_cast<double>(header.places.size())) {}

    void operator()(std::span<const std::byte> bytes) {
        const std::uint64_t begin = std::clamp(begin_, seen_, seen_ + bytes.size());
        const std::uint64_t end = std::clamp(end_, seen_, seen_ + bytes.size());
        held_.insert(held_.end(), bytes.data() + (begin - seen_), bytes.data() + (end - seen_));
        seen_ += bytes.size();
        const std::size_t whole = held_.size() / sample_bytes_ * sample_bytes_;
        if (swapped_) swap_bytes({held_.data(), whole}, sample_bytes_);
        if (sink_ && whole > 0) sink_({held_.data(), whole});
        held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(whole));
        tell();
    }

  private:
    void tell() {
        const double part = std::min(1.0, static_cast<double>(seen_) / static_cast<double>(end_));
        if (part < told_ + 0.02) return;
        told_ = part;
        say_progress((before_ + part) / files_);
    }

    std::size_t sample_bytes_;
    std::uint64_t begin_, end_;
    bool swapped_;
    const ByteSink& sink_;
    double before_, files_;
    std::vector<std::byte> held_;
    std::uint64_t seen_ = 0;
    double told_ = 0;
};

void compare(std::uint64_t have, std::uint64_t need, const std::string& what, std::uint64_t surplus,
             std::vector<std::string>& notes) {
    const std::string numbers = "its header asks for " + std::to_string(need) + " " + what +
                                ", there are " + std::to_string(have);
    if (have < need) throw Failure(numbers + "; it is cut off: copy or download it again");
    if (have - need > surplus) {
        throw Failure(numbers + "; correct the sizes or the type in its header");
    }
    if (have > need) notes.push_back(numbers + "; the rest was ignored");
}

/// The same for samples. As many additional bytes again, or more, are no padding: the type is twice
/// as wide as the header says, or there are other samples. Footers are ignored.
void compare_samples(std::uint64_t have, std::uint64_t need, const std::string& what,
                     const DataPlace& place, std::vector<std::string>& notes) {
    const bool doubled = have >= need && have - need >= need;
    const bool has_words = place.footer == DataPlace::Footer::words,
               has_tags = place.footer == DataPlace::Footer::tags;
    if (have > need && has_words) return;
    if (have > need && has_tags && !(doubled && have - need > longest_footer)) return;
    compare(have, need, what, doubled ? 0 : padding_allowed, notes);
}

/// Numbers may have commas between them, as in C.
class CommasAreBlank : public std::ctype<char> {
  public:
    CommasAreBlank() : std::ctype<char>(table()) {}

  private:
    static const mask* table() {
        static const std::vector<mask> table = [] {
            std::vector<mask> masks(classic_table(), classic_table() + table_size);
            masks[','] |= space;
            return masks;
        }();
        return table.data();
    }
};

/// Whether the commas of a text are decimal ones, as in "1,5 2,5": they stand between two digits,
/// and no number has one on both sides.
class CommasSeen {
  public:
    /// `in`: behind `word`. Takes a comma out of it.
    void look(std::istream& in, const std::string& word) {
        const bool after = joins_;
        joins_ = false;
        if (in.peek() != ',') return;
        in.get();
        joins_ = is_digit(word.back()) && is_digit(in.peek());
        some_ = some_ || joins_;
        lists_ = lists_ || (after && joins_);
    }
    bool are_decimal() const { return some_ && !lists_; }

  private:
    static bool is_digit(int c) { return c >= '0' && c <= '9'; }
    bool joins_ = false, some_ = false, lists_ = false;
};

[[noreturn]] void fail_to_read(const DataPlace& place, int error) {
    const char* const advice = error == EACCES || error == EPERM ? "; allow this user to read it"
                               : error == ENOENT                 ? "; put it beside the header"
                               : error == EIO                    ? "; check the disk"
                                                                 : "; correct the header, or copy "
                                                                   "the file again";
    throw Failure("its data file '" + place.file.filename().string() + "' cannot be read (" +
                  reason(error) + ")" + advice);
}

/// At the first byte of a place.
std::ifstream opened(const DataPlace& place) {
    errno = 0;
    std::ifstream in(place.file, std::ios::binary);
    if (!in) fail_to_read(place, errno);
    in.seekg(static_cast<std::streamoff>(place.offset));
    return in;
}

/// Numbers of a text, all of them counted, as many as the header says converted.
void read_text(VolumeHeader& header, DataPlace& place, const ByteSink& sink) {
    std::ifstream in = opened(place);
    in.seekg(static_cast<std::streamoff>(place.offset + place.skip));
    in.imbue(std::locale(in.getloc(), new CommasAreBlank));
    place.skip = 0;
    place.swapped = false;
    SampleBytes samples(header, place, sink);
    std::vector<std::byte> bytes;
    std::uint64_t count = 0;
    CommasSeen commas;
    const std::uint64_t wanted = header.samples() / header.places.size();
    for (std::string word; in >> std::setw(longest_word) >> word; ++count) {
        const auto number = number_from<double>(word);
        if (!number && place.footer == DataPlace::Footer::words && count >= wanted) break;
        if (!number) {
            throw Failure("its data are not all numbers ('" + word.substr(0, 20) + "' after " +
                          std::to_string(count) + " of them); export it again");
        }
        commas.look(in, word);
        if (count >= wanted) continue;
        append_sample(*number, header.stored, bytes);
        if (bytes.size() < chunk_bytes) continue;
        samples(bytes);
        bytes.clear();
    }
    if (count != wanted && commas.are_decimal()) {
        throw Failure(
            "its numbers have decimal commas, which are not read; write them with points");
    }
    place.footer = DataPlace::Footer::none;  // all numbers before it were counted
    compare_samples(count, wanted, "numbers", place, header.notes);
    samples(bytes);
}

/// Bytes from the place's offset to the end of its file.
std::uint64_t available_at(const DataPlace& place) {
    std::error_code error;
    const std::uint64_t file_bytes = std::filesystem::file_size(place.file, error);
    if (error) fail_to_read(place, error.value());
    return file_bytes - std::min(place.offset, file_bytes);
}

/// Whether the bytes there begin as those of gzip or zlib do.
bool begins_packed(const DataPlace& place) {
    std::ifstream in = opened(place);
    std::array<char, 2> bytes{};
    in.read(bytes.data(), bytes.size());
    const auto number = big_endian<std::uint16_t>(std::as_bytes(std::span(bytes)));
    return number == 0x1f8b || ((number >> 8 & 0xf) == 8 && number % 31 == 0);
}

/// Behind the samples, a line ends, and words follow, or nothing does.
void check_words_behind(const DataPlace& place, std::uint64_t bytes) {
    std::ifstream in = opened(place);
    in.seekg(static_cast<std::streamoff>(place.offset + place.skip + bytes));
    constexpr int end = std::char_traits<char>::eof();
    const int first = in.get();
    if (first == end) return;
    in >> std::ws;
    const int next = in.peek();
    if (std::isspace(first) != 0 && (next == end || std::isalpha(next) != 0)) return;
    throw Failure(
        "its samples do not end where its header says; correct the sizes or the type in its "
        "header");
}

void check_length(VolumeHeader& header, const DataPlace& place) {
    const std::uint64_t available = available_at(place);
    const std::uint64_t have = available - std::min(place.skip, available);
    if (have < header.bytes_each() && begins_packed(place)) {
        throw Failure(
            "its header says that its samples are not compressed, but they begin as gzip's or "
            "zlib's do; correct the header, or unpack them");
    }
    compare_samples(have, header.bytes_each(), "bytes of samples", place, header.notes);
    if (place.footer == DataPlace::Footer::words) check_words_behind(place, header.bytes_each());
}

void read_raw_bytes(VolumeHeader& header, const DataPlace& place, const ByteSink& sink) {
    check_length(header, place);
    SampleBytes samples(header, place, sink);
    std::ifstream in = opened(place);
    std::vector<std::byte> chunk(chunk_bytes);
    for (std::uint64_t left = place.skip + header.bytes_each(); left > 0;) {
        errno = 0;
        in.read(reinterpret_cast<char*>(chunk.data()),
                static_cast<std::streamsize>(std::min<std::uint64_t>(left, chunk.size())));
        const auto got = static_cast<std::size_t>(in.gcount());
        if (got == 0 && errno != 0) fail_to_read(place, errno);
        if (got == 0) {
            throw Failure(
                "its samples became fewer while they were read; read it again when no "
                "program writes it");
        }
        samples({chunk.data(), got});
        left -= got;
    }
}

/// Bytes before the samples if these are the end of what is unpacked, which is then unpacked twice.
std::uint64_t bytes_before_end(const VolumeHeader& header, const DataPlace& place) {
    const std::uint64_t at_most = most_before_end + header.bytes_each();
    const std::uint64_t all =
        inflate_checked(place.file, {place.offset, place.length, at_most}, {});
    return all - std::min(header.bytes_each(), all);
}

void read_compressed(VolumeHeader& header, DataPlace& place, const ByteSink& sink) {
    const std::uint64_t available = available_at(place);
    if (place.length != UINT64_MAX) {
        compare(available, place.length, "compressed bytes", padding_allowed, header.notes);
    }
    if (!begins_packed(place)) {
        throw Failure(
            "its header says that its samples are compressed, but they do not begin as gzip's or "
            "zlib's do; correct the header, or copy it again");
    }
    std::uint64_t unpacked = 0;
    try {
        if (place.is_at_end) place.skip = bytes_before_end(header, place);
        SampleBytes samples(header, place, sink);
        const bool has_tags = place.footer == DataPlace::Footer::tags;
        const std::uint64_t behind =
            has_tags ? std::max(header.bytes_each(), longest_footer) : padding_allowed;
        const std::uint64_t at_most = place.skip + header.bytes_each() + behind;
        unpacked =
            inflate_checked(place.file, {place.offset, place.length, at_most}, std::ref(samples));
    } catch (const DamagedStream& e) {
        throw Failure(std::string(e.what()) + "; copy or download it again");
    }
    compare_samples(unpacked - std::min(place.skip, unpacked), header.bytes_each(),
                    "bytes of samples", place, header.notes);
}

void stream_file(VolumeHeader& header, DataPlace& place, const ByteSink& sink) {
    switch (place.encoding) {
        case DataPlace::Encoding::raw:
            return read_raw_bytes(header, place, sink);
        case DataPlace::Encoding::compressed:
            return read_compressed(header, place, sink);
        case DataPlace::Encoding::text:
            available_at(place);
            return read_text(header, place, sink);
    }
}

}  // namespace

void append_sample(double number, Stored stored, std::vector<std::byte>& bytes) {
    with_stored(stored, [&](auto zero) {
        using T = decltype(zero);
        using Limits = std::numeric_limits<T>;
        if constexpr (std::is_integral_v<T>) {
            const double above = std::ldexp(1.0, Limits::digits);  // exact, unlike max()
            if (!(number >= static_cast<double>(Limits::min()) && number < above) ||
                number != std::floor(number)) {
                throw Failure(
                    "its data have the number " + text_of(number) +
                    ", which its sample type cannot hold; correct the type in its header");
            }
        }
        if constexpr (std::is_arithmetic_v<T>) {  // no header has half floats as text
            const T value = static_cast<T>(number);
            const auto raw = std::as_bytes(std::span(&value, 1));
            bytes.insert(bytes.end(), raw.begin(), raw.end());
        }
    });
}

void check_raw_length(VolumeHeader& header) {
    for (const DataPlace& place : header.places) check_length(header, place);
}

void stream_samples(VolumeHeader& header, const ByteSink& sink) {
    for (DataPlace& place : header.places) {
        try {
            stream_file(header, place, sink);
        } catch (const Failure& e) {
            if (header.places.size() == 1) throw;
            throw Failure(quoted(place.file) + ": " + e.what());
        }
    }
}

}  // namespace palpate::io
