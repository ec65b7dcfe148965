// Averages layers of samples, several at once.
#include "apps/viewer/model/coarse_samples.hpp"

#include <Eigen/Core>
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

using Row = Eigen::ArrayXf;
using RowView = Eigen::Map<const Row>;

/// Of samples, times the sign of what is solid, that go into the same coarse ones.
struct Sums {
    Row mean, most;

    explicit Sums(Eigen::Index count)
        : mean(Row::Zero(count)),
          most(Row::Constant(count, -std::numeric_limits<float>::infinity())) {}
    template <class Means, class Mosts>
    void add(float weight, const Means& means, const Mosts& mosts) {
        mean += weight * means;
        most = most.max(mosts);
    }
};

/// Calls f(weight, place) for the samples round coarse sample `at`; beyond the ends the last one
/// goes on.
template <class F>
void for_samples(int every, int at, int count, F f) {
    const int half = every / 2;
    for (int offset = -half; offset <= half; ++offset) {
        // A sample half way to the next coarse one goes into both.
        const bool shared = 2 * std::abs(offset) == every;
        f((shared ? 0.5F : 1.0F) / static_cast<float>(every),
          std::clamp(at * every + offset, 0, count - 1));
    }
}

/// One layer of coarse samples.
void average_layer(const Field& field, int every, int layer, float extreme, float* coarse) {
    const auto sign = static_cast<float>(field.sign());
    const Index3 size = field.geometry().size;
    const Index3 small = coarse_size(size, every);
    const Eigen::Index width = size[0];
    Sums plane(width * size[1]);
    for_samples(every, layer, size[2], [&](float weight, int z) {
        const auto samples = sample_block(field, {0, 0, z}, {size[0], size[1], 1});
        const RowView values(samples.data(), width * size[1]);
        plane.add(sign * weight, values, sign * values);
    });
    for (int j = 0; j < small[1]; ++j) {
        Sums line(width);
        for_samples(every, j, size[1], [&](float weight, int y) {
            line.add(weight, plane.mean.segment(y * width, width),
                     plane.most.segment(y * width, width));
        });
        for (int i = 0; i < small[0]; ++i) {
            float mean = 0, most = -std::numeric_limits<float>::infinity();
            for_samples(every, i, size[0], [&](float weight, int x) {
                mean += weight * line.mean[x];
                most = std::max(most, line.most[x]);
            });
            *coarse++ = sign * std::lerp(mean, most, extreme);
        }
    }
}

/// Makes layers `first` to `last` of the coarse samples anew.
Volume averaged(const Field& field, int every, double extreme, std::vector<float> samples,
                int first, int last) {
    Geometry geometry = field.geometry();
    geometry.size = coarse_size(geometry.size, every);
    geometry.spacing *= every;
    const std::size_t layer =
        static_cast<std::size_t>(geometry.size[0]) * static_cast<std::size_t>(geometry.size[1]);
    samples.resize(static_cast<std::size_t>(sample_count(geometry)));
    std::vector<std::size_t> layers(static_cast<std::size_t>(std::max(0, last - first + 1)));
    std::iota(layers.begin(), layers.end(), static_cast<std::size_t>(first));
    for_each_at_once(layers, [&](std::size_t k) {
        average_layer(field, every, static_cast<int>(k), static_cast<float>(extreme),
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
