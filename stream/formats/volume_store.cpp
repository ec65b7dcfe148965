// A volume in memory as a store.
#include <cstring>

#include "palpate/stream/convert.hpp"
#include "stream/sample_bytes.hpp"

namespace palpate::stream {
namespace {

class VolumeStore : public Store {
  public:
    VolumeStore(Volume volume, std::string name) : volume_(std::move(volume)) {
        info_.address = std::move(name);
        info_.format = "memory";
        info_.type = volume_.type();
        info_.levels = {{volume_.geometry(), volume_.geometry().size}};
        info_.range = Range{volume_.minimum(), volume_.maximum()};
    }

    const StoreInfo& info() const override { return info_; }
    Traffic traffic() const override { return {}; }

    void read(int level, const SampleBox& box, std::span<std::byte> out,
              std::stop_token stop) const override {
        if (level != 0) throw std::invalid_argument("a volume has one level, number 0");
        check_request(volume_.geometry(), box, info_.type, out.size());
        const auto* const all = static_cast<const std::byte*>(volume_.data());
        const Index3& size = volume_.geometry().size;
        const std::size_t each = size_of(info_.type);
        const std::size_t row = static_cast<std::size_t>(box.high[0] - box.low[0] + 1) * each;
        std::byte* to = out.data();
        for (int z = box.low[2]; z <= box.high[2]; ++z) {
            if (stop.stop_requested()) throw Cancelled{};
            for (int y = box.low[1]; y <= box.high[1]; ++y, to += row) {
                const std::size_t from =
                    (static_cast<std::size_t>(z) * static_cast<std::size_t>(size[1]) +
                     static_cast<std::size_t>(y)) *
                        static_cast<std::size_t>(size[0]) +
                    static_cast<std::size_t>(box.low[0]);
                std::memcpy(to, all + from * each, row);
            }
        }
    }

  private:
    Volume volume_;
    StoreInfo info_;
};

}  // namespace

std::shared_ptr<const Store> store_of(Volume volume, std::string name) {
    return std::make_shared<VolumeStore>(std::move(volume), std::move(name));
}

}  // namespace palpate::stream
