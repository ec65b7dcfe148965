// A store over arrays in chunks; see the header.
#include "stream/chunked_store.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>

#include "palpate/io/error.hpp"
#include "stream/unpacking_room.hpp"

namespace palpate::stream {
namespace {

/// Where the samples of a chunk lie in its bytes: strides [samples] along x, y, z, and the place of
/// the fixed indices.
struct ChunkLayout {
    std::array<std::size_t, 3> stride = {0, 0, 0};
    std::size_t base = 0;
};

ChunkLayout layout_of(const ChunkedArray& array, const ChunkedVolume& volume) {
    std::vector<std::size_t> strides(array.axes());
    std::size_t stride = 1;
    for (std::size_t i = array.axes(); i-- > 0;) {
        const auto axis = static_cast<std::size_t>(array.stored_axes[i]);
        strides[axis] = stride;
        stride *= static_cast<std::size_t>(array.chunk[axis]);
    }
    ChunkLayout layout;
    for (std::size_t a = 0; a < array.axes(); ++a) {
        layout.base += strides[a] * static_cast<std::size_t>(volume.fixed[a] % array.chunk[a]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (volume.space[i] >= 0)
            layout.stride[i] = strides[static_cast<std::size_t>(volume.space[i])];
    }
    return layout;
}

constexpr std::int64_t most_searched = 1 << 28;  // samples, for the least finite one

class ChunkedStore : public Store {
  public:
    ChunkedStore(std::shared_ptr<const Objects> objects, ChunkedVolume volume,
                 std::uint64_t unpacking)
        : objects_(std::move(objects)), volume_(std::move(volume)), room_(unpacking) {
        for (const ChunkedArray& array : volume_.arrays) {
            readers_.push_back(std::make_unique<ChunkReader>(objects_, array));
            layouts_.push_back(layout_of(array, volume_));
        }
    }

    const StoreInfo& info() const override { return volume_.info; }
    Traffic traffic() const override { return objects_->traffic(); }

    void read(int level, const SampleBox& box, std::span<std::byte> out,
              std::stop_token stop) const override {
        const Level& grid = volume_.info.levels.at(static_cast<std::size_t>(level));
        check_request(grid.geometry, box, volume_.info.type, out.size());
        Index3 first, last;
        for (int a = 0; a < 3; ++a) {
            first[a] = box.low[a] / grid.chunk[a];
            last[a] = box.high[a] / grid.chunk[a];
        }
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                for (int x = first[0]; x <= last[0]; ++x) {
                    take_chunk(level, {x, y, z}, box, out, stop);
                }
            }
        }
    }

  private:
    void take_chunk(int level, const Index3& chunk, const SampleBox& box, std::span<std::byte> out,
                    std::stop_token stop) const {
        if (stop.stop_requested()) throw Cancelled{};
        const Level& grid = volume_.info.levels[static_cast<std::size_t>(level)];
        const Index3 corner = chunk.cwiseProduct(grid.chunk);
        SampleBox part;
        for (int a = 0; a < 3; ++a) {
            part.low[a] = std::max(box.low[a], corner[a]);
            part.high[a] = std::min<int>(box.high[a], corner[a] + (grid.chunk[a] - 1));
        }
        const ChunkReader& reader = *readers_[static_cast<std::size_t>(level)];
        const std::uint64_t needed = reader.array().bytes_to_read_chunk();
        if (needed > room_.most()) refuse(level, needed);
        const UnpackingRoom::Share share(room_, needed, stop);
        const auto bytes = reader.chunk(index_of(reader.array(), chunk), stop);
        copy(reader.array(), bytes, layouts_[static_cast<std::size_t>(level)], corner, part, box,
             out, stop);
    }

    [[noreturn]] void refuse(int level, std::uint64_t needed) const {
        constexpr std::uint64_t megabyte = 1000000;
        throw io::InputError(volume_.info.address + ": a chunk of level " + std::to_string(level) +
                             " takes " + std::to_string(needed / megabyte + 1) +
                             " MB to be read, and " + std::to_string(room_.most() / megabyte) +
                             " MB may be used for that; allow more memory, or store it in smaller "
                             "chunks");
    }

    std::vector<std::int64_t> index_of(const ChunkedArray& array, const Index3& chunk) const {
        std::vector<std::int64_t> index(array.axes());
        for (std::size_t a = 0; a < array.axes(); ++a) index[a] = volume_.fixed[a] / array.chunk[a];
        for (std::size_t i = 0; i < 3; ++i) {
            if (volume_.space[i] < 0) continue;
            index[static_cast<std::size_t>(volume_.space[i])] = chunk[static_cast<Eigen::Index>(i)];
        }
        return index;
    }

    /// The rows of `part`, out of a chunk whose first sample is `corner`, to their place in `box`.
    void copy(const ChunkedArray& array, const std::optional<Bytes>& chunk,
              const ChunkLayout& layout, const Index3& corner, const SampleBox& part,
              const SampleBox& box, std::span<std::byte> out, const std::stop_token& stop) const {
        const std::size_t from_size = array.bytes.size(), to_size = size_of(volume_.info.type);
        const auto row = static_cast<std::size_t>(part.high[0] - part.low[0] + 1);
        const Index3 size = box.high - box.low + Index3::Ones();
        std::vector<std::byte> raw(row * from_size), filled;
        if (!chunk) filled = fill_row(row, stop);
        for (int z = part.low[2]; z <= part.high[2]; ++z) {
            for (int y = part.low[1]; y <= part.high[1]; ++y) {
                const Index3 at = Index3(part.low[0], y, z) - box.low;
                std::byte* const to =
                    out.data() +
                    ((static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size[1]) +
                      static_cast<std::size_t>(at[1])) *
                         static_cast<std::size_t>(size[0]) +
                     static_cast<std::size_t>(at[0])) *
                        to_size;
                if (!chunk) {
                    std::memcpy(to, filled.data(), filled.size());
                    continue;
                }
                const Index3 in = Index3(part.low[0], y, z) - corner;
                std::size_t from = layout.base;
                for (std::size_t i = 0; i < 3; ++i) {
                    from += layout.stride[i] *
                            static_cast<std::size_t>(in[static_cast<Eigen::Index>(i)]);
                }
                gather(chunk->data() + from * from_size, layout.stride[0], from_size, raw);
                array.bytes.unpack(raw, to);
                const std::span<std::byte> samples{to, row * to_size};
                if (!finite_samples(volume_.info.type, samples).all) {
                    make_finite(volume_.info.type, samples, least_finite(stop));
                }
            }
        }
    }

    static void gather(const std::byte* from, std::size_t stride, std::size_t each,
                       std::span<std::byte> row) {
        if (stride == 1) {
            std::memcpy(row.data(), from, row.size());
            return;
        }
        for (std::size_t at = 0; at < row.size(); at += each, from += stride * each) {
            std::memcpy(row.data() + at, from, each);
        }
    }

    /// What takes the place of samples that are not finite: the least one of the finest level that
    /// is not too large to be searched, as in io::read_volume(). Reads it when it is first needed.
    double least_finite(const std::stop_token& stop) const {
        if (volume_.info.range) return volume_.info.range->minimum;
        const std::lock_guard lock(searching_);
        if (least_finite_) return *least_finite_;
        std::size_t level = 0;
        const auto is_large = [&] {
            return sample_count(volume_.info.levels[level].geometry) > most_searched;
        };
        while (level + 1 < readers_.size() && is_large()) ++level;
        const ChunkReader& reader = *readers_[level];
        const Level& grid = volume_.info.levels[level];
        const Index3 size = grid.geometry.size;
        double least = std::numeric_limits<double>::infinity();
        for (int z = 0; z < size[2]; z += grid.chunk[2]) {
            for (int y = 0; y < size[1]; y += grid.chunk[1]) {
                for (int x = 0; x < size[0]; x += grid.chunk[0]) {
                    least = std::min(least, least_in(reader, level, Index3(x, y, z), stop));
                }
            }
        }
        if (std::isinf(least)) {
            throw io::InputError(volume_.info.address +
                                 ": none of its samples is a finite number; export it again");
        }
        least_finite_ = least;
        return least;
    }

    /// Infinity if the chunk has no finite sample.
    double least_in(const ChunkReader& reader, std::size_t level, const Index3& corner,
                    const std::stop_token& stop) const {
        const Level& grid = volume_.info.levels[level];
        const ChunkedArray& array = reader.array();
        const auto chunk = reader.chunk(index_of(array, corner.cwiseQuotient(grid.chunk)), stop);
        if (!chunk) {
            const double fill = array.bytes.fill;
            return std::isfinite(fill) ? fill : std::numeric_limits<double>::infinity();
        }
        const ChunkLayout& layout = layouts_[level];
        const Index3 end = grid.geometry.size.cwiseMin(corner + grid.chunk) - corner;
        std::vector<std::byte> raw(static_cast<std::size_t>(end[0]) * array.bytes.size());
        std::vector<std::byte> row(static_cast<std::size_t>(end[0]) * size_of(volume_.info.type));
        double least = std::numeric_limits<double>::infinity();
        for (int z = 0; z < end[2]; ++z) {
            for (int y = 0; y < end[1]; ++y) {
                const std::size_t from = layout.base +
                                         layout.stride[2] * static_cast<std::size_t>(z) +
                                         layout.stride[1] * static_cast<std::size_t>(y);
                gather(chunk->data() + from * array.bytes.size(), layout.stride[0],
                       array.bytes.size(), raw);
                array.bytes.unpack(raw, row.data());
                least = std::min<double>(least, finite_samples(volume_.info.type, row).least);
            }
        }
        return least;
    }

    std::vector<std::byte> fill_row(std::size_t count, const std::stop_token& stop) const {
        std::vector<std::byte> row(count * size_of(volume_.info.type));
        const bool is_finite = std::isfinite(volume_.arrays[0].bytes.fill);
        const double fill = is_finite ? volume_.info.fill : least_finite(stop);
        with_type(volume_.info.type, [&](auto zero) {
            const auto value = static_cast<decltype(zero)>(fill);
            for (std::size_t i = 0; i < count; ++i) {
                std::memcpy(row.data() + i * sizeof value, &value, sizeof value);
            }
        });
        return row;
    }

    std::shared_ptr<const Objects> objects_;
    ChunkedVolume volume_;
    std::vector<std::unique_ptr<ChunkReader>> readers_;
    std::vector<ChunkLayout> layouts_;
    mutable UnpackingRoom room_;
    mutable std::mutex searching_;
    mutable std::optional<double> least_finite_;
};

}  // namespace

std::shared_ptr<const Store> chunked_store(std::shared_ptr<const Objects> objects,
                                           ChunkedVolume volume, std::uint64_t unpacking) {
    return std::make_shared<ChunkedStore>(std::move(objects), std::move(volume), unpacking);
}

}  // namespace palpate::stream
