// A volume as a large grid of which bricks come and go.
#pragma once

#include <cstring>
#include <memory>
#include <vector>

#include "palpate/samples.hpp"
#include "support/random.hpp"

namespace palpate::support {

/// A brick of a volume, as a loader would make it. Samples outside the grid are `outside` bytes.
inline Brick brick_of(const Volume& volume, const Index3& brick, int outside = 0x55,
                      std::uint8_t level = 0) {
    const std::size_t bytes = size_of(volume.type());
    const std::shared_ptr<std::byte[]> samples(new std::byte[ResidentBricks::per_brick * bytes]);
    std::memset(samples.get(), outside, ResidentBricks::per_brick * bytes);
    const Index3& size = volume.geometry().size;
    const auto* whole = static_cast<const std::byte*>(volume.data());
    for_each_index(ResidentBricks::box_of(brick, size), [&](const Index3& at) {
        const auto to = std::size_t(ResidentBricks::place_of(at));
        const auto from = std::size_t(sample_place(at, size));
        std::memcpy(samples.get() + to * bytes, whole + from * bytes, bytes);
    });
    return {samples, level};
}

/// Versions of a volume with some of its bricks.
class PartOf {
  public:
    explicit PartOf(const Volume& volume) : volume_(volume), bricks_(volume.geometry().size) {
        const Index3& count = bricks_.count();
        for (int k = 0; k < count[2]; ++k) {
            for (int j = 0; j < count[1]; ++j) {
                for (int i = 0; i < count[0]; ++i) all_.push_back({i, j, k});
            }
        }
    }

    std::shared_ptr<const Samples> samples() const {
        return std::make_shared<const Samples>(volume_, volume_.geometry(), bricks_,
                                               volume_.minimum(), volume_.maximum());
    }
    const ResidentBricks& bricks() const { return bricks_; }
    const std::vector<Index3>& all() const { return all_; }
    void add(const Index3& brick) { set(brick, brick_of(volume_, brick)); }
    void drop(const Index3& brick) { set(brick, {}); }
    void add_all() {
        for (const Index3& brick : all_) add(brick);
    }
    /// One brick at random comes, or goes with this probability.
    void change(Random& random, double goes) {
        const Index3& brick = all_[std::size_t(random.below(int(all_.size())))];
        random.chance(goes) ? drop(brick) : add(brick);
    }

  private:
    void set(const Index3& brick, const Brick& to) {
        const ResidentBricks::Change change{brick, to};
        bricks_ = bricks_.with({&change, 1});
    }

    Volume volume_;
    ResidentBricks bricks_;
    std::vector<Index3> all_;
};

}  // namespace palpate::support
