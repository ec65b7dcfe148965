// A store whose levels are volumes, for tests that interfere with its reads.
#pragma once

#include <atomic>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

/// Levels that are volumes, read in pieces of some size; a test may interfere with each read.
class VolumesStore : public Store {
  public:
    VolumesStore(std::vector<Volume> levels, const Index3& chunk) : levels_(std::move(levels)) {
        info_.address = "volumes";
        info_.type = levels_.front().type();
        for (const Volume& level : levels_) info_.levels.push_back({level.geometry(), chunk});
    }
    const StoreInfo& info() const override { return info_; }
    Traffic traffic() const override { return {.requests = reads_}; }
    void read(int level, const SampleBox& box, std::span<std::byte> out,
              std::stop_token stop) const override {
        ++reads_;
        if (before_read) before_read(level, box, stop);
        const Volume& volume = levels_.at(std::size_t(level));
        const std::size_t each = size_of(volume.type());
        const Index3& size = volume.geometry().size;
        std::byte* to = out.data();
        for (int k = box.low[2]; k <= box.high[2]; ++k) {
            for (int j = box.low[1]; j <= box.high[1]; ++j) {
                const auto* row = static_cast<const std::byte*>(volume.data()) +
                                  ((std::size_t(k) * size[1] + j) * size[0] + box.low[0]) * each;
                const auto bytes = std::size_t(box.high[0] - box.low[0] + 1) * each;
                std::memcpy(to, row, bytes);
                to += bytes;
            }
        }
    }

    std::function<void(int, const SampleBox&, const std::stop_token&)> before_read;

  private:
    std::vector<Volume> levels_;
    StoreInfo info_;
    mutable std::atomic<std::uint64_t> reads_{0};
};

inline std::shared_ptr<VolumesStore> store_in_pieces(Volume volume,
                                                     const Index3& chunk = {32, 32, 32}) {
    return std::make_shared<VolumesStore>(std::vector{std::move(volume)}, chunk);
}

}  // namespace palpate::stream
