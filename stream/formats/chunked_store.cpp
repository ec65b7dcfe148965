// A store over arrays in chunks. See the header.
#include "stream/formats/chunked_store.hpp"

#include <cstring>

#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/finite_store.hpp"

namespace palpate::stream {
namespace {

/// Layout of the samples of a chunk in its bytes: strides [samples] along x, y, z, and the place of
/// the fixed indices.
struct ChunkLayout {
    std::array<std::size_t, 3> stride = {0, 0, 0};
    std::size_t base = 0;
};

ChunkLayout layout_of(const ChunkedArray& array, const std::array<int, 3>& space,
                      const std::vector<std::int64_t>& fixed) {
    std::vector<std::size_t> strides(array.axes());
    std::size_t stride = 1;
    for (std::size_t i = array.axes(); i-- > 0;) {
        const auto axis = static_cast<std::size_t>(array.stored_axes[i]);
        strides[axis] = stride;
        stride *= static_cast<std::size_t>(array.chunk[axis]);
    }
    ChunkLayout layout;
    for (std::size_t a = 0; a < array.axes(); ++a) {
        layout.base += strides[a] * static_cast<std::size_t>(fixed[a] % array.chunk[a]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (space[i] >= 0) layout.stride[i] = strides[static_cast<std::size_t>(space[i])];
    }
    return layout;
}

class ChunkedStore : public FiniteStore {
  public:
    ChunkedStore(std::shared_ptr<const Objects> objects, ChunkedVolume volume,
                 std::uint64_t unpacking)
        : FiniteStore(std::move(volume.info)),
          objects_(std::move(objects)),
          space_(volume.space),
          fixed_(std::move(volume.fixed)),
          room_(unpacking) {
        const std::string note = objects_->note();
        if (!note.empty()) info_.notes.push_back(note);
        for (ChunkedArray& array : volume.arrays) {
            layouts_.push_back(layout_of(array, space_, fixed_));
            readers_.push_back(std::make_unique<ChunkReader>(objects_, std::move(array)));
        }
    }

    Traffic traffic() const override { return objects_->traffic(); }

  private:
    void put(int level, const SampleBox& box, const Places& to,
             const std::stop_token& stop) const override {
        for_each_piece(info_.levels[std::size_t(level)].chunk, box,
                       [&](const Index3& chunk, const SampleBox& part) {
                           put_rows(level, chunk, part, to, stop);
                       });
    }
    bool can_unpack(int level) const override {
        return readers_[std::size_t(level)]->array().bytes_to_read_chunk() <= room_.most();
    }

    /// Puts the rows of the part of a chunk.
    void put_rows(int level, const Index3& chunk, const SampleBox& part, const Places& to,
                  const std::stop_token& stop) const {
        if (stop.stop_requested()) throw Cancelled{};
        const ChunkLayout& layout = layouts_[std::size_t(level)];
        const Index3 corner = chunk.cwiseProduct(info_.levels[std::size_t(level)].chunk);
        const ChunkReader& reader = *readers_[std::size_t(level)];
        const ChunkedArray& array = reader.array();
        const std::uint64_t needed = array.bytes_to_read_chunk();
        if (needed > room_.most()) refuse(level, needed);
        const UnpackingRoom::Share share(room_, needed, stop);
        auto bytes = reader.chunk(index_of(array, chunk), stop);
        const auto count = static_cast<std::size_t>(part.high[0] - part.low[0] + 1);
        const std::size_t each = array.bytes.size(), stride = layout.stride[0];
        std::vector<std::byte> scattered(stride == 1 ? 0 : count * each);
        for (int z = part.low[2]; z <= part.high[2]; ++z) {
            for (int y = part.low[1]; y <= part.high[1]; ++y) {
                const Index3 first(part.low[0], y, z);
                std::byte* const row = to(first, count);
                if (!bytes) {
                    put_fill(array.bytes.fill, count, row);
                    continue;
                }
                std::size_t from = layout.base;
                for (std::size_t i = 0; i < 3; ++i) {
                    const auto a = static_cast<Eigen::Index>(i);
                    from += layout.stride[i] * static_cast<std::size_t>(first[a] - corner[a]);
                }
                std::byte* const begin = bytes->data() + from * each;
                for (std::size_t at = 0; at < scattered.size(); at += each) {
                    std::memcpy(scattered.data() + at, begin + at * stride, each);
                }
                array.bytes.unpack(stride == 1 ? std::span(begin, count * each) : scattered, row);
            }
        }
    }

    [[noreturn]] void refuse(int level, std::uint64_t needed) const {
        constexpr std::uint64_t megabyte = 1000000;
        throw io::InputError(info_.address + ": a chunk of level " + std::to_string(level) +
                             " takes " + std::to_string(needed / megabyte + 1) +
                             " MB to be read, and " + std::to_string(room_.most() / megabyte) +
                             " MB may be used for that; allow more memory, or store it in smaller "
                             "chunks");
    }

    std::vector<std::int64_t> index_of(const ChunkedArray& array, const Index3& chunk) const {
        std::vector<std::int64_t> index(array.axes());
        for (std::size_t a = 0; a < array.axes(); ++a) index[a] = fixed_[a] / array.chunk[a];
        for (std::size_t i = 0; i < 3; ++i) {
            if (space_[i] < 0) continue;
            index[static_cast<std::size_t>(space_[i])] = chunk[static_cast<Eigen::Index>(i)];
        }
        return index;
    }

    /// Fills samples that are not stored. NaN if the fill value is not finite.
    void put_fill(double fill, std::size_t count, std::byte* to) const {
        with_type(info_.type, [&](auto zero) {
            const auto value = static_cast<decltype(zero)>(fill);
            for (std::size_t i = 0; i < count; ++i) {
                std::memcpy(to + i * sizeof value, &value, sizeof value);
            }
        });
    }

    std::shared_ptr<const Objects> objects_;
    std::array<int, 3> space_;         // as in ChunkedVolume
    std::vector<std::int64_t> fixed_;  // the same
    std::vector<std::unique_ptr<ChunkReader>> readers_;
    std::vector<ChunkLayout> layouts_;
    mutable UnpackingRoom room_;
};

}  // namespace

std::shared_ptr<const Store> chunked_store(std::shared_ptr<const Objects> objects,
                                           ChunkedVolume volume, std::uint64_t unpacking) {
    return std::make_shared<ChunkedStore>(std::move(objects), std::move(volume), unpacking);
}

}  // namespace palpate::stream
