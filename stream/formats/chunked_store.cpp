// A store over arrays in chunks. See the header.
#include "stream/formats/chunked_store.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/unpacking_room.hpp"

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

class ChunkedStore : public Store {
  public:
    ChunkedStore(std::shared_ptr<const Objects> objects, ChunkedVolume volume,
                 std::uint64_t unpacking)
        : objects_(std::move(objects)), volume_(std::move(volume)), room_(unpacking) {
        const std::string note = objects_->note();
        if (!note.empty()) volume_.info.notes.push_back(note);
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
        const std::size_t each = size_of(volume_.info.type);
        for_each_piece(grid.chunk, box, [&](const Index3& chunk, const SampleBox&) {
            for_each_row(level, chunk, box, stop, [&](const Index3& first, const auto& put) {
                put(out.data() + place_in(box, first) * each);
            });
        });
        if (!finite_samples(volume_.info.type, out).all) {
            make_finite(volume_.info.type, out, least_finite(stop));
        }
    }

  private:
    /// Calls take(index of the first sample, put) for each row of a chunk inside `box`. put(to)
    /// puts the samples of the row there. Those that are not finite stay.
    template <class Take>
    void for_each_row(int level, const Index3& chunk, const SampleBox& box,
                      const std::stop_token& stop, const Take& take) const {
        if (stop.stop_requested()) throw Cancelled{};
        const Level& grid = volume_.info.levels[static_cast<std::size_t>(level)];
        const ChunkLayout& layout = layouts_[static_cast<std::size_t>(level)];
        const Index3 corner = chunk.cwiseProduct(grid.chunk);
        const Index3 low = box.low.cwiseMax(corner);
        const Index3 high = box.high.cwiseMin(corner + grid.chunk - Index3::Ones());
        const ChunkReader& reader = *readers_[static_cast<std::size_t>(level)];
        const ChunkedArray& array = reader.array();
        const std::uint64_t needed = array.bytes_to_read_chunk();
        if (needed > room_.most()) refuse(level, needed);
        const UnpackingRoom::Share share(room_, needed, stop);
        auto bytes = reader.chunk(index_of(array, chunk), stop);
        const auto count = static_cast<std::size_t>(high[0] - low[0] + 1);
        const std::size_t each = array.bytes.size(), stride = layout.stride[0];
        std::vector<std::byte> scattered(stride == 1 ? 0 : count * each);
        for (int z = low[2]; z <= high[2]; ++z) {
            for (int y = low[1]; y <= high[1]; ++y) {
                const Index3 first(low[0], y, z);
                take(first, [&](std::byte* to) {
                    if (!bytes) return put_fill(count, to);
                    std::size_t from = layout.base;
                    for (std::size_t i = 0; i < 3; ++i) {
                        const auto a = static_cast<Eigen::Index>(i);
                        from += layout.stride[i] * static_cast<std::size_t>(first[a] - corner[a]);
                    }
                    std::byte* const begin = bytes->data() + from * each;
                    for (std::size_t at = 0; at < scattered.size(); at += each) {
                        std::memcpy(scattered.data() + at, begin + at * stride, each);
                    }
                    array.bytes.unpack(stride == 1 ? std::span(begin, count * each) : scattered,
                                       to);
                });
            }
        }
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

    /// What takes the place of samples that are not finite. Searched when it is first needed.
    double least_finite(const std::stop_token& stop) const {
        if (volume_.info.range) return volume_.info.range->minimum;
        const UnpackingRoom::Share only(searching_, 1, stop);
        if (!least_finite_) least_finite_ = searched(stop);
        return *least_finite_;
    }

    /// The least finite sample of the finest level of at most `most_searched` samples, as in
    /// io::read_volume(). If each level has more: that of as many, in chunks spread evenly over the
    /// coarsest level. Damaged chunks are left out; the fill value if nothing is found so.
    double searched(const std::stop_token& stop) const {
        const auto is_too_large = [&](std::size_t at) {
            return sample_count(volume_.info.levels[at].geometry) > most_searched ||
                   volume_.arrays[at].bytes_to_read_chunk() > room_.most();
        };
        std::size_t level = 0;
        while (level + 1 < readers_.size() && is_too_large(level)) ++level;
        const Level& grid = volume_.info.levels[level];
        const Index3 chunks =
            (grid.geometry.size + grid.chunk - Index3::Ones()).cwiseQuotient(grid.chunk);
        const auto in_chunk = grid.chunk.cast<std::int64_t>().prod();
        int step = 1;
        const auto taken = [&] {
            const auto along = ((chunks.array() + (step - 1)) / step).cast<std::int64_t>().eval();
            return along.prod();
        };
        const bool all = sample_count(grid.geometry) <= most_searched;
        while (!all && taken() > 1 && taken() * in_chunk > most_searched) ++step;
        double least = std::numeric_limits<double>::infinity();
        bool damaged = false;
        std::vector<std::byte> row;
        const auto look = [&](const Index3& first, const auto& put) {
            const int count = std::min(grid.chunk[0], grid.geometry.size[0] - first[0]);
            row.resize(static_cast<std::size_t>(count) * size_of(volume_.info.type));
            put(row.data());
            least = std::min<double>(least, finite_samples(volume_.info.type, row).least);
        };
        for_each_index({Index3::Zero(), (chunks - Index3::Ones()) / step}, [&](const Index3& at) {
            try {
                for_each_row(static_cast<int>(level), at * step, whole_box(grid.geometry), stop,
                             look);
            } catch (const io::InputError&) {
                damaged = true;
            }
        });
        if (std::isfinite(least)) return least;
        if (!all || damaged) return volume_.info.fill;
        throw io::InputError(volume_.info.address +
                             ": none of its samples is a finite number; export it again");
    }

    /// Of samples that are not stored. NaN where the fill value is not finite.
    void put_fill(std::size_t count, std::byte* to) const {
        with_type(volume_.info.type, [&](auto zero) {
            const auto value = static_cast<decltype(zero)>(volume_.arrays[0].bytes.fill);
            for (std::size_t i = 0; i < count; ++i) {
                std::memcpy(to + i * sizeof value, &value, sizeof value);
            }
        });
    }

    std::shared_ptr<const Objects> objects_;
    ChunkedVolume volume_;
    std::vector<std::unique_ptr<ChunkReader>> readers_;
    std::vector<ChunkLayout> layouts_;
    mutable UnpackingRoom room_;
    mutable UnpackingRoom searching_{1};  // for one thread; others wait, or are stopped
    mutable std::optional<double> least_finite_;
};

}  // namespace

std::shared_ptr<const Store> chunked_store(std::shared_ptr<const Objects> objects,
                                           ChunkedVolume volume, std::uint64_t unpacking) {
    return std::make_shared<ChunkedStore>(std::move(objects), std::move(volume), unpacking);
}

}  // namespace palpate::stream
