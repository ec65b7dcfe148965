// A volume in memory as a store.
#include <cstring>

#include "palpate/stream/convert.hpp"
#include "stream/box_bytes.hpp"
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
        if (stop.stop_requested()) throw Cancelled{};
        copy_box(whole_box(volume_.geometry()), static_cast<const std::byte*>(volume_.data()), box,
                 out.data(), size_of(info_.type));
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
