// Averages layers of samples, several at once.
#include "apps/viewer/model/coarse_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <vector>

#include "apps/viewer/model/at_once.hpp"
#include "apps/viewer/model/sample_block.hpp"

namespace palpate::viewer {
namespace {

/// Sums and extremes of samples that go into the same coarse ones.
struct Sums {
    std::vector<float> mean, most;

    explicit Sums(std::size_t count)
        : mean(count, 0), most(count, -std::numeric_limits<float>::infinity()) {}
};

struct Averaging {
    int every;
    float sign;  // of what is solid

    int half() const { return every / 2; }
    /// A sample half way to the next coarse one goes into both.
    float weight(int offset) const {
        const bool shared = 2 * std::abs(offset) == every;
        return (shared ? 0.5F : 1.0F) / static_cast<float>(every);
    }
    /// Adds `count` values of a sample at `offset`.
    void add(float* mean, float* most, int offset, const float* means, const float* mosts,
             std::size_t count) const {
        const float w = weight(offset);
        for (std::size_t i = 0; i < count; ++i) mean[i] += w * means[i];
        for (std::size_t i = 0; i < count; ++i) most[i] = std::max(most[i], mosts[i]);
    }
};

/// Calls f(offset, place) for the samples round coarse sample `at`; beyond the ends the last one
/// goes on.
template <class F>
void for_samples(const Averaging& averaging, int at, int count, F f) {
    const int half = averaging.half();
    for (int offset = -half; offset <= half; ++offset) {
        f(offset,
          static_cast<std::size_t>(std::clamp(at * averaging.every + offset, 0, count - 1)));
    }
}

/// One layer of coarse samples.
void average_layer(const Field& field, const Averaging& averaging, int layer, float extreme,
                   float* coarse) {
    const Index3 size = field.geometry().size;
    const Index3 small = coarse_size(size, averaging.every);
    const auto width = static_cast<std::size_t>(size[0]),
               height = static_cast<std::size_t>(size[1]);
    Sums plane(width * height);
    for_samples(averaging, layer, size[2], [&](int offset, std::size_t z) {
        auto samples = sample_block(field, {0, 0, static_cast<int>(z)}, {size[0], size[1], 1});
        for (float& sample : samples) sample *= averaging.sign;
        averaging.add(plane.mean.data(), plane.most.data(), offset, samples.data(), samples.data(),
                      samples.size());
    });
    for (int j = 0; j < small[1]; ++j) {
        Sums line(width);
        for_samples(averaging, j, size[1], [&](int offset, std::size_t y) {
            averaging.add(line.mean.data(), line.most.data(), offset, plane.mean.data() + y * width,
                          plane.most.data() + y * width, width);
        });
        for (int i = 0; i < small[0]; ++i) {
            Sums one(1);
            for_samples(averaging, i, size[0], [&](int offset, std::size_t x) {
                averaging.add(one.mean.data(), one.most.data(), offset, &line.mean[x],
                              &line.most[x], 1);
            });
            *coarse++ = averaging.sign * std::lerp(one.mean[0], one.most[0], extreme);
        }
    }
}

/// Makes layers `first` to `last` of the coarse samples anew.
Volume averaged(const Field& field, int every, double extreme, std::vector<float> samples,
                int first, int last) {
    Geometry geometry = field.geometry();
    geometry.size = coarse_size(geometry.size, every);
    geometry.spacing *= every;
    const Averaging averaging{every, static_cast<float>(field.sign())};
    const std::size_t layer =
        static_cast<std::size_t>(geometry.size[0]) * static_cast<std::size_t>(geometry.size[1]);
    samples.resize(static_cast<std::size_t>(sample_count(geometry)));
    std::vector<std::size_t> layers(static_cast<std::size_t>(std::max(0, last - first + 1)));
    std::iota(layers.begin(), layers.end(), static_cast<std::size_t>(first));
    for_each_at_once(layers, [&](std::size_t k) {
        average_layer(field, averaging, static_cast<int>(k), static_cast<float>(extreme),
                      samples.data() + k * layer);
        return true;
    });
    return Volume(geometry, std::move(samples));
}

}  // namespace

SampleBox coarse_part(const SampleBox& box, const Index3& size, int every) {
    const int half = every / 2;
    const auto up = [&](int i) { return (std::max(i, 0) + every - 1) / every; };
    SampleBox part;
    for (int a = 0; a < 3; ++a) {
        part.low[a] = up(box.low[a] - half);
        part.high[a] = std::min((std::min(box.high[a], size[a] - 1) + half) / every,
                                coarse_size(size, every)[a] - 1);
    }
    return part;
}

Volume coarse_volume(const Field& field, int every, double extreme) {
    const int last = coarse_size(field.geometry().size, every)[2] - 1;
    return averaged(field, every, extreme, {}, 0, last);
}

Field CoarseSamples::of(const Field& field) {
    constexpr double extreme = 0.5;
    if (!volume_) {
        volume_ = coarse_volume(field, every_, extreme);
    } else if (!changed_.empty()) {
        const auto before = volume_->samples<float>();
        const SampleBox part = coarse_part(changed_, field.geometry().size, every_);
        volume_ = averaged(field, every_, extreme, {before.begin(), before.end()}, part.low[2],
                           part.high[2]);
    }
    changed_ = {};
    return Field(*volume_, field.solid(), field.background(), field.interpolation());
}

}  // namespace palpate::viewer
