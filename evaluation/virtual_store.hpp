// A made-up store of 1.9 TB: balls, computed when they are requested, as late and as unreliably as
// over a network.
#pragma once

#include <mutex>
#include <random>

#include "palpate/stream/store.hpp"

namespace palpate::evaluation {

/// As far as that goes, what tests/stream/volume_server.py serves. Balls of 256 voxels, 768 apart;
/// a voxel is 0.001 mm. Samples are 128 at a ball's surface and half a level lower or higher a
/// voxel outside or inside, rounded.
inline constexpr double ball_voxel = 0.001;
inline constexpr double ball_isovalue = 128;

/// How deep a point [mm, physical] lies in the nearest ball [voxel]; negative outside.
double ball_depth(const Vec3& point);

struct Network {
    double latency_s = 0;  ///< of each request
    double failures = 0;   ///< share of requests that are answered by an error, and tried again
};

class VirtualStore : public stream::Store {
  public:
    VirtualStore(const Network& network, std::uint64_t seed);

    const stream::StoreInfo& info() const override { return info_; }
    void read(int level, const SampleBox& box, std::span<std::byte> out,
              std::stop_token stop) const override;
    stream::Traffic traffic() const override;

  private:
    void wait_for_answer(std::size_t bytes, const std::stop_token& stop) const;
    double chance() const;

    stream::StoreInfo info_;
    const Network network_;
    mutable std::mutex mutex_;
    mutable std::mt19937_64 random_;
    mutable stream::Traffic traffic_;
};

}  // namespace palpate::evaluation
