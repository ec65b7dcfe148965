// Reads samples through ITK, which applies slope and intercept. See the header.
#include <fcntl.h>
#include <itkGDCMImageIO.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <new>
#include <optional>

#include "io/helper/dicom_header.hpp"
#include "io/helper/dicom_library.hpp"
#include "io/helper/library_words.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// What a decoder prints while this lives: some go on after damage and only warn.
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
        return library_words({text, static_cast<std::size_t>(std::max<ssize_t>(size, 0))}, 120);
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

Stored stored_from(itk::IOComponentEnum type) {
    switch (type) {
        case itk::IOComponentEnum::UCHAR:
            return Stored::uint8;
        case itk::IOComponentEnum::CHAR:
            return Stored::int8;
        case itk::IOComponentEnum::USHORT:
            return Stored::uint16;
        case itk::IOComponentEnum::SHORT:
            return Stored::int16;
        case itk::IOComponentEnum::UINT:
            return Stored::uint32;
        case itk::IOComponentEnum::INT:
            return Stored::int32;
        case itk::IOComponentEnum::FLOAT:
            return Stored::float32;
        case itk::IOComponentEnum::DOUBLE:
            return Stored::float64;
        default:
            throw Failure("its sample type is not read; export it again");
    }
}

[[noreturn]] void throw_colours(const fs::path& file) {
    throw Failure(quoted(file) + " has colours; give a series with one value a sample");
}

/// All frames of a slice's file, the slope and intercept of the first one applied.
Decoded decode_file(const DicomSlice& slice, const Request& request) {
    say_doing(slice.file.filename().string());
    if (slice.has_colours) throw_colours(slice.file);  // GDCM aborts where their table is missing
    const LibraryFile readable(slice.file, slice.needs_copy);
    const auto io = itk::GDCMImageIO::New();
    io->SetFileName(readable.name());
    io->ReadImageInformation();
    if (io->GetNumberOfComponents() != 1) throw_colours(slice.file);
    Decoded decoded;
    decoded.stored = stored_from(io->GetComponentType());
    itk::ImageIORegion region(io->GetNumberOfDimensions());
    std::vector<std::int64_t> sizes;
    for (unsigned a = 0; a < io->GetNumberOfDimensions(); ++a) {
        region.SetSize(a, io->GetDimensions(a));
        sizes.push_back(static_cast<std::int64_t>(io->GetDimensions(a)));
    }
    const std::int64_t frames = sizes.size() > 2 ? sizes[2] : 1;
    if (sizes.size() < 2 || sizes.size() > 3 || sizes[0] != slice.columns ||
        sizes[1] != slice.rows || frames != slice.frames) {
        throw Failure(quoted(slice.file) + " contradicts itself about its size; copy it again");
    }
    decoded.samples.resize(
        checked_bytes(sizes, size_of(decoded.stored), fs::file_size(slice.file), request));
    io->SetIORegion(region);
    std::optional<DecoderWords> words;
    if (!slice.compression.empty()) words.emplace();
    const MemoryBound bound(4 * fs::file_size(slice.file) + 4 * decoded.samples.size());
    try {
        io->Read(decoded.samples.data());
    } catch (const std::bad_alloc&) {
        throw Failure(
            quoted(slice.file) +
            " needs far more memory to unpack than its samples do; it is damaged: copy or "
            "export it again");
    }
    if (words) decoded.decoder_said = words->said();
    decoded.slope = io->GetRescaleSlope();
    decoded.intercept = io->GetRescaleIntercept();
    return decoded;
}

/// Slope and intercept that have been applied replaced by the frame's own.
void rescale(Decoded& frame, const DicomSlice& own) {
    const auto applied = std::pair(frame.slope, frame.intercept);
    if (applied == std::pair(own.slope, own.intercept) && own.shift == 0) return;
    if (applied.first == 0) throw Failure("its frames have slopes of 0; export it again");
    const std::size_t count = frame.samples.size() / size_of(frame.stored);
    std::vector<std::byte> values(count * sizeof(double));
    auto* const to = reinterpret_cast<double*>(values.data());
    with_stored(frame.stored, [&](auto zero) {
        const auto* from = reinterpret_cast<const decltype(zero)*>(frame.samples.data());
        for (std::size_t i = 0; i < count; ++i) {
            const double stored =
                std::round((static_cast<double>(from[i]) - applied.second) / applied.first);
            to[i] = std::floor(std::ldexp(stored, -own.shift)) * own.slope + own.intercept;
        }
    });
    frame.stored = Stored::float64;
    constexpr double most = 2147483647;
    const auto is_whole = [](double v) { return v == std::floor(v) && std::abs(v) <= most; };
    if (std::all_of(to, to + count, is_whole)) {
        frame.stored = Stored::int32;
        std::vector<std::byte> whole(count * sizeof(std::int32_t));
        std::copy_n(to, count, reinterpret_cast<std::int32_t*>(whole.data()));
        values = std::move(whole);
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

Decoded frame_of(const Decoded& file, const DicomSlice& slice) {
    Decoded frame;
    frame.stored = file.stored;
    frame.decoder_said = file.decoder_said;
    frame.slope = file.slope;
    frame.intercept = file.intercept;
    const std::size_t bytes = file.samples.size() / static_cast<std::size_t>(slice.frames);
    const auto begin = file.samples.begin() +
                       static_cast<std::ptrdiff_t>(static_cast<std::size_t>(slice.frame) * bytes);
    frame.samples.assign(begin, begin + static_cast<std::ptrdiff_t>(bytes));
    return frame;
}

}  // namespace

std::vector<Decoded> decode(const std::vector<DicomSlice>& slices, const Request& request) {
    std::map<fs::path, std::vector<std::size_t>> by_file;
    for (std::size_t i = 0; i < slices.size(); ++i) by_file[slices[i].file].push_back(i);
    std::vector<Decoded> decoded(slices.size());
    std::size_t done = 0;
    for (const auto& [path, members] : by_file) {
        Decoded file = decode_file(slices[members.front()], request);
        for (const std::size_t i : members) {
            decoded[i] = slices[i].frames == 1 ? std::move(file) : frame_of(file, slices[i]);
            if (slices[i].own_values) rescale(decoded[i], slices[i]);
            if (slices[i].table) look_up(decoded[i], *slices[i].table);
        }
        say_progress(0.1 + 0.8 * static_cast<double>(++done) / static_cast<double>(by_file.size()));
    }
    return decoded;
}

}  // namespace palpate::io
