// Recognises the content of stores. See the header.
#include "stream/formats/content.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <map>

#include "stream/box_bytes.hpp"
#include "stream/objects/objects.hpp"
#include "stream/objects/remote_objects.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t prime1 = 0x9E3779B185EBCA87U, prime2 = 0xC2B2AE3D27D4EB4FU,
                        prime3 = 0x165667B19E3779F9U, prime4 = 0x85EBCA77C2B2AE63U,
                        prime5 = 0x27D4EB2F165667C5U;
constexpr std::size_t stripe = 32;

template <class Word>
Word word_at(const std::byte* at) {
    Word word;
    std::memcpy(&word, at, sizeof word);
    return word;
}

std::uint64_t round_of(std::uint64_t lane, std::uint64_t word) {
    return std::rotl(lane + word * prime2, 31) * prime1;
}

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
    if (is_remote(info.address)) return {std::uint64_t{1} << 20, 8};  // each costs a round trip
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
    const Level& grid = store.info().levels[static_cast<std::size_t>(level)];
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
    const Level& grid = store.info().levels[static_cast<std::size_t>(level)];
    const Index3& size = grid.geometry.size;
    const Index3 piece = grid.chunk.cwiseMin(longest).cwiseMax(1);
    using Counts = Eigen::Matrix<std::uint64_t, 3, 1>;
    const Counts along = ((size.array() + piece.array() - 1) / piece.array()).cast<std::uint64_t>();
    const std::uint64_t all = along.prod();
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t begin = all / count * i, run = std::max<std::uint64_t>(all / count, 1);
        const std::uint64_t at = std::min(begin + (i + 1) * prime1 % run, all - 1);
        const Counts place(at % along[0], at / along[0] % along[1], at / along[0] / along[1]);
        const Index3 low = place.cast<int>().cwiseProduct(piece);
        take_box(hash, store, level,
                 {low, (low + piece - Index3::Ones()).cwiseMin(size - Index3::Ones())}, stop);
    }
}

}  // namespace

void ContentHash::take_stripe(const std::byte* at) {
    for (std::size_t i = 0; i < 4; ++i) {
        lanes_[i] = round_of(lanes_[i], word_at<std::uint64_t>(at + 8 * i));
    }
}

void ContentHash::take(std::span<const std::byte> bytes) {
    bytes_ += bytes.size();
    while (!bytes.empty()) {
        if (in_begun_ == 0 && bytes.size() >= stripe) {
            take_stripe(bytes.data());
            bytes = bytes.subspan(stripe);
            continue;
        }
        const std::size_t part = std::min(stripe - in_begun_, bytes.size());
        std::memcpy(begun_ + in_begun_, bytes.data(), part);
        in_begun_ = (in_begun_ + part) % stripe;
        bytes = bytes.subspan(part);
        if (in_begun_ == 0) take_stripe(begun_);
    }
}

std::uint64_t ContentHash::value() const {
    std::uint64_t hash = prime5;
    if (bytes_ >= stripe) {
        hash = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) +
               std::rotl(lanes_[3], 18);
        for (const std::uint64_t lane : lanes_) hash = (hash ^ round_of(0, lane)) * prime1 + prime4;
    }
    hash += bytes_;
    const std::byte* at = begun_;
    std::size_t left = in_begun_;
    for (; left >= 8; left -= 8, at += 8) {
        hash = std::rotl(hash ^ round_of(0, word_at<std::uint64_t>(at)), 27) * prime1 + prime4;
    }
    if (left >= 4) {
        hash = std::rotl(hash ^ word_at<std::uint32_t>(at) * prime1, 23) * prime2 + prime3;
        left -= 4;
        at += 4;
    }
    for (; left > 0; --left, ++at) {
        hash = std::rotl(hash ^ static_cast<std::uint64_t>(*at) * prime5, 11) * prime1;
    }
    hash = (hash ^ hash >> 33) * prime2;
    hash = (hash ^ hash >> 29) * prime3;
    return hash ^ hash >> 32;
}

std::string content_of(const Store& store, int level, const std::stop_token& stop) {
    const StoreInfo& info = store.info();
    const Effort effort = effort_for(info);
    ContentHash hash;
    for (const int number : {static_cast<int>(info.type), info.channel, info.time}) {
        take_value(hash, number);
    }
    constexpr std::uint64_t fewer = 8;  // of the coarser levels, which the chosen one decides
    for (int l = level; l < static_cast<int>(info.levels.size()); ++l) {
        const Geometry& grid = info.levels[static_cast<std::size_t>(l)].geometry;
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

std::uint64_t files_at(const std::string& address) {
    std::map<fs::path, struct stat> files;  // in an order that does not depend on the disk
    const auto add = [&](const fs::path& path) {
        struct stat about {};
        if (::stat(path.c_str(), &about) == 0 && S_ISREG(about.st_mode)) files[path] = about;
    };
    add(address);
    std::error_code error;
    for (fs::recursive_directory_iterator entry(address, error), end; entry != end && !error;
         entry.increment(error)) {
        add(entry->path());
    }
    if (files.empty()) return 0;
    ContentHash hash;
    for (const auto& [path, about] : files) {
        const std::string name = path.lexically_relative(address).native();
        hash.take(std::as_bytes(std::span(name)));
        take_value(hash, about.st_size);
        for (const timespec& time : {about.st_mtim, about.st_ctim}) {
            take_value(hash, time.tv_sec);
            take_value(hash, time.tv_nsec);
        }
    }
    return hash.value();
}

}  // namespace palpate::stream
