// The nodes of a cell of either field: which are solid, and where an edge between two of them meets
// the isosurface. Cells that share a node or an edge compute the same bits for it.
#pragma once

#include <vector>

#include "surface/partition.hpp"

namespace palpate::marching {

/// The fraction of an edge, kept away from its ends by surface_margin.
inline double within_margin(double t) {
    if (!(t > surface_margin)) return surface_margin;
    return t > 1 - surface_margin ? 1 - surface_margin : t;
}

class LinearNodes {
  public:
    LinearNodes(const Field& field, double isovalue, const SampleBox& /*box*/)
        : field_(field), isovalue_(isovalue - field.offset()) {}

    /// The cells through which the surface can go, by their lowest corner.
    static SampleBox cells(const Geometry& geometry) {
        return {Index3::Constant(-1), geometry.size - Index3::Ones()};
    }
    /// Where a cell begins, from that corner [voxel].
    static constexpr double begin = 0;

    /// Takes the nodes of a cell. False if the surface does not go through it.
    bool enter(const Index3& cell);
    bool is_solid(Node node) const { return is_solid(value_[node]); }
    /// Where the edge from one node to another, one of them solid, meets the surface.
    double crossing(Node a, Node b) const {
        return within_margin((isovalue_ - value_[a]) / (value_[b] - value_[a]));
    }

  private:
    bool is_solid(double value) const { return field_.sign() * (value - isovalue_) > 0; }

    const Field& field_;
    double isovalue_;  // less the field's offset, like its cells
    std::array<double, node_count> value_;
};

/// A cell is here the cube round a sample. Along an edge the field is a cubic, known by its values
/// and slopes at the ends.
class CubicNodes {
  public:
    CubicNodes(const Field& field, double isovalue, const SampleBox& box);

    static SampleBox cells(const Geometry& geometry) {
        return {Index3::Constant(-1), geometry.size};
    }
    static constexpr double begin = -0.5;

    /// Cells come in the order of the box, x fastest.
    bool enter(const Index3& cell);
    bool is_solid(Node node) const { return excess_[node] > 0; }
    double crossing(Node a, Node b);

  private:
    void enter_slab(int z);
    void look_at(int z, std::vector<std::uint8_t>& sides) const;
    void take_values();
    const Vec3& gradient(Node node);
    Vec3 corner_gradient(Node corner) const;
    Vec3 centre_gradient() const;
    Vec3 face_gradient(Node face) const;

    const Field& field_;
    double isovalue_;
    SampleBox box_;
    // Of the cells of eight samples, from one before the box: bit 0 set if one of the samples is
    // free, bit 1 if one is solid. One layer and the one below it, and what they have together.
    std::vector<std::uint8_t> below_, here_, either_;
    int slab_ = std::numeric_limits<int>::min();
    Neighbours samples_;                     // excess of those round the cell
    std::array<double, node_count> excess_;  // sign * (f - isovalue)
    std::array<Vec3, node_count> gradient_;  // of it [data units / voxel], where known
    unsigned known_ = 0;                     // of which nodes
};

}  // namespace palpate::marching
