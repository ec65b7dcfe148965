// The bodies that the benchmarks touch and the hands that touch them, shared by every benchmark and
// by the instruction counter, so that they all time the same motion.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "palpate/proxy.hpp"

namespace palpate::benchmarks {

/// Where the hand is in each tick [mm, physical].
using HandPath = std::vector<Vec3>;

/// A body, the level that is felt, and a hand on it.
struct Touch {
    Field field;
    double isovalue = 0;
    HandPath path;
};

/// Distance that the hand moves in a tick [mm, physical] at 5 cm/s and 1 kHz, where 1 mm of hand is
/// so many voxels and a voxel is 1 mm.
constexpr double step_per_tick(double voxels_per_mm) {
    return 50.0 / 1000 * voxels_per_mm;
}

/// The paper's cylinder, 100x100x30, felt at 0.53 of its range. The hand goes round its axis
/// `depth` voxels below the surface (negative: outside, free) and slowly along it.
Touch cylinder_touch(SampleType type, double voxels_per_mm, double depth);

/// White noise felt at half height, 48^3: as much surface as a volume can have. The hand goes
/// through it on a winding curve at the given speed.
Touch noise_touch(SampleType type, double voxels_per_mm);

/// A ball of 22 voxels radius in the middle of a uint8 volume of size^3, touched 1 voxel below its
/// surface round three axes: in voxels the same motion through the same samples at every size.
Touch ball_touch(int size, double voxels_per_mm);

/// A half space that rises by one unit a voxel along (1, 0.37, 0.21), float32 of size^3, with its
/// surface through the middle: all tetrahedra alike, so a straight path has a known number of them.
/// The path is left empty.
Touch ramp_touch(int size);

/// The same body, level and hand on the smooth field.
Touch smooth(Touch touch);
/// The same body, level and hand with all samples in edited bricks.
Touch all_in_bricks(Touch touch);
/// The same with all samples as bricks of a large grid, all of them in memory.
Touch all_resident(Touch touch);
/// The same half way between two frames, both of them alike.
Touch between_frames(Touch touch);

/// A hand that goes along a path and back, again and again, in the steps of the path.
class HandMotion {
  public:
    explicit HandMotion(const HandPath& path) : path_(path) {}

    const Vec3& next() {
        if (at_ + 1 == path_.size()) step_ = -1;
        if (at_ == 0) step_ = 1;
        const Vec3& position = path_[at_];
        at_ += static_cast<std::size_t>(step_);
        return position;
    }

  private:
    const HandPath& path_;
    std::size_t at_ = 0;
    int step_ = 1;
};

}  // namespace palpate::benchmarks
