// Layers by label in tests: labels at random or in slabs, and the field that the proxy touches,
// sample by sample from its definition.
#pragma once

#include <cmath>

#include "palpate/renderer.hpp"
#include "support/cubic_reference.hpp"
#include "support/fields.hpp"
#include "support/paper_lattice.hpp"

namespace palpate::support {

/// Labels 1 .. `count` at random in blocks of a few samples, none in the rest, on another grid than
/// the data.
inline Volume random_labels(std::uint64_t seed, int count, const Geometry& geometry) {
    Random random(seed);
    return volume_of<std::uint8_t>(
        geometry, [&](const Index3&) { return std::max(0, random.below(2 * count) - count + 1); });
}

/// What the proxy touches, evaluated slowly: samples from what may be entered, by the definition in
/// docs/layers.md, and between them the mean over a tetrahedron's corners.
struct TouchedField {
    const Field& data;
    const Layers& layers;
    const LayerState& state;

    int levels() const { return static_cast<int>(level_count(layers)); }
    bool open(int label) const { return (state.open >> label & 1U) != 0; }
    bool covers_data() const { return levels() > 0; }
    const Field& grid_of() const { return covers_data() ? data : *layers.labels; }
    double sign() const { return covers_data() ? data.sign() : 1; }
    double range() const { return covers_data() ? data.range() : 1; }
    bool has_ahead() const { return open(0) && state.inner < levels(); }
    bool has_behind() const { return open(0) && state.outer > 0; }
    double behind() const { return layers.layers[std::size_t(state.outer - 1)].level; }
    double ahead() const {
        if (!covers_data()) return 0.5;
        if (has_ahead()) return layers.layers[std::size_t(state.inner)].level;
        if (!layers.by_label) return sign() * HUGE_VAL;
        const Samples& samples = data.samples();
        return (sign() > 0 ? samples.maximum() : samples.minimum()) + 0.5 * sign() * range();
    }
    int label_at(const Index3& at) const {
        if (!layers.by_label) return 0;
        const Geometry& here = grid_of().geometry();
        const Geometry& there = layers.labels->geometry();
        if ((at.array() < 0).any() || (at.array() >= here.size.array()).any()) return 0;
        const Vec3 index = index_from_physical(there, physical_from_index(here, at.cast<double>()));
        const Index3 nearest = (index.array() + 0.5).floor().matrix().cast<int>();
        const bool inside =
            (nearest.array() >= 0).all() && (nearest.array() < there.size.array()).all();
        return inside ? int(layers.labels->volume().sample(nearest)) : 0;
    }
    double sample(const Index3& at) const {
        const int label = label_at(at);
        if (!covers_data()) return open(label) ? 0 : 1;
        double half = 0.5 * sign() * range();
        if (has_behind()) half = 0.5 * (ahead() - behind());
        if (!open(label)) return ahead() + half;
        if (label > 0) return ahead() - half;
        const Index3& size = data.geometry().size;
        const bool inside = (at.array() >= 0).all() && (at.array() < size.array()).all();
        return inside ? data.samples().sample(at, data.moment()) : data.background();
    }
    double value(const Vec3& physical) const {
        const Vec3 index = index_from_physical(grid_of().geometry(), physical);
        if (data.interpolation() == Interpolation::cubic) {
            return double(cubic_value(index.cast<long double>(), [&](const Index3& at) {
                              return sample(at);
                          }).value);
        }
        const PaperPlace at = paper_locate(index);
        Eigen::Matrix<double, 8, 1> corners;
        for (int c = 0; c < 8; ++c) {
            corners[c] = sample(at.cell + Index3(c & 1, c >> 1 & 1, c >> 2 & 1));
        }
        return paper_values(paper_tetrahedra()[at.tetrahedron], corners).dot(at.barycentric);
    }
    /// How far a point lies where the SCP may not be [range]; at most 0 in what is open.
    double beyond(const Vec3& physical) const {
        const double here = value(physical);
        double worst = std::isfinite(ahead()) ? sign() * (here - ahead()) : -HUGE_VAL;
        if (has_behind()) worst = std::max(worst, sign() * (behind() - here));
        return worst / range();
    }
};

}  // namespace palpate::support
