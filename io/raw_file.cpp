// Reads and writes headerless files. See the header.
#include "io/raw_file.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include "io/byte_order.hpp"
#include "io/file_grid.hpp"
#include "io/finite.hpp"
#include "io/inflate.hpp"
#include "io/system/system.hpp"
#include "palpate/io/orientation.hpp"
#include "palpate/io/output.hpp"

namespace palpate::io {
namespace {

static_assert(std::endian::native == std::endian::little, "so are raw files, unless they say");

std::string layout_text(const RawLayout& raw) {
    return std::to_string(raw.size[0]) + "x" + std::to_string(raw.size[1]) + "x" +
           std::to_string(raw.size[2]) + " of " + std::string(name_of(raw.type)) +
           (raw.skip > 0 ? " after " + std::to_string(raw.skip) + " bytes" : "");
}

/// Copies a stream of bytes into the samples: skips some, fills, and counts the rest.
class Filler {
  public:
    Filler(std::byte* samples, std::uint64_t bytes, std::uint64_t skip, const Progress& progress)
        : samples_(samples), bytes_(bytes), skip_(skip), progress_(progress) {}

    void operator()(std::span<const std::byte> chunk) {
        const std::uint64_t begin = std::max(seen_, skip_);
        const std::uint64_t end = std::min(seen_ + chunk.size(), skip_ + bytes_);
        if (begin < end) {
            std::memcpy(samples_ + (begin - skip_), chunk.data() + (begin - seen_), end - begin);
        }
        seen_ += chunk.size();
        if (progress_ && bytes_ > 0) {
            progress_(
                std::min(1.0, static_cast<double>(seen_) / static_cast<double>(skip_ + bytes_)));
        }
    }

  private:
    std::byte* samples_;
    std::uint64_t bytes_, skip_;
    const Progress& progress_;
    std::uint64_t seen_ = 0;
};

void read_plain(const std::filesystem::path& path, Filler& fill) {
    errno = 0;
    std::ifstream in(path, std::ios::binary);
    std::vector<std::byte> chunk(1 << 20);
    while (in) {
        in.read(reinterpret_cast<char*>(chunk.data()), static_cast<std::streamsize>(chunk.size()));
        fill({chunk.data(), static_cast<std::size_t>(in.gcount())});
    }
    if (!in.is_open() || in.bad()) {
        throw InputError(path.string() + ": cannot be read (" + reason(errno) + ")" +
                         (errno == EIO ? "; check the disk" : ""));
    }
}

void check_size(const std::filesystem::path& path, const RawLayout& raw, std::uint64_t expected,
                std::uint64_t found, bool unpacked) {
    if (found == expected) return;
    throw InputError(path.string() + ": " + (unpacked ? "unpacks to " : "has ") +
                     std::to_string(found) + " bytes, but " + layout_text(raw) + " needs " +
                     std::to_string(expected) + "; correct its dims or type");
}

/// Returns how many bytes there are; stops soon after the first one that is too many.
std::uint64_t unpack(const std::filesystem::path& path, const RawLayout& raw,
                     std::uint64_t expected, Filler& fill) {
    try {
        return inflate_checked(path, {0, UINT64_MAX, expected + 4096}, std::ref(fill));
    } catch (const OversizedStream&) {
        throw InputError(path.string() + ": unpacks to more than the " + std::to_string(expected) +
                         " bytes that " + layout_text(raw) + " needs; correct its dims or type");
    } catch (const DamagedStream& e) {
        throw InputError(path.string() + ": " + e.what() + "; copy or download it again");
    }
}

/// Bytes from the first of the file to the last sample; refuses layouts that make no sense.
std::uint64_t expected_bytes(const std::filesystem::path& path, const RawLayout& raw,
                             std::uint64_t limit) {
    Geometry geometry;
    geometry.size = raw.size;
    geometry.spacing = raw.spacing;
    if (const std::string why = why_no_file_grid(geometry); !why.empty()) {
        throw InputError(path.string() + ": " + layout_text(raw) + ": " + why);
    }
    const auto samples = static_cast<double>(sample_count(geometry));
    const double bytes = samples * static_cast<double>(size_of(raw.type));
    if (limit > 0 && bytes > static_cast<double>(limit)) {
        throw InputError(path.string() + ": " + layout_text(raw) +
                         " needs more memory than there is; correct its dims or use a machine with "
                         "more memory");
    }
    return raw.skip + static_cast<std::uint64_t>(sample_count(geometry)) * size_of(raw.type);
}

}  // namespace

RawLayout checked_layout(const std::filesystem::path& path, const ReadOptions& options) {
    RawLayout raw = *options.raw;
    if (options.spacing) raw.spacing = *options.spacing;
    const std::uint64_t expected = expected_bytes(path, raw, options.memory_limit_bytes);
    if (!is_gzip(path)) check_size(path, raw, expected, std::filesystem::file_size(path), false);
    return raw;
}

Geometry geometry_of(const RawLayout& raw, const ReadOptions& options) {
    Geometry geometry;
    geometry.size = raw.size;
    geometry.spacing = raw.spacing;
    geometry.oriented = false;
    geometry.measured = raw.spacing != Vec3::Ones();
    put_in({options.spacing, options.orientation}, geometry);
    return geometry;
}

VolumeFile read_raw(const std::filesystem::path& path, const ReadOptions& options) {
    if (options.time_step != 0) {
        throw InputError(path.string() + ": a raw file holds one volume; use time step 0");
    }
    const RawLayout raw = checked_layout(path, options);
    const std::uint64_t expected = expected_bytes(path, raw, options.memory_limit_bytes);
    const std::uint64_t bytes = expected - raw.skip;
    const bool packed = is_gzip(path);
    const auto samples = fresh_memory(bytes);
    Filler fill(samples.get(), bytes, raw.skip, options.progress);
    if (packed) {
        check_size(path, raw, expected, unpack(path, raw, expected, fill), true);
    } else {
        read_plain(path, fill);
    }
    if (raw.big_endian) swap_bytes({samples.get(), bytes}, size_of(raw.type));
    std::vector<std::string> notes;
    if (raw.type == SampleType::float32) {
        const auto count =
            replace_non_finite({reinterpret_cast<float*>(samples.get()), bytes / sizeof(float)});
        if (count == bytes / sizeof(float)) {
            throw InputError(path.string() +
                             ": no sample is a finite number; check its type and byte order");
        }
        if (count > 0) notes.push_back(non_finite_note(count));
    }
    return {Volume(geometry_of(raw, options), raw.type, samples, bytes),
            packed ? "raw, gzip" : "raw", 1, std::move(notes)};
}

void write_raw(const Volume& volume, const std::filesystem::path& path, const Progress& progress) {
    PendingFile file(path);
    const std::string_view all(static_cast<const char*>(volume.data()), volume.bytes());
    constexpr std::size_t chunk = 1 << 20;
    for (std::size_t at = 0; at < all.size(); at += chunk) {
        file.write(all.substr(at, chunk));
        if (progress) {
            progress(
                std::min(1.0, static_cast<double>(at + chunk) / static_cast<double>(all.size())));
        }
    }
    file.commit();
}

}  // namespace palpate::io
