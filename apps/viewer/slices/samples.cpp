// Reads layers of samples out of a field.
#include "apps/viewer/slices/samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/viewer/model/sample_block.hpp"
#include "palpate/cubic.hpp"

namespace palpate::viewer {
namespace {

constexpr int nowhere = std::numeric_limits<int>::min();

}  // namespace

SliceSamples::SliceSamples(Field field, const SlicePlane& plane)
    : field_(std::move(field)), plane_(plane.in(field_.geometry())) {
    forget_layers();
    go_to(0);
}

void SliceSamples::forget_layers() {
    for (SampleLayer& layer : layers_) layer.number = nowhere;
}

void SliceSamples::use(const Field& field) {
    field_ = field;
    forget_layers();
    go_to(position_);
}

double SliceSamples::nearest(double position) const {
    if (std::isnan(position)) return 0;
    return std::clamp(position, -2.0, plane_.layers() + 1.0);
}

void SliceSamples::go_to(double position) {
    position_ = nearest(position);
    before_ = static_cast<int>(std::floor(position_));
    fraction_ = position_ - before_;
    load(before_);
    if (field_.interpolation() == Interpolation::cubic) {
        load(before_ + 1);
        load(fraction_ > 0.5 ? before_ + 2 : before_ - 1);
    } else if (fraction_ > 0) {
        load(before_ + 1);
    }
}

void SliceSamples::load(int number) {
    SampleLayer& layer = layers_[place_of(number)];
    if (layer.number == number) return;
    layer.number = number;
    const std::size_t count = static_cast<std::size_t>(width() + 2 * ring) *
                              static_cast<std::size_t>(height() + 2 * ring);
    layer.values.assign(count, static_cast<float>(field_.background()));
    Index3 low = Index3::Zero(), size = field_.geometry().size;
    if (number < 0 || number >= size[plane_.axis]) return;
    low[plane_.axis] = number;
    size[plane_.axis] = 1;
    const std::vector<float> samples = sample_block(field_, low, size);
    const std::array<std::ptrdiff_t, 3> stride{1, size[0],
                                               static_cast<std::ptrdiff_t>(size[0]) * size[1]};
    const auto step = [&](const ScreenAxis& screen) {
        return (screen.flip ? -1 : 1) * stride[static_cast<std::size_t>(screen.axis)];
    };
    const std::ptrdiff_t along_u = step(plane_.right), along_v = step(plane_.down);
    // Along a flipped axis the last sample comes first.
    const float* const first = samples.data() -
                               std::min<std::ptrdiff_t>(0, along_u) * (width() - 1) -
                               std::min<std::ptrdiff_t>(0, along_v) * (height() - 1);
    for (int v = 0; v < height(); ++v) {
        const float* const from = first + v * along_v;
        float* const to = layer.values.data() +
                          static_cast<std::ptrdiff_t>(v + ring) * (width() + 2 * ring) + ring;
        for (int u = 0; u < width(); ++u) to[u] = from[u * along_u];
    }
}

void SliceSamples::interpolate(int v, float* values) const {
    const int last = plane_.layers() - 1;
    const float* const before = row(0, v);
    const bool only_before = fraction_ == 0 || before_ >= last;
    const bool only_after = !only_before && before_ < 0;
    if (only_before || only_after) {
        const float* const one = only_after ? row(1, v) : before;
        std::copy(one, one + width(), values);
        return;
    }
    const float* const after = row(1, v);
    const auto t = static_cast<float>(fraction_);
    for (int u = 0; u < width(); ++u) values[u] = before[u] + t * (after[u] - before[u]);
}

// The lattice has the symmetries of a cube: it is the same along u, v and across the slice as along
// the grid's axes.
double SliceSamples::value(Interpolation interpolation, double u, double v) const {
    constexpr double within = 1 - 1e-9;  // rounding must not reach the next cell
    if (interpolation == Interpolation::cubic) {
        const int near_u = static_cast<int>(std::lround(u)),
                  near_v = static_cast<int>(std::lround(v));
        const int near_w = nearest_layer();
        Neighbours around;
        for (int i = 0; i < 27; ++i) {
            around[std::size_t(i)] =
                row(near_w + i / 9 - 1, near_v + i / 3 % 3 - 1)[near_u + i % 3 - 1];
        }
        const Vec3 from_sample(u - near_u, v - near_v, fraction_ - near_w);
        const LatticePoint point = cubic::locate(within * from_sample);
        return cubic::piece_of(point.tetrahedron, around)(point.folded) / cubic::scale;
    }
    const int low_u = static_cast<int>(std::floor(u)), low_v = static_cast<int>(std::floor(v));
    const int next = fraction_ > 0 ? 1 : 0;
    if (u == low_u && v == low_v) {  // on an edge between two samples
        const double before = row(0, low_v)[low_u];
        return before + fraction_ * (row(next, low_v)[low_u] - before);
    }
    CellSamples cell;
    for (int i = 0; i < 8; ++i) {
        cell[std::size_t(i)] = row(i / 4 * next, low_v + i / 2 % 2)[low_u + i % 2];
    }
    const LatticePoint point = locate(Vec3(u - low_u, v - low_v, fraction_).cwiseMin(within));
    return piece_of(point.tetrahedron, cell)(point.folded);
}

std::vector<const float*> SliceSamples::rows_of_cells(Interpolation interpolation, int v) const {
    const bool smooth = interpolation == Interpolation::cubic;
    const int first = smooth ? nearest_layer() - 1 : 0;
    const int last = smooth ? first + 2 : fraction_ > 0 ? 1 : 0;
    std::vector<const float*> rows;
    for (int layer = first; layer <= last; ++layer) {
        for (int i = smooth ? -1 : 0; i <= (smooth ? 2 : 1); ++i) rows.push_back(row(layer, v + i));
    }
    return rows;
}

bool SliceSamples::in_data() const {
    return position_ >= -0.5 && position_ <= plane_.layers() - 0.5;
}

}  // namespace palpate::viewer
