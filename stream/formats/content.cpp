// Recognises the content of stores. See the header.
#include "stream/formats/content.hpp"

#define XXH_INLINE_ALL
#include <sys/stat.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "io/system/leftovers.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/objects/objects.hpp"
#include "stream/objects/remote_objects.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;

/// XXH64, seed 0 (https://github.com/Cyan4973/xxHash): fast, well spread, no protection against
/// somebody who wants two contents to look alike.
class ContentHash {
  public:
    ContentHash() { XXH64_reset(&state_, 0); }
    void take(std::span<const std::byte> bytes) {
        XXH64_update(&state_, bytes.data(), bytes.size());
    }
    std::uint64_t value() const { return XXH64_digest(&state_); }

  private:
    XXH64_state_t state_;
};

template <class T>
void take_value(ContentHash& hash, const T& value) {
    hash.take(std::as_bytes(std::span(&value, 1)));
}

/// How much is read of a level.
struct Effort {
    std::uint64_t whole;  ///< [bytes] at most, else pieces
    std::uint64_t pieces;
};

Effort effort_for(const StoreInfo& info) {
    if (info.format == "memory") return {UINT64_MAX, 0};
    if (io::is_web_address(info.address))
        return {std::uint64_t{1} << 20, 8};  // each costs a round trip
    return {std::uint64_t{64} << 20, 64};
}

void take_box(ContentHash& hash, const Store& store, int level, const SampleBox& box,
              const std::stop_token& stop) {
    Bytes samples(bytes_of(box, store.info().type));
    store.read(level, box, samples, stop);
    hash.take(samples);
}

/// All samples, some planes at a time.
void take_whole(ContentHash& hash, const Store& store, int level, const std::stop_token& stop) {
    const Level& grid = level_of(store, level);
    const Index3 last = grid.geometry.size - Index3::Ones();
    const std::uint64_t plane = bytes_of({{0, 0, 0}, {last[0], last[1], 0}}, store.info().type);
    constexpr std::uint64_t at_a_time = std::uint64_t{16} << 20;
    const int most = static_cast<int>(std::clamp<std::uint64_t>(at_a_time / plane, 1, 1 << 20));
    const int planes = std::clamp(grid.chunk[2], 1, most);
    for (int z = 0; z <= last[2]; z += planes) {
        take_box(hash, store, level,
                 {{0, 0, z}, {last[0], last[1], std::min(z + planes - 1, last[2])}}, stop);
    }
}

/// One of each of `count` runs of pieces, at a place in the run that looks like chance.
void take_pieces(ContentHash& hash, const Store& store, int level, std::uint64_t count,
                 const std::stop_token& stop) {
    constexpr int longest = 64;  // [samples]
    constexpr std::uint64_t prime = 0x9E3779B185EBCA87U;
    const Level& grid = level_of(store, level);
    const Index3& size = grid.geometry.size;
    const Index3 piece = grid.chunk.cwiseMin(longest).cwiseMax(1);
    using Counts = Eigen::Matrix<std::uint64_t, 3, 1>;
    const Counts along = ((size.array() + piece.array() - 1) / piece.array()).cast<std::uint64_t>();
    const std::uint64_t all = along.prod();
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t begin = all / count * i, run = std::max<std::uint64_t>(all / count, 1);
        const std::uint64_t at = std::min(begin + (i + 1) * prime % run, all - 1);
        const Counts place(at % along[0], at / along[0] % along[1], at / along[0] / along[1]);
        const Index3 low = place.cast<int>().cwiseProduct(piece);
        take_box(hash, store, level,
                 {low, (low + piece - Index3::Ones()).cwiseMin(size - Index3::Ones())}, stop);
    }
}

}  // namespace

std::string content_of(const Store& store, int level, const std::stop_token& stop) {
    const StoreInfo& info = store.info();
    const Effort effort = effort_for(info);
    ContentHash hash;
    for (const int number : {static_cast<int>(info.type), info.channel, info.time}) {
        take_value(hash, number);
    }
    constexpr std::uint64_t fewer = 8;  // of the coarser levels, which the chosen one decides
    for (int l = level; l < static_cast<int>(info.levels.size()); ++l) {
        const Geometry& grid = level_of(store, l).geometry;
        for (const int size : grid.size) take_value(hash, size);
        for (const double spacing : grid.spacing) take_value(hash, spacing);
        for (const double origin : grid.origin) take_value(hash, origin);
        for (const double part : grid.direction.reshaped()) take_value(hash, part);
        const std::uint64_t bytes =
            bytes_of({Index3::Zero(), grid.size - Index3::Ones()}, info.type);
        if (bytes <= effort.whole) {
            take_whole(hash, store, l, stop);
        } else {
            take_pieces(hash, store, l, l == level ? effort.pieces : effort.pieces / fewer, stop);
        }
    }
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx",
                  static_cast<unsigned long long>(hash.value()));
    return text.data();
}

void fail_changed(const Store& store) {
    throw io::InputError(store.info().address +
                         ": changed while it was converted; run it again when it stays as it is");
}

std::uint64_t files_at(const std::string& address, const std::stop_token& stop) {
    std::uint64_t sum = 0;  // there may be millions of files, which the disk lists in any order
    const auto add = [&](const fs::path& path) {
        if (io::is_temporary(path.filename().native())) return;  // of an output beside them
        struct stat about {};
        if (::stat(path.c_str(), &about) != 0 || !S_ISREG(about.st_mode)) return;
        const std::string_view name = std::string_view(path.native()).substr(address.size());
        ContentHash hash;
        hash.take(std::as_bytes(std::span(name)));
        take_value(hash, about.st_size);
        for (const timespec& time : {about.st_mtim, about.st_ctim}) {
            take_value(hash, time.tv_sec);
            take_value(hash, time.tv_nsec);
        }
        sum += hash.value();
    };
    add(address);
    std::error_code error;
    for (fs::recursive_directory_iterator entry(address, error), end; entry != end && !error;
         entry.increment(error)) {
        if (stop.stop_requested()) throw Cancelled{};
        add(entry->path());
    }
    return sum;
}

}  // namespace palpate::stream
