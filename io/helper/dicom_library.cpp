// Reads samples and applies slope and intercept. See the header.
#include <fcntl.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <new>
#include <optional>
#include <sstream>

#include "io/byte_order.hpp"
#include "io/helper/code_stream.hpp"
#include "io/helper/dicom_check.hpp"
#include "io/helper/dicom_library.hpp"
#include "io/helper/library_words.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// Messages that a decoder prints while this lives. Some go on after damage and only warn.
class DecoderWords {
  public:
    DecoderWords() : memory_(memfd_create("palpate-words", MFD_CLOEXEC)) {
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
            before_[stream - 1] = fcntl(stream, F_DUPFD_CLOEXEC, 16);
            dup2(memory_, stream);
        }
    }
    ~DecoderWords() {
        put_back();
        close(memory_);
    }
    DecoderWords(const DecoderWords&) = delete;
    DecoderWords& operator=(const DecoderWords&) = delete;

    std::string said() {
        put_back();
        char text[512];
        const ssize_t size = pread(memory_, text, sizeof text, 0);
        std::istringstream lines({text, static_cast<std::size_t>(std::max<ssize_t>(size, 0))});
        std::string damage;
        for (std::string line; std::getline(lines, line);) {
            // GDCM tries libraries for 8, 12 and 16 bits in turn; for the wrong ones, it says the
            // second and the third of these. The last one is about the wrapping of a whole image.
            const auto says = [&](const char* words) { return line.find(words) != line.npos; };
            if (says("Warning: In ") || says("Unsupported JPEG data precision") ||
                says("DICOM header said it was ") || says("J2K start like JPEG-2000")) {
                continue;
            }
            damage += line + '\n';
        }
        return library_words(damage, 120);
    }

  private:
    void put_back() {
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
            if (before_[stream - 1] < 0) continue;
            std::fflush(stream == STDOUT_FILENO ? stdout : stderr);
            dup2(before_[stream - 1], stream);
            close(before_[stream - 1]);
            before_[stream - 1] = -1;
        }
    }
    int memory_;
    int before_[2];
};

/// A frame of one value a pixel, unpacked by GDCM into words as wide as its stream asks for.
std::vector<std::byte> unpacked(const DicomExtent& extent, std::span<const std::byte> stream) {
    const auto size = code_stream_size(stream);  // RLE has none
    const auto bits = static_cast<std::uint16_t>(size ? size->bits : extent.bits);
    const auto word = static_cast<std::uint16_t>(bits <= 8 ? 8 : bits <= 16 ? 16 : 32);
    gdcm::Fragment fragment;
    fragment.SetByteValue(reinterpret_cast<const char*>(stream.data()),
                          static_cast<std::uint32_t>(stream.size()));
    const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
    fragments->AddFragment(fragment);
    gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010), 0, gdcm::VR::OB);
    pixels.SetValue(*fragments);
    gdcm::Image image;
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, static_cast<unsigned>(extent.columns));
    image.SetDimension(1, static_cast<unsigned>(extent.rows));
    image.SetPixelFormat(gdcm::PixelFormat(1, word, bits, static_cast<std::uint16_t>(bits - 1),
                                           static_cast<std::uint16_t>(extent.representation == 1)));
    image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image.SetTransferSyntax(gdcm::TransferSyntax::GetTSType(extent.syntax.c_str()));
    image.SetDataElement(pixels);
    std::vector<std::byte> samples(static_cast<std::size_t>(extent.rows * extent.columns) * word /
                                   8);
    if (image.GetBufferLength() != samples.size() ||
        !image.GetBuffer(reinterpret_cast<char*>(samples.data()))) {
        throw Failure(
            "has a " + extent.compression +
            " image that cannot be unpacked; it is damaged, or of a kind that is not read: "
            "export it again without compression");
    }
    return samples;
}

std::vector<std::byte> in_our_order(std::span<const std::byte> bytes, std::size_t word) {
    std::vector<std::byte> samples(bytes.begin(), bytes.end());
    if (samples.size() % word != 0) {
        throw Failure("has big-endian samples of less than a word; export it again, little-endian");
    }
    swap_bytes(samples, word);
    return samples;
}

/// Moves samples to the lowest bits of their words, clears the others, and extends the sign. Says
/// whether that changes a number, other than by the move.
template <class Word>
bool tidy_bits(std::vector<std::byte>& bytes, int stored, int shift, bool is_signed) {
    auto* const samples = reinterpret_cast<Word*>(bytes.data());
    const auto mask = static_cast<Word>((std::uint64_t{1} << stored) - 1);
    const auto sign = static_cast<Word>(std::uint64_t{1} << (stored - 1));
    bool changes = false;
    for (std::size_t i = 0; i < bytes.size() / sizeof(Word); ++i) {
        const auto moved = static_cast<Word>(samples[i] >> shift);
        const auto plain = static_cast<Word>(moved & mask);
        auto value = plain;
        if (is_signed && (value & sign) != 0) value = static_cast<Word>(value | ~mask);
        changes = changes || (shift == 0 && moved != plain && moved != value);
        samples[i] = value;
    }
    return changes;
}

/// As many bytes as its kind of samples has: what follows trusts it.
Decoded checked(Decoded frame, std::size_t pixels) {
    if (frame.samples.size() != pixels * size_of(frame.stored)) {
        throw Failure("is damaged (its samples have another size than its header says)");
    }
    return frame;
}

/// A frame as it is stored, in words of this machine.
Decoded frame_from(const DicomExtent& extent, std::span<const std::byte> bytes) {
    Decoded frame;
    frame.samples = extent.is_encapsulated() ? unpacked(extent, bytes)
                                             : in_our_order(bytes, extent.swapped_bytes);
    const auto pixels = static_cast<std::size_t>(extent.rows * extent.columns);
    if (extent.is_real) {
        frame.stored = extent.bits == 32 ? Stored::float32 : Stored::float64;
        return checked(std::move(frame), pixels);
    }
    const auto word = static_cast<int>(8 * frame.samples.size() / pixels);
    const bool is_given = extent.stored_bits > 0 && extent.stored_bits <= extent.bits;
    const int stored = is_given ? static_cast<int>(extent.stored_bits) : word;
    // A stream of fewer bits than the header says has no sign.
    const bool is_signed = extent.representation == 1 && stored <= word;
    // A stream of no more bits than are stored begins at the lowest.
    const auto stream = extent.is_encapsulated() ? code_stream_size(bytes) : std::nullopt;
    const bool is_shifted = (stream ? stream->bits : extent.bits) > extent.high_bit;
    const int used = std::min(stored, word), shift = is_shifted ? extent.shift() : 0;
    frame.stored =
        stored_named((is_signed ? "int" : "uint") + std::to_string(word)).value_or(Stored::uint32);
    frame = checked(std::move(frame), pixels);
    if (used == word && shift == 0) return frame;
    const auto tidy = [&](auto zero) {
        return tidy_bits<decltype(zero)>(frame.samples, used, shift, is_signed);
    };
    frame.has_more_bits = (word == 8 && tidy(std::uint8_t{})) ||
                          (word == 16 && tidy(std::uint16_t{})) ||
                          (word == 32 && tidy(std::uint32_t{}));
    return frame;
}

/// Slope and intercept applied: whole numbers, if these are.
void rescale(Decoded& frame, double slope, double intercept) {
    if (slope == 1 && intercept == 0) return;
    const std::size_t count = frame.samples.size() / size_of(frame.stored);
    std::vector<std::byte> values(count * sizeof(double));
    auto* const to = reinterpret_cast<double*>(values.data());
    bool whole = true;
    with_stored(frame.stored, [&](auto zero) {
        const auto* from = reinterpret_cast<const decltype(zero)*>(frame.samples.data());
        for (std::size_t i = 0; i < count; ++i) {
            to[i] = static_cast<double>(from[i]) * slope + intercept;
            constexpr double most = 2147483647;
            whole = whole && to[i] == std::floor(to[i]) && std::abs(to[i]) <= most;
        }
    });
    frame.stored = Stored::float64;
    if (whole) {
        frame.stored = Stored::int32;
        std::vector<std::byte> integers(count * sizeof(std::int32_t));
        std::copy_n(to, count, reinterpret_cast<std::int32_t*>(integers.data()));
        values = std::move(integers);
    }
    frame.samples = std::move(values);
}

/// Stored numbers replaced by what the table says.
void look_up(Decoded& frame, const ValueTable& table) {
    const std::size_t count = frame.samples.size() / size_of(frame.stored);
    std::vector<std::byte> values(count * sizeof(std::uint16_t));
    auto* const to = reinterpret_cast<std::uint16_t*>(values.data());
    const double last = static_cast<double>(table.values.size() - 1);
    with_stored(frame.stored, [&](auto zero) {
        const auto* from = reinterpret_cast<const decltype(zero)*>(frame.samples.data());
        for (std::size_t i = 0; i < count; ++i) {
            const double entry = std::clamp(static_cast<double>(from[i]) - table.first, 0.0, last);
            to[i] = table.values[static_cast<std::size_t>(entry)];
        }
    });
    frame.stored = Stored::uint16;
    frame.samples = std::move(values);
}

void check_kind(const DicomExtent& extent, const DicomSlice& slice) {
    if (slice.has_colours || extent.components != 1) {
        throw Failure("has colours; give a series with one value a sample");
    }
    const bool is_read = extent.is_real || extent.bits == 1 || extent.bits == 8 ||
                         extent.bits == 16 || extent.bits == 32;
    if (extent.is_real && (extent.is_encapsulated() || slice.table)) {
        throw Failure("has floating-point samples in a form that is not read; export it again");
    }
    if (extent.bits == 1 && extent.swapped_bytes > 1) {
        throw Failure("has big-endian samples of one bit; export it again, little-endian");
    }
    if (!is_read) {
        throw Failure("has samples of " + std::to_string(extent.bits) +
                      " bits, which are not read; export it again");
    }
    if (extent.rows != slice.rows || extent.columns != slice.columns ||
        extent.frames != slice.frames) {
        throw Failure("has changed while it was read; open it again");
    }
}

/// The slices of one file, by their places in `slices`.
void decode_file(const std::vector<DicomSlice>& slices, const std::vector<std::size_t>& members,
                 const Request& request, std::vector<Decoded>& decoded) {
    const DicomSlice& one = slices[members.front()];
    say_doing(one.file.filename().string());
    const auto file_bytes = fs::file_size(one.file);
    std::vector<int> frames;
    for (const std::size_t i : members) frames.push_back(slices[i].frame);
    DicomExtent extent;
    std::optional<MemoryBound> bound;
    const auto begin = [&](const DicomExtent& found) {
        extent = found;
        check_kind(extent, one);
        const std::int64_t sizes[] = {extent.columns, extent.rows,
                                      static_cast<std::int64_t>(frames.size())};
        const auto word = static_cast<std::size_t>(extent.bits + 7) / 8;
        bound.emplace(4 * file_bytes + 24 * checked_bytes(sizes, word, file_bytes, request));
    };
    auto next = members.begin();
    read_frames(one.file, frames, begin, [&](int, std::span<const std::byte> bytes) {
        std::optional<DecoderWords> words;
        if (extent.is_encapsulated()) words.emplace();
        Decoded& frame = decoded[*next];
        const DicomSlice& slice = slices[*next++];
        frame = frame_from(extent, bytes);
        if (words) frame.decoder_said = words->said();
        if (slice.table) {
            look_up(frame, *slice.table);
        } else {
            rescale(frame, slice.slope, slice.intercept);
        }
    });
}

}  // namespace

std::vector<Decoded> decode(const std::vector<DicomSlice>& slices, const Request& request) {
    std::map<fs::path, std::vector<std::size_t>> by_file;
    for (std::size_t i = 0; i < slices.size(); ++i) by_file[slices[i].file].push_back(i);
    std::vector<Decoded> decoded(slices.size());
    std::size_t done = 0;
    for (const auto& [path, members] : by_file) {
        try {
            decode_file(slices, members, request, decoded);
        } catch (const std::bad_alloc&) {
            throw Failure(quoted(path) +
                          " needs far more memory to unpack than its samples do; it is damaged: "
                          "copy or export it again");
        } catch (const Failure& e) {
            const std::string what = e.what();
            throw Failure(what.find(quoted(path)) == std::string::npos ? quoted(path) + " " + what
                                                                       : what);
        }
        say_progress(0.1 + 0.8 * static_cast<double>(++done) / static_cast<double>(by_file.size()));
    }
    return decoded;
}

}  // namespace palpate::io
