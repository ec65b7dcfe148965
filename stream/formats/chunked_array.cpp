// An array in chunks: keys, shards, limits. See the header.
#include "stream/formats/chunked_array.hpp"

#include <stdexcept>

#include "palpate/io/error.hpp"
#include "stream/formats/n5_block.hpp"

namespace palpate::stream {
namespace {

constexpr std::size_t most_axes = 8;
constexpr double most_chunk_bytes = 1 << 30;
constexpr double most_chunks_in_shard = 1 << 20;
constexpr std::size_t most_held = 1 << 22;  // numbers in all indices that are kept
// What was damaged on its way may come whole the next time.
constexpr int attempts_at_damage = 3;
constexpr std::uint64_t not_stored = UINT64_MAX;

std::size_t product(std::span<const std::int64_t> sizes) {
    std::size_t count = 1;
    for (const std::int64_t size : sizes) count *= static_cast<std::size_t>(size);
    return count;
}

double rough_product(std::span<const std::int64_t> sizes) {
    double count = 1;
    for (const std::int64_t size : sizes) count *= static_cast<double>(size);
    return count;
}

/// Also an index that is not there takes some memory.
std::size_t numbers_in(const std::shared_ptr<const std::vector<std::uint64_t>>& index) {
    return 64 + (index ? index->size() : 0);
}

}  // namespace

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

std::optional<Bytes> ChunkReader::chunk(std::span<const std::int64_t> index,
                                        std::stop_token stop) const {
    for (int attempt = 1;; ++attempt) {
        Packed got = packed(index, attempt > 1, stop);
        if (!got.bytes) return std::nullopt;
        try {
            return unpacked_chunk(array_, *std::move(got.bytes), got.skipped);
        } catch (const DamagedChunk& e) {
            if (attempt < attempts_at_damage) continue;
            throw io::InputError(objects_->name_of(got.key) + ": " + e.what() +
                                 "; the chunk is damaged: copy it again");
        }
    }
}

ChunkReader::Packed ChunkReader::packed(std::span<const std::int64_t> index, bool again,
                                        std::stop_token stop) const {
    if (array_.shards) return packed_in_shard(index, again, std::move(stop));
    if (array_.table) return packed_in_file(index, again, std::move(stop));
    const std::string key = key_of(array_, index);
    const std::uint64_t most = packed_at_most(array_.bytes_in_chunk());
    return {key, objects_->get({key, std::nullopt, most, true, again}, std::move(stop))};
}

ChunkReader::Packed ChunkReader::packed_in_shard(std::span<const std::int64_t> index, bool again,
                                                 std::stop_token stop) const {
    std::vector<std::int64_t> shard(index.begin(), index.end());
    std::size_t inside = 0;
    for (std::size_t a = 0; a < shard.size(); ++a) {
        const std::int64_t count = array_.shards->chunks[a];
        inside =
            inside * static_cast<std::size_t>(count) + static_cast<std::size_t>(index[a] % count);
        shard[a] /= count;
    }
    const std::string key = key_of(array_, shard);
    const Index places = index_of(key, stop);
    if (!places) return {key, std::nullopt};
    const std::uint64_t offset = (*places)[2 * inside], length = (*places)[2 * inside + 1];
    if (offset == not_stored && length == not_stored) return {key, std::nullopt};
    if (length == 0) return {key, Bytes{}};
    const std::uint64_t most = packed_at_most(array_.bytes_in_chunk());
    if (length > most || offset > UINT64_MAX / 2) {
        throw io::InputError(objects_->name_of(key) +
                             ": its index is not possible; the shard is damaged: copy it again");
    }
    return {key, objects_->get({key, ByteRange{offset, length}, most, true, again}, stop)};
}

ChunkReader::Packed ChunkReader::packed_in_file(std::span<const std::int64_t> index, bool again,
                                                std::stop_token stop) const {
    const std::string& key = array_.folder;
    const auto place = array_.table->find(index, stop);
    if (!place) return {key, std::nullopt};
    const std::uint64_t most = packed_at_most(array_.bytes_in_chunk());
    if (place->length > most || place->offset > UINT64_MAX / 2) {
        throw io::InputError(
            objects_->name_of(key) +
            ": a chunk of it lies where none can be; it is damaged: copy it again");
    }
    const ByteRange range{place->offset, place->length};
    return {key, objects_->get({key, range, most, true, again}, stop), place->skipped};
}

ChunkReader::Index ChunkReader::index_of(const std::string& shard, std::stop_token stop) const {
    {
        const std::lock_guard lock(mutex_);
        const auto found = indices_.find(shard);
        if (found != indices_.end()) return found->second;
    }
    const Index index = fetched_index(shard, std::move(stop));
    const std::lock_guard lock(mutex_);
    if (!indices_.emplace(shard, index).second) return index;
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

ChunkReader::Index ChunkReader::fetched_index(const std::string& shard,
                                              std::stop_token stop) const {
    const std::size_t size = 16 * product(array_.shards->chunks);
    std::size_t stored = size;
    for (const Codec codec : array_.shards->index_codecs) {
        if (codec == Codec::crc32c) stored += 4;
    }
    const ByteRange range{0, stored, !array_.shards->index_at_start};
    for (int attempt = 1;; ++attempt) {
        auto bytes = objects_->get({shard, range, stored, true, attempt > 1}, stop);
        if (!bytes) return nullptr;
        try {
            const Bytes plain = decoded(array_.shards->index_codecs, *std::move(bytes), size);
            auto places = std::make_shared<std::vector<std::uint64_t>>(size / 8);
            for (std::size_t i = 0; i < places->size(); ++i) {
                (*places)[i] = little_endian(std::span(plain).subspan(8 * i, 8));
            }
            return places;
        } catch (const DamagedChunk& e) {
            if (attempt < attempts_at_damage) continue;
            throw io::InputError(objects_->name_of(shard) + ": its index " + e.what() +
                                 "; the shard is damaged: copy it again");
        }
    }
}

}  // namespace palpate::stream
