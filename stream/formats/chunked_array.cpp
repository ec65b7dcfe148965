// An array in chunks: keys, shards, limits. See the header.
#include "stream/formats/chunked_array.hpp"

#include <exception>
#include <stdexcept>

#include "io/byte_order.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/n5_block.hpp"

namespace palpate::stream {
namespace {

constexpr std::size_t most_axes = 8;
constexpr double most_chunk_bytes = 1 << 30;
constexpr double most_chunks_in_shard = 1 << 20;
constexpr std::size_t most_held = 1 << 22;  // numbers in all indices that are kept
// What was damaged on its way may come whole the next time.
constexpr int attempts_at_damage = 3, attempts_at_change = 3;
constexpr std::uint64_t not_stored = UINT64_MAX;

std::size_t product(std::span<const std::int64_t> sizes) {
    std::size_t count = 1;
    for (const std::int64_t size : sizes) count *= static_cast<std::size_t>(size);
    return count;
}

/// Also an index that is not there takes some memory.
template <class Index>
std::size_t numbers_in(const Index& index) {
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
    if (array_.shards) return chunk_in_shard(index, stop);
    const auto place = place_of(index, stop);
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
            ": a chunk of it lies where none can be; it is damaged: copy it again");
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

std::optional<ChunkReader::Place> ChunkReader::place_of(std::span<const std::int64_t> index,
                                                        const std::stop_token& stop) const {
    if (!array_.table) return Place{key_of(array_, index)};
    const auto found = array_.table->find(index, stop);
    if (!found) return std::nullopt;
    return Place{array_.folder, ByteRange{found->offset, found->length}, found->skipped};
}

std::optional<ChunkReader::Place> ChunkReader::place_in_shard(std::span<const std::int64_t> index,
                                                              bool again,
                                                              const std::stop_token& stop) const {
    std::vector<std::int64_t> shard(index.begin(), index.end());
    std::size_t inside = 0;
    for (const int axis : array_.shards->axes) {
        const auto a = static_cast<std::size_t>(axis);
        const std::int64_t count = array_.shards->chunks[a];
        inside =
            inside * static_cast<std::size_t>(count) + static_cast<std::size_t>(index[a] % count);
        shard[a] /= count;
    }
    const std::string key = key_of(array_, shard);
    const Index found = index_of(key, again, stop);
    if (!found) return std::nullopt;
    const ByteRange range{found->places[2 * inside], found->places[2 * inside + 1]};
    if (range.offset == not_stored && range.length == not_stored) return std::nullopt;
    return Place{.key = key, .range = range, .identity = found->identity};
}

ChunkReader::Index ChunkReader::index_of(const std::string& shard, bool again,
                                         const std::stop_token& stop) const {
    if (!again) {
        const std::lock_guard lock(mutex_);
        const auto found = indices_.find(shard);
        if (found != indices_.end()) return found->second;
    }
    const Index index = fetched_index(shard, again, stop);
    const std::lock_guard lock(mutex_);
    const auto [kept, is_new] = indices_.emplace(shard, index);
    if (!is_new) {  // as long as the one before, unless that shard was not there
        held_ += numbers_in(index) - numbers_in(kept->second);
        kept->second = index;
        return index;
    }
    order_.push_back(shard);
    held_ += numbers_in(index);
    while (held_ > most_held && order_.size() > 1) {
        const auto oldest = indices_.find(order_.front());
        held_ -= numbers_in(oldest->second);
        indices_.erase(oldest);
        order_.pop_front();
    }
    return index;
}

ChunkReader::Index ChunkReader::fetched_index(const std::string& shard, bool again,
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
        for (std::size_t at = 0; at < size; at += 8) {
            index->places.push_back(io::little_endian<std::uint64_t>(std::span(plain).subspan(at)));
        }
        return Index(index);
    };
    return unpacked({.key = shard,
                     .range = range,
                     .most = stored,
                     .lasting = true,
                     .again = again,
                     .identity = &identity},
                    "its index ", "shard", stop, unpack)
        .value_or(nullptr);
}

}  // namespace palpate::stream
