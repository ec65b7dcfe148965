// Copies rows of the frames, then the edited bricks over them, and averages them for previews.
#include "apps/viewer/model/sample_block.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <vector>

#include "apps/viewer/model/worker.hpp"

namespace palpate::viewer {
namespace {

struct Box {
    Index3 low, size;

    std::size_t place(const Index3& at) const {
        const Index3 in = at - low;
        return (static_cast<std::size_t>(in[2]) * size[1] + in[1]) * size[0] + in[0];
    }
};

/// The part of the box that lies in `low` to `high`.
SampleBox cut(const Box& box, const Index3& low, const Index3& high) {
    return {box.low.cwiseMax(low), (box.low + box.size - Index3::Ones()).cwiseMin(high)};
}

/// Calls f(to, from, count) for each row: `count` samples, the first at index `from` of the grid.
template <class F>
void for_rows(const Box& box, const SampleBox& part, F f) {
    if (part.empty()) return;
    const int count = part.high[0] - part.low[0] + 1;
    for (int k = part.low[2]; k <= part.high[2]; ++k) {
        for (int j = part.low[1]; j <= part.high[1]; ++j) {
            const Index3 at(part.low[0], j, k);
            f(box.place(at), at, count);
        }
    }
}

template <class T>
void copy_frames(const Field& field, const Box& box, float* out) {
    const Index3& size = field.geometry().size;
    const Moment& moment = field.moment();
    const auto frames = field.samples().frames();
    const T* const first = static_cast<const T*>(frames[moment.from].volume.data());
    const T* const later = static_cast<const T*>(frames[moment.to].volume.data());
    const double weight = moment.weight;
    for_rows(box, cut(box, Index3::Zero(), size - Index3::Ones()),
             [&](std::size_t to, const Index3& from, int count) {
                 const auto at =
                     (static_cast<std::size_t>(from[2]) * size[1] + from[1]) * size[0] + from[0];
                 float* const row = out + to;
                 for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
                     const std::size_t s = at + i;
                     row[i] = weight > 0 ? static_cast<float>((1 - weight) * double(first[s]) +
                                                              weight * double(later[s]))
                                         : static_cast<float>(first[s]);
                 }
             });
}

template <class T>
void copy_bricks(const Field& field, const Bricks& bricks, const Box& box, float* out) {
    const Index3 last = field.geometry().size - Index3::Ones();
    const Index3 from = box.low.cwiseMax(0);
    const Index3 to = (box.low + box.size - Index3::Ones()).cwiseMin(last);
    constexpr int n = Bricks::edge;
    for (int k = from[2] / n; k <= to[2] / n && to[2] >= 0; ++k) {
        for (int j = from[1] / n; j <= to[1] / n && to[1] >= 0; ++j) {
            for (int i = from[0] / n; i <= to[0] / n && to[0] >= 0; ++i) {
                const Index3 low = n * Index3(i, j, k);
                const Brick* const found = bricks.of_sample(low);
                if (!found) continue;
                const T* const brick = reinterpret_cast<const T*>(found->samples.get());
                // Its last layer is the first of the next, which holds the same there.
                const SampleBox part =
                    cut(box, low, Index3((low + Index3::Constant(n - 1)).cwiseMin(last)));
                for_rows(box, part, [&](std::size_t place, const Index3& at, int count) {
                    const Index3 in = at - low;
                    const T* const row = brick + Bricks::place_of(in);
                    for (int s = 0; s < count; ++s) {
                        out[place + static_cast<std::size_t>(s)] = static_cast<float>(row[s]);
                    }
                });
            }
        }
    }
}

template <class T>
void copy(const Field& field, const Box& box, float* out) {
    copy_frames<T>(field, box, out);
    if (const Bricks* bricks = field.samples().bricks()) copy_bricks<T>(field, *bricks, box, out);
}

}  // namespace

std::vector<float> sample_block(const Field& field, const Index3& low, const Index3& size) {
    const Box box{low, size};
    std::vector<float> values(static_cast<std::size_t>(size.cast<std::int64_t>().prod()),
                              static_cast<float>(field.background()));
    with_type(field.samples().type(),
              [&](auto zero) { copy<decltype(zero)>(field, box, values.data()); });
    return values;
}

bool same_samples(const Field& a, const Field& b) {
    const Moment &m = a.moment(), &n = b.moment();
    return a.shared_samples() == b.shared_samples() && m.from == n.from && m.to == n.to &&
           m.weight == n.weight;
}

namespace {

/// False where more than edits differs: the moment, the volume under them, the side that is solid.
bool same_but_for_edits(const Field& a, const Field& b) {
    const Moment &m = a.moment(), &n = b.moment();
    const auto data = [](const Field& f, std::size_t frame) {
        return f.samples().frames()[frame].volume.data();
    };
    // By the frames at hand: others may have come into memory.
    return a.solid() == b.solid() && a.interpolation() == b.interpolation() &&
           a.background() == b.background() && a.geometry() == b.geometry() &&
           a.samples().type() == b.samples().type() && m.weight == n.weight &&
           data(a, m.from) == data(b, n.from) && (m.weight == 0 || data(a, m.to) == data(b, n.to));
}

}  // namespace

SampleBox changed_between(const Field& a, const Field& b) {
    if (!same_but_for_edits(a, b)) return whole_box(b.geometry());
    return edited_between(a.samples(), b.samples());
}

SampleBox edited_between(const Samples& a, const Samples& b) {
    const Bricks *old = a.bricks(), *now = b.bricks();
    SampleBox changed;
    if (!old && !now) return changed;
    const Bricks none(old && now ? Index3(Index3::Ones()) : b.geometry().size);
    (now ? *now : none)
        .for_each_apart(old ? *old : none, [&](const Index3& brick, const auto&, const auto&) {
            const Index3 low = Bricks::edge * brick;
            changed = united(changed, {low, low + Index3::Constant(Bricks::edge)});
        });
    return changed;
}

namespace {

using Row = Eigen::ArrayXf;
using RowView = Eigen::Map<const Row>;

/// Sums of the samples that form one coarse sample, times the sign of the solid side.
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
