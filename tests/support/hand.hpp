// A seeded hand: HIP sequences that mix slow sliding, 3 m/s sweeps, jumps across the volume, rest,
// and motions along axes and diagonals on half-integer coordinates, where every case is degenerate.
#pragma once

#include "palpate/volume.hpp"
#include "support/random.hpp"

namespace palpate::support {

/// How the hand moves: weights of the motions that it chooses from.
struct HandStyle {
    int slide = 4;      ///< 0.02 .. 0.2 voxel a tick, slowly turning
    int sweep = 2;      ///< 3 mm a tick: 3 m/s
    int jump = 2;       ///< anywhere in the volume and 3 voxels around, every tick
    int rest = 1;       ///< the same HIP again
    int lattice = 1;    ///< half-integer coordinates, steps of 1/2 along axes and diagonals
    double margin = 3;  ///< [voxel] how far outside the grid it may go
};

class Hand {
  public:
    Hand(const Geometry& geometry, std::uint64_t seed, HandStyle style = {})
        : random_(seed), geometry_(geometry), style_(style) {
        index_ = anywhere();
    }

    /// The next HIP [mm, physical].
    Vec3 next() {
        if (--left_ <= 0) choose();
        switch (motion_) {
            case Motion::slide:
                velocity_ += 0.1 * velocity_.norm() * random_.direction();
                velocity_ *= speed_ / velocity_.norm();
                index_ += velocity_;
                break;
            case Motion::sweep:
                index_ += velocity_.cwiseQuotient(geometry_.spacing);
                break;
            case Motion::jump:
                index_ = anywhere();
                break;
            case Motion::rest:
                break;
            case Motion::lattice:
                index_ += velocity_;
                break;
        }
        turn_back_at_the_margin();
        return physical_from_index(geometry_, index_);
    }

  private:
    enum class Motion { slide, sweep, jump, rest, lattice };

    Vec3 anywhere() {
        Vec3 p;
        for (int a = 0; a < 3; ++a) {
            p[a] = random_.uniform(-style_.margin, geometry_.size[a] - 1 + style_.margin);
        }
        return p;
    }

    void choose() {
        left_ = 1 + random_.below(60);
        const int sum = style_.slide + style_.sweep + style_.jump + style_.rest + style_.lattice;
        int pick = random_.below(sum);
        if ((pick -= style_.slide) < 0) {
            motion_ = Motion::slide;
            speed_ = random_.uniform(0.02, 0.2);
            velocity_ = speed_ * random_.direction();
        } else if ((pick -= style_.sweep) < 0) {
            motion_ = Motion::sweep;
            velocity_ = 3 * random_.direction();
        } else if ((pick -= style_.jump) < 0) {
            motion_ = Motion::jump;
            left_ = 1 + random_.below(6);
        } else if ((pick -= style_.rest) < 0) {
            motion_ = Motion::rest;
            left_ = 1 + random_.below(4);
        } else {
            motion_ = Motion::lattice;
            index_ = (2 * index_).array().round() / 2;
            do {
                for (double& v : velocity_) v = 0.5 * (random_.below(3) - 1);
            } while (velocity_.isZero());
        }
    }

    void turn_back_at_the_margin() {
        for (int a = 0; a < 3; ++a) {
            const double low = -style_.margin;
            const double high = geometry_.size[a] - 1 + style_.margin;
            if (index_[a] < low || index_[a] > high) velocity_[a] = -velocity_[a];
            index_[a] = std::min(std::max(index_[a], low), high);
        }
    }

    Random random_;
    Geometry geometry_;
    HandStyle style_;
    Vec3 index_;
    Vec3 velocity_ = Vec3::UnitX();
    double speed_ = 0.1;
    Motion motion_ = Motion::rest;
    int left_ = 0;
};

}  // namespace palpate::support
