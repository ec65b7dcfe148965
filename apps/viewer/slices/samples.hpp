// The samples of a slice between two layers of a grid. No Qt. The cost depends on the slice, not on
// the volume.
#pragma once

#include <array>
#include <vector>

#include "apps/viewer/slices/plane.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// One layer of samples along u and v, with a ring of background round it.
struct Layer {
    int number = 0;  ///< along the grid axis
    std::vector<float> values;
};

/// A slice at any place along its axis: the layers before and after it, and how far it is between
/// them. Layers that the next slice needs too are kept.
class SliceSamples {
  public:
    SliceSamples(Field field, const SlicePlane& plane);

    /// Takes another version of the samples on the same grid; the position stays.
    void use(const Field& field);
    /// Goes to `position`, in layers along the grid axis from 0. Outside the grid all is
    /// background.
    void go_to(double position);
    /// Where go_to(position) goes: farther than two layers out it is all the same.
    double nearest(double position) const;

    int width() const { return size_[0]; }   ///< samples along u
    int height() const { return size_[1]; }  ///< samples along v
    double position() const { return position_; }
    /// Of the next layer, 0 (this one alone) to below 1.
    double fraction() const { return fraction_; }
    const Field& field() const { return field_; }

    /// Row v of the layer before (0) or after (1) the slice; both may be taken from -1 to the
    /// number of samples: the ring is background.
    const float* row(int layer, int v) const {
        return layers_[static_cast<std::size_t>(layer)].values.data() +
               static_cast<std::ptrdiff_t>(v + 1) * (size_[0] + 2) + 1;
    }
    /// The data between the two layers, interpolated linearly, into width() values; beyond the
    /// first and last layer those go on. `v` from 0.
    void interpolate(int v, float* values) const;
    /// False where the slice does not meet a sample's voxel: nothing is there to be seen.
    bool in_data() const;

  private:
    void load(Layer& layer, int number) const;

    Field field_;
    SlicePlane plane_;
    std::array<int, 2> size_;
    double position_ = 0, fraction_ = 0;
    std::array<Layer, 2> layers_;
};

/// Grey levels [data units] that are shown black and white.
struct GreyWindow {
    double low = 0, high = 1;
};

}  // namespace palpate::viewer
