// Reads layers of samples out of a field.
#include "apps/viewer/slices/samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::viewer {
namespace {

constexpr int nowhere = std::numeric_limits<int>::min();

/// Where the samples of a layer lie in memory.
struct Strides {
    std::ptrdiff_t first, along_u, along_v;
};

template <class T>
void copy_layer(const void* data, const Strides& s, int width, int height, float* values) {
    const T* const first = static_cast<const T*>(data) + s.first;
    for (int v = 0; v < height; ++v) {
        const T* sample = first + v * s.along_v;
        float* const to = values + static_cast<std::ptrdiff_t>(v + 1) * (width + 2) + 1;
        for (int u = 0; u < width; ++u, sample += s.along_u) to[u] = static_cast<float>(*sample);
    }
}

template <class T>
std::vector<double> spread_samples(const Volume& volume) {
    constexpr std::size_t wanted = 100'000;
    const auto samples = volume.samples<T>();
    // A step that shares no factor with sizes as they are common: not always the same column.
    std::size_t step = std::max<std::size_t>(1, samples.size() / wanted) | 1;
    while (step > 1 && (step % 3 == 0 || step % 5 == 0 || step % 7 == 0)) step += 2;
    std::vector<double> values;
    values.reserve(samples.size() / step + 1);
    for (std::size_t i = 0; i < samples.size(); i += step) values.push_back(double(samples[i]));
    return values;
}

}  // namespace

SliceSamples::SliceSamples(Field field, const SlicePlane& plane)
    : field_(std::move(field)), plane_(plane), size_(samples_of(plane, field_.geometry())) {
    for (Layer& layer : layers_) layer.number = nowhere;
    go_to(0);
}

void SliceSamples::use(const Field& field) {
    field_ = field;
    for (Layer& layer : layers_) layer.number = nowhere;
    go_to(position_);
}

double SliceSamples::nearest(double position) const {
    if (std::isnan(position)) return 0;
    return std::clamp(position, -2.0, field_.geometry().size[plane_.axis] + 1.0);
}

void SliceSamples::go_to(double position) {
    position_ = nearest(position);
    const int before = static_cast<int>(std::floor(position_));
    fraction_ = position_ - before;
    if (layers_[0].number != before && layers_[1].number == before) {
        std::swap(layers_[0], layers_[1]);
    } else if (layers_[1].number != before + 1 && layers_[0].number == before + 1) {
        std::swap(layers_[0], layers_[1]);
    }
    load(layers_[0], before);
    if (fraction_ > 0) load(layers_[1], before + 1);
}

void SliceSamples::load(Layer& layer, int number) const {
    if (layer.number == number) return;
    layer.number = number;
    const std::size_t count =
        static_cast<std::size_t>(size_[0] + 2) * static_cast<std::size_t>(size_[1] + 2);
    const Geometry& geometry = field_.geometry();
    layer.values.assign(count, static_cast<float>(field_.background()));
    if (number < 0 || number >= geometry.size[plane_.axis]) return;
    const Moment& moment = field_.moment();
    if (field_.samples().bricks() || moment.weight > 0) return load_changed(layer);
    const std::array<std::ptrdiff_t, 3> stride{
        1, geometry.size[0], static_cast<std::ptrdiff_t>(geometry.size[0]) * geometry.size[1]};
    const auto of = [&](int axis) { return stride[static_cast<std::size_t>(axis)]; };
    Strides s{number * of(plane_.axis), of(plane_.right.axis), of(plane_.down.axis)};
    if (plane_.right.flip) {
        s.first += (size_[0] - 1) * s.along_u;
        s.along_u = -s.along_u;
    }
    if (plane_.down.flip) {
        s.first += (size_[1] - 1) * s.along_v;
        s.along_v = -s.along_v;
    }
    const void* const data = field_.samples().frames()[moment.from].volume.data();
    float* const to = layer.values.data();
    with_type(field_.samples().type(),
              [&](auto zero) { copy_layer<decltype(zero)>(data, s, size_[0], size_[1], to); });
}

/// Of edited samples, or between two frames: one by one.
void SliceSamples::load_changed(Layer& layer) const {
    const Geometry& geometry = field_.geometry();
    Index3 at;
    at[plane_.axis] = layer.number;
    const auto along = [&](const ScreenAxis& screen, int i) {
        at[screen.axis] = screen.flip ? geometry.size[screen.axis] - 1 - i : i;
    };
    for (int v = 0; v < size_[1]; ++v) {
        along(plane_.down, v);
        float* const to =
            layer.values.data() + static_cast<std::ptrdiff_t>(v + 1) * (size_[0] + 2) + 1;
        for (int u = 0; u < size_[0]; ++u) {
            along(plane_.right, u);
            to[u] = static_cast<float>(field_.samples().sample(at, field_.moment()));
        }
    }
}

void SliceSamples::interpolate(int v, float* values) const {
    const int last = field_.geometry().size[plane_.axis] - 1;
    const float* const before = row(0, v);
    const bool only_before = fraction_ == 0 || layers_[0].number >= last;
    const bool only_after = !only_before && layers_[0].number < 0;
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

GreyWindow usual_window(const Volume& volume) {
    std::vector<double> values =
        with_type(volume.type(), [&](auto zero) { return spread_samples<decltype(zero)>(volume); });
    const auto percentile = [&](double part) {
        const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), values.begin() + at, values.end());
        return values[static_cast<std::size_t>(at)];
    };
    const GreyWindow window{percentile(0.01), percentile(0.99)};
    // A mask, or a body in a great void.
    if (window.high > window.low) return window;
    return {volume.minimum(), volume.minimum() + volume.range()};
}

}  // namespace palpate::viewer
