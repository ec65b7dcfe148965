// An array in chunks: keys, shards, limits. See the header.
#include "stream/formats/chunked_array.hpp"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>

#include "io/byte_order.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/n5_block.hpp"

namespace palpate::stream {
namespace {

constexpr std::size_t most_axes = 8;
constexpr double most_chunk_bytes = 1 << 30;
constexpr double most_chunks_in_shard = 1 << 20;
constexpr std::size_t most_held = 1 << 20;  // places in all indices that are kept
// Data that was damaged in transfer may be intact the next time.
constexpr int attempts_at_damage = 3, attempts_at_change = 3;
constexpr std::uint64_t not_stored = UINT64_MAX;

std::size_t product(std::span<const std::int64_t> sizes) {
    std::size_t count = 1;
    for (const std::int64_t size : sizes) count *= static_cast<std::size_t>(size);
    return count;
}

/// Also an index that is not there takes some memory.
template <class Index>
std::size_t places_in(const Index& index) {
    return 64 + (index ? index->places.size() : 0);
}

}  // namespace

double rough_product(std::span<const std::int64_t> sizes) {
    double count = 1;
    for (const std::int64_t size : sizes) count *= static_cast<double>(size);
    return count;
}

std::size_t ChunkedArray::samples_in_chunk() const {
    return product(chunk);
}

std::uint64_t ChunkedArray::bytes_to_read_chunk() const {
    constexpr std::uint64_t index_entry = 3 * 16;  // as stored, unpacked, and as numbers
    const std::uint64_t index = shards ? index_entry * product(shards->chunks) : 0;
    return (codecs.empty() ? 1 : 2) * bytes_in_chunk() + index;
}

std::string key_of(const ChunkedArray& array, std::span<const std::int64_t> object) {
    std::string key = array.folder + (array.folder.empty() ? "" : "/") + array.prefix;
    for (std::size_t i = 0; i < object.size(); ++i) {
        if (i > 0) key += array.separator;
        key += std::to_string(object[array.n5_blocks ? object.size() - 1 - i : i]);
    }
    return key;
}

void check(const ChunkedArray& array) {
    const std::size_t axes = array.axes();
    if (axes < 1 || axes > most_axes || array.chunk.size() != axes ||
        array.stored_axes.size() != axes) {
        throw std::invalid_argument(
            "its axes and those of its chunks do not agree, or are not 1 to 8");
    }
    for (std::size_t a = 0; a < axes; ++a) {
        if (array.shape[a] < 1 || array.shape[a] > std::int64_t{1} << 40 || array.chunk[a] < 1 ||
            array.chunk[a] > 1 << 30) {
            throw std::invalid_argument("a size in its metadata is not possible");
        }
    }
    if (rough_product(array.chunk) * static_cast<double>(array.bytes.size()) > most_chunk_bytes) {
        throw std::invalid_argument(
            "its chunks have more than 1 GiB each; store it in smaller ones");
    }
    if (!array.shards) return;
    for (const std::int64_t count : array.shards->chunks) {
        if (count < 1) throw std::invalid_argument("its shards are no whole number of chunks");
    }
    if (array.shards->chunks.size() != axes ||
        rough_product(array.shards->chunks) > most_chunks_in_shard) {
        throw std::invalid_argument("its shards have more than 2^20 chunks each, or other axes");
    }
}

Bytes unpacked_chunk(const ChunkedArray& array, Bytes packed, std::uint64_t skipped) {
    if (array.n5_blocks) return unpacked_n5_block(array, packed);
    std::vector<Codec> used;
    for (std::size_t i = 0; i < array.codecs.size(); ++i) {
        if (i >= 64 || (skipped >> i & 1) == 0) used.push_back(array.codecs[i]);
    }
    return decoded(
        used, std::move(packed), array.bytes_in_chunk(),
        {array.bytes.size(), static_cast<std::size_t>(array.chunk.back()), array.bytes.swapped});
}

ChunkReader::ChunkReader(std::shared_ptr<const Objects> objects, ChunkedArray array)
    : objects_(std::move(objects)), array_(std::move(array)) {
    check(array_);
}

/// What `unpack` makes of an object's bytes, which errors call `part` and `what`. Nothing if there
/// is no such object.
template <class Unpack>
auto ChunkReader::unpacked(Wanted wanted, const std::string& part, const std::string& what,
                           const std::stop_token& stop, const Unpack& unpack) const {
    using Unpacked = decltype(unpack(Bytes{}));
    for (int attempt = 1;; ++attempt) {
        wanted.again = wanted.again || attempt > 1;
        const bool is_empty = wanted.range && wanted.range->length == 0;
        auto bytes = is_empty ? Bytes{} : objects_->get(wanted, stop);
        if (!bytes) return std::optional<Unpacked>();
        try {
            return std::optional<Unpacked>(unpack(*std::move(bytes)));
        } catch (const UnreadChunk& e) {
            throw io::InputError(objects_->name_of(wanted.key) + ": " + part + e.what());
        } catch (const DamagedChunk& e) {
            if (attempt < attempts_at_damage) continue;
            throw io::InputError(objects_->name_of(wanted.key) + ": " + part + e.what() + "; the " +
                                 what + " is damaged: copy it again");
        }
    }
}

std::optional<Bytes> ChunkReader::chunk(std::span<const std::int64_t> index,
                                        std::stop_token stop) const {
    if (!array_.shards) return chunk_at({key_of(array_, index)}, nullptr, false, stop);
    if (!array_.shards->file) return chunk_in_shard(index, stop);
    const auto place = place_in_shard(index, false, stop);
    return place ? chunk_at(*place, nullptr, false, stop) : std::nullopt;
}

/// Between its index and a chunk of it, a shard may be written anew.
std::optional<Bytes> ChunkReader::chunk_in_shard(std::span<const std::int64_t> index,
                                                 const std::stop_token& stop) const {
    auto place = place_in_shard(index, false, stop);
    for (int attempt = 1; place; ++attempt) {
        std::optional<Bytes> bytes;
        std::exception_ptr problem;
        std::string identity = place->identity;
        try {
            bytes = chunk_at(*place, &identity, attempt > 1, stop);
        } catch (const io::InputError&) {  // perhaps of the old index
            problem = std::current_exception();
        }
        if (bytes && identity == place->identity) return bytes;
        auto now = place_in_shard(index, true, stop);
        const bool same = now && now->range->offset == place->range->offset &&
                          now->range->length == place->range->length;
        if (same && problem) std::rethrow_exception(problem);
        if (same && (!bytes || identity == now->identity)) return bytes;
        if (attempt == attempts_at_change) {
            if (same) return bytes;  // several servers, which do not agree on the identity
            throw io::InputError(objects_->name_of(place->key) +
                                 ": changes while it is read; wait until it is complete");
        }
        place = std::move(now);
    }
    return std::nullopt;
}

std::optional<Bytes> ChunkReader::chunk_at(const Place& place, std::string* identity, bool again,
                                           const std::stop_token& stop) const {
    const std::uint64_t most = packed_at_most(array_.bytes_in_chunk());
    const auto& range = place.range;
    if (range && (range->length > most || range->offset > UINT64_MAX / 2)) {
        throw io::InputError(
            objects_->name_of(place.key) +
            ": a chunk of it has an impossible place; it is damaged: copy it again");
    }
    return unpacked({.key = place.key,
                     .range = range,
                     .most = most,
                     .lasting = true,
                     .again = again,
                     .identity = identity},
                    "", "chunk", stop, [&](Bytes packed) {
                        return unpacked_chunk(array_, std::move(packed), place.skipped);
                    });
}

/// In a file, shards end where the array ends.
std::int64_t ChunkReader::chunks_of(const Shard& shard, std::size_t axis) const {
    const std::int64_t most = array_.shards->chunks[axis];
    const std::int64_t all = (array_.shape[axis] - 1) / array_.chunk[axis] + 1;
    return array_.shards->file ? std::min(most, all - shard[axis] * most) : most;
}

std::optional<ChunkReader::Place> ChunkReader::place_in_shard(std::span<const std::int64_t> index,
                                                              bool again,
                                                              const std::stop_token& stop) const {
    Shard shard(index.begin(), index.end());
    std::size_t inside = 0;
    for (const int axis : array_.shards->axes) {
        const auto a = static_cast<std::size_t>(axis);
        const std::int64_t at = index[a] % array_.shards->chunks[a];
        shard[a] /= array_.shards->chunks[a];
        inside = inside * static_cast<std::size_t>(chunks_of(shard, a)) + std::size_t(at);
    }
    const Index found = index_of(shard, again, stop);
    if (!found) return std::nullopt;
    const auto& [offset, length, skipped] = found->places[inside];
    if (offset == not_stored && length == not_stored) return std::nullopt;
    const bool in_file = array_.shards->file != nullptr;
    return Place{in_file ? array_.folder : key_of(array_, shard), ByteRange{offset, length},
                 skipped, found->identity};
}

ChunkReader::Index ChunkReader::index_of(const Shard& shard, bool again,
                                         const std::stop_token& stop) const {
    std::unique_lock lock(mutex_);
    const auto is_free = [&] { return !fetching_.contains(shard); };
    if (!is_free() && !fetched_.wait(lock, stop, is_free)) throw Cancelled{};
    const auto found = indices_.find(shard);
    if (found != indices_.end() && !again) return found->second;
    fetching_.insert(shard);
    lock.unlock();
    const auto end = [&] {
        lock.lock();
        fetching_.erase(shard);
        fetched_.notify_all();
    };
    Index index;
    try {
        index =
            array_.shards->file ? located_index(shard, stop) : fetched_index(shard, again, stop);
    } catch (...) {
        end();
        throw;
    }
    end();
    keep(shard, index);
    return index;
}

/// Needs the lock.
void ChunkReader::keep(const Shard& shard, const Index& index) const {
    const auto [kept, is_new] = indices_.emplace(shard, index);
    if (!is_new) held_ -= places_in(std::exchange(kept->second, index));
    if (is_new) order_.push_back(shard);
    held_ += places_in(index);
    while (held_ > most_held && order_.size() > 1) {
        const auto oldest = indices_.find(order_.front());
        held_ -= places_in(oldest->second);
        indices_.erase(oldest);
        order_.pop_front();
    }
}

ChunkReader::Index ChunkReader::located_index(const Shard& shard,
                                              const std::stop_token& stop) const {
    const Shards& shards = *array_.shards;
    std::array<std::int64_t, 3> first{}, count{};
    for (std::size_t a = 0; a < 3; ++a) {
        first[a] = shard[a] * shards.chunks[a];
        count[a] = chunks_of(shard, a);
    }
    const auto index = std::make_shared<ShardIndex>();
    {
        const UnpackingRoom::Share turn(shards.file->turn, 1, stop);
        index->places = shards.file->file.locate(shards.id, first, count, stop);
    }
    for (io::ChunkPlace& place : index->places) {
        if (place.length == 0) place.offset = place.length = not_stored;
    }
    return index;
}

ChunkReader::Index ChunkReader::fetched_index(const Shard& shard, bool again,
                                              const std::stop_token& stop) const {
    const std::size_t size = 16 * product(array_.shards->chunks);
    std::size_t stored = size;
    for (const Codec codec : array_.shards->index_codecs) {
        if (codec == Codec::crc32c) stored += 4;
    }
    const ByteRange range{0, stored, !array_.shards->index_at_start};
    std::string identity;
    const auto unpack = [&](Bytes packed) {
        const Bytes plain = decoded(array_.shards->index_codecs, std::move(packed), size);
        const auto index = std::make_shared<ShardIndex>();
        index->identity = identity;
        const auto number = [&](std::size_t at) {
            const auto bytes = std::span(plain).subspan(at);
            return array_.shards->is_index_big_endian ? io::big_endian<std::uint64_t>(bytes)
                                                      : io::little_endian<std::uint64_t>(bytes);
        };
        for (std::size_t at = 0; at < size; at += 16) {
            index->places.push_back({number(at), number(at + 8)});
        }
        return Index(index);
    };
    return unpacked({.key = key_of(array_, shard),
                     .range = range,
                     .most = stored,
                     .lasting = true,
                     .again = again,
                     .identity = &identity},
                    "its index ", "shard", stop, unpack)
        .value_or(nullptr);
}

}  // namespace palpate::stream
