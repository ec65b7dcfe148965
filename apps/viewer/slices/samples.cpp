// Reads layers of samples out of a field.
#include "apps/viewer/slices/samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/viewer/model/sample_block.hpp"

namespace palpate::viewer {
namespace {

constexpr int nowhere = std::numeric_limits<int>::min();

}  // namespace

SliceSamples::SliceSamples(Field field, const SlicePlane& plane)
    : field_(std::move(field)), plane_(plane), size_(samples_of(plane, field_.geometry())) {
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
    return std::clamp(position, -2.0, field_.geometry().size[plane_.axis] + 1.0);
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
    const std::size_t count = static_cast<std::size_t>(size_[0] + 2 * ring) *
                              static_cast<std::size_t>(size_[1] + 2 * ring);
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
                               std::min<std::ptrdiff_t>(0, along_u) * (size_[0] - 1) -
                               std::min<std::ptrdiff_t>(0, along_v) * (size_[1] - 1);
    for (int v = 0; v < size_[1]; ++v) {
        const float* const from = first + v * along_v;
        float* const to = layer.values.data() +
                          static_cast<std::ptrdiff_t>(v + ring) * (size_[0] + 2 * ring) + ring;
        for (int u = 0; u < size_[0]; ++u) to[u] = from[u * along_u];
    }
}

void SliceSamples::interpolate(int v, float* values) const {
    const int last = field_.geometry().size[plane_.axis] - 1;
    const float* const before = row(0, v);
    const bool only_before = fraction_ == 0 || before_ >= last;
    const bool only_after = !only_before && before_ < 0;
    if (only_before || only_after) {
        const float* const one = only_after ? row(1, v) : before;
        std::copy(one, one + size_[0], values);
        return;
    }
    const float* const after = row(1, v);
    const auto t = static_cast<float>(fraction_);
    for (int u = 0; u < size_[0]; ++u) values[u] = before[u] + t * (after[u] - before[u]);
}

bool SliceSamples::in_data() const {
    return position_ >= -0.5 && position_ <= field_.geometry().size[plane_.axis] - 0.5;
}

}  // namespace palpate::viewer
