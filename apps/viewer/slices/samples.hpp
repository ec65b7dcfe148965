// The samples of a slice between two layers of a grid. No Qt. The cost depends on the slice, not on
// the volume.
#pragma once

#include <array>
#include <vector>

#include "apps/viewer/slices/plane.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// One layer of samples along u and v, with a ring of background round it, three samples wide.
struct SampleLayer {
    int number = 0;  ///< along the grid axis
    std::vector<float> values;
};

/// A slice at any place along its axis: the layers before and after it, on a cubic field the three
/// nearest, and how far it is between them. Layers that the next slice needs too are kept.
class SliceSamples {
  public:
    /// `plane`: of the field's grid, or of another with the same directions.
    SliceSamples(Field field, const SlicePlane& plane);

    /// Takes another version of the samples on the same grid; the position stays.
    void use(const Field& field);
    /// Goes to `position`, in layers along the grid axis from 0. Outside the grid all is
    /// background.
    void go_to(double position);
    /// Where go_to(position) goes: farther than two layers out it is all the same.
    double nearest(double position) const;

    const SlicePlane& plane() const { return plane_; }  ///< of the field's grid
    int width() const { return plane_.width(); }        ///< samples along u
    int height() const { return plane_.height(); }      ///< samples along v
    double position() const { return position_; }
    /// Of the next layer, 0 (this one alone) to below 1.
    double fraction() const { return fraction_; }
    const Field& field() const { return field_; }

    /// Row v of a layer: 0 is the last one at or before the slice, 1 the one after it (where
    /// fraction() > 0). On a cubic field also the third nearest, -1 or 2. Both row and column may
    /// be taken from -3 to the number of samples plus 2: the ring is background.
    const float* row(int layer, int v) const {
        return layer_numbered(before_ + layer).values.data() +
               static_cast<std::ptrdiff_t>(v + ring) * (width() + 2 * ring) + ring;
    }
    /// The data between the two layers, interpolated linearly, into width() values; beyond the
    /// first and last layer those go on. `v` from 0.
    void interpolate(int v, float* values) const;
    /// The value at (u, v) of the field that is felt, or of the linear field of the same samples.
    /// Both from -2 to the number of samples plus 1.
    double value(Interpolation interpolation, double u, double v) const;
    /// The rows of all layers with samples that count in a cell between the rows v and v + 1.
    std::vector<const float*> rows_of_cells(Interpolation interpolation, int v) const;
    /// False where the slice does not meet a sample's voxel: nothing is there to be seen.
    bool in_data() const;

  private:
    static constexpr int ring = 3;

    /// Any three in succession have places of their own.
    std::size_t place_of(int number) const { return static_cast<std::size_t>(number + 3) % 3; }
    const SampleLayer& layer_numbered(int number) const { return layers_[place_of(number)]; }
    int nearest_layer() const { return fraction_ > 0.5 ? 1 : 0; }
    void forget_layers();
    void load(int number);

    Field field_;
    SlicePlane plane_;
    double position_ = 0, fraction_ = 0;
    int before_ = 0;  // the last layer at or before the slice
    std::array<SampleLayer, 3> layers_;
};

}  // namespace palpate::viewer
