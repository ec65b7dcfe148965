// Chooses levels and boxes of a store for slices and scene, applies edits to the samples that were
// read, and blends them into the overview.
#include "apps/viewer/model/detail.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/model/worker.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {
namespace {

/// A sample may be so many pixels wide before a finer level is worth it.
constexpr double coarse_enough = 1.4;
/// Margin beyond each edge of the visible part of a slice, relative to its size.
constexpr double wider = 0.25;
/// Layers of a slice's box: at least those that a smooth field needs, at most this many.
constexpr int fewest_layers = 4, most_layers = 16;
/// Levels from one that is read to the next finer one.
constexpr int stride = 2;

const stream::Level& level_of(const SeenStore& store, int level) {
    return store.info->levels[static_cast<std::size_t>(level)];
}

struct Cost {
    std::int64_t samples, pieces;
    double bytes;
};

Cost cost_of(const stream::Level& level, SampleType type, const SampleBox& box) {
    const auto each = static_cast<double>(size_of(type));
    const Index3 size = box.high - box.low + Index3::Ones();
    Cost cost{size.cast<std::int64_t>().prod(), 0, 0};
    const bool is_row = level.chunk[1] == 1 && level.chunk[2] == 1;
    if (is_row) {
        cost.pieces = std::int64_t{size[1]} * size[2];
        cost.bytes = static_cast<double>(cost.samples) * each;
        return cost;
    }
    const Index3 pieces =
        box.high.cwiseQuotient(level.chunk) - box.low.cwiseQuotient(level.chunk) + Index3::Ones();
    cost.pieces = pieces.cast<std::int64_t>().prod();
    cost.bytes = static_cast<double>(cost.pieces) * level.chunk.cast<double>().prod() * each;
    return cost;
}

bool is_finer(const Geometry& a, const Geometry& b) {
    constexpr double clearly = 0.9;
    return a.spacing.prod() < std::pow(clearly, 3) * b.spacing.prod();
}

/// Both corners in index space, the lower one first.
std::pair<Vec3, Vec3> corners_in(const Geometry& level, const SeenBox& seen) {
    const Vec3 a = index_from_physical(level, seen.from), b = index_from_physical(level, seen.to);
    return {a.cwiseMin(b), a.cwiseMax(b)};
}

}  // namespace

SampleBox samples_in(const Geometry& level, const SeenBox& seen, const Index3& margin) {
    const auto [low, high] = corners_in(level, seen);
    const Vec3 last = (level.size - Index3::Ones()).cast<double>();
    const auto inside = [&](const Vec3& at) {
        return Index3(at.cwiseMax(Vec3::Zero()).cwiseMin(last).cast<int>());
    };
    const Vec3 more = margin.cast<double>();
    return {inside(low.array().floor() - more.array()), inside(high.array().ceil() + more.array())};
}

bool fits(const SeenStore& store, int level, const SampleBox& box, const DetailLimits& limits) {
    const Cost cost = cost_of(level_of(store, level), store.info->type, box);
    return cost.samples <= limits.most_samples && cost.pieces <= limits.most_pieces &&
           cost.bytes <= static_cast<double>(limits.most_bytes);
}

std::vector<int> finer_levels(const SeenStore& store, double pixel_mm) {
    std::vector<int> levels;
    for (int l = static_cast<int>(store.info->levels.size()) - 1; l >= store.finest; --l) {
        const Geometry& level = level_of(store, l).geometry;
        if (!is_finer(level, store.overview)) continue;
        levels.insert(levels.begin(), l);
        if (level.spacing.minCoeff() <= coarse_enough * pixel_mm) break;
    }
    return levels;
}

std::optional<int> level_for(const SeenStore& store, const SeenBox& seen,
                             const DetailLimits& limits) {
    for (const int level : finer_levels(store, seen.pixel_mm)) {
        const SampleBox box = samples_in(level_of(store, level).geometry, seen, Index3::Zero());
        if (fits(store, level, box, limits)) return level;
    }
    return std::nullopt;
}

std::vector<stream::DetailBox> coarse_to_fine(const SeenStore& store, int level,
                                              const SampleBox& box) {
    std::vector<stream::DetailBox> boxes{{level, box}};
    const Geometry& fine = level_of(store, level).geometry;
    const SeenBox seen{physical_from_index(fine, box.low.cast<double>()),
                       physical_from_index(fine, box.high.cast<double>()), 1};
    const auto levels = static_cast<int>(store.info->levels.size());
    for (int l = level + stride; l < levels; l += stride) {
        const Geometry& coarse = level_of(store, l).geometry;
        if (!is_finer(coarse, store.overview)) break;
        boxes.insert(boxes.begin(), {l, samples_in(coarse, seen, Index3::Ones())});
    }
    return boxes;
}

SampleBox slice_box(const SeenStore& store, int level, const SeenBox& seen, int axis) {
    const stream::Level& l = level_of(store, level);
    const auto [low, high] = corners_in(l.geometry, seen);
    Index3 margin = (wider * (high - low)).array().ceil().cast<int>() + 3;
    const int layers = std::clamp(l.chunk[axis], fewest_layers, most_layers);
    margin[axis] = layers / 2 - 1;
    return samples_in(l.geometry, seen, margin);
}

bool has_slice(const SeenStore& store, const stream::DetailBox& box, const SeenBox& seen,
               int axis) {
    Index3 margin = Index3::Constant(2);
    margin[axis] = fewest_layers / 2 - 1;
    const SampleBox needed = samples_in(level_of(store, box.level).geometry, seen, margin);
    return united(box.box, needed) == box.box;
}

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
/// Margin on each side of the visible part, so that a small move needs nothing new.
constexpr double room_around = 0.1;
/// Fine samples beyond the planes: the cells and normals of a smooth surface need them.
constexpr int beyond = 2;
/// Over so many fine samples at most one field becomes the other.
constexpr double widest_rim = 4;

struct Bounds {
    Vec3 low = Vec3::Constant(unbounded), high = Vec3::Constant(-unbounded);
};

/// In the overview's index space, of the points within `radius` [mm] of the middle.
Bounds bounds_of(const SeenStore& store, const SeenPoints& seen, double radius) {
    Bounds bounds;
    for (const Vec3& point : seen.points) {
        if (!((point - seen.middle).norm() <= radius)) continue;
        const Vec3 index = index_from_physical(store.overview, point);
        bounds.low = bounds.low.cwiseMin(index);
        bounds.high = bounds.high.cwiseMax(index);
    }
    return bounds;
}

/// Whole cells around the bounds, and one more on each side, in which the fields become one.
PatchChoice cells_round(const SeenStore& store, int level, const Bounds& bounds,
                        Interpolation interpolation) {
    const double begin = interpolation == Interpolation::cubic ? -0.5 : 0;
    PatchChoice patch;
    patch.level = level;
    Vec3 from, to;  // in the overview's index space
    for (int a = 0; a < 3; ++a) {
        const double low = std::floor(bounds.low[a] - begin) - 1 + begin;
        const double high = std::ceil(bounds.high[a] - begin) + 1 + begin;
        const double last = store.overview.size[a] - 1;
        patch.low[a] = low <= 0 ? -unbounded : low;
        patch.high[a] = high >= last ? unbounded : high;
        // The levels' last samples lie in different places.
        from[a] = low <= 0 ? -2 : low;
        to[a] = high >= last ? last + 2 : high;
    }
    const Geometry& grid = store.info->levels[static_cast<std::size_t>(level)].geometry;
    const SeenBox box{physical_from_index(store.overview, from),
                      physical_from_index(store.overview, to), 1};
    patch.box = samples_in(grid, box, Index3::Constant(beyond));
    return patch;
}

bool is_inside(const PatchChoice& patch, const Bounds& bounds) {
    return (bounds.low.array() >= patch.low.array()).all() &&
           (bounds.high.array() <= patch.high.array()).all();
}

/// The wanted part, without the margin for small moves.
struct Wanted {
    int level;
    Bounds bounds;
};

std::optional<Wanted> wanted_of(const SeenStore& store, const SeenPoints& seen,
                                Interpolation interpolation, const DetailLimits& limits) {
    if (seen.points.empty()) return std::nullopt;
    const std::vector<int> levels = finer_levels(store, seen.pixel_mm);
    for (const int level : levels) {
        for (const double radius : {unbounded, 4 * seen.half_height, 2 * seen.half_height}) {
            Bounds bounds = bounds_of(store, seen, radius);
            if (!(bounds.low.array() <= bounds.high.array()).all()) continue;
            const Vec3 more = room_around * (bounds.high - bounds.low);
            const Bounds all{bounds.low - more, bounds.high + more};
            const PatchChoice patch = cells_round(store, level, all, interpolation);
            if (fits(store, level, patch.box, limits)) return Wanted{level, bounds};
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<PatchChoice> patch_for(const SeenStore& store, const SeenPoints& seen,
                                     Interpolation interpolation, const DetailLimits& limits) {
    const auto wanted = wanted_of(store, seen, interpolation, limits);
    if (!wanted) return std::nullopt;
    const Vec3 more = room_around * (wanted->bounds.high - wanted->bounds.low);
    const Bounds all{wanted->bounds.low - more, wanted->bounds.high + more};
    return cells_round(store, wanted->level, all, interpolation);
}

bool is_enough(const PatchChoice& patch, const SeenStore& store, const SeenPoints& seen,
               Interpolation interpolation, const DetailLimits& limits) {
    const auto wanted = wanted_of(store, seen, interpolation, limits);
    if (!wanted || wanted->level != patch.level) return false;
    // The rim does not count.
    const Bounds needed{wanted->bounds.low - Vec3::Ones(), wanted->bounds.high + Vec3::Ones()};
    return is_inside(patch, needed);
}

Volume joined_samples(const Volume& fine, const Field& overview, const PatchChoice& patch) {
    const Geometry& grid = fine.geometry();
    const Geometry& coarse = overview.geometry();
    const double rim =
        std::min(1.0, widest_rim * (grid.spacing.cwiseQuotient(coarse.spacing)).maxCoeff());
    // The weight of the fine samples along each axis: 0 at a plane and outside, 1 a rim inside.
    std::array<std::vector<double>, 3> weight;
    for (int a = 0; a < 3; ++a) {
        for (int i = 0; i < grid.size[a]; ++i) {
            Vec3 index = Vec3::Zero();
            index[a] = i;
            const double at = index_from_physical(coarse, physical_from_index(grid, index))[a];
            const double inside = std::min(at - patch.low[a], patch.high[a] - at);
            weight[static_cast<std::size_t>(a)].push_back(std::clamp(inside / rim, 0.0, 1.0));
        }
    }
    const auto bytes = std::make_shared<std::vector<std::byte>>(
        static_cast<const std::byte*>(fine.data()),
        static_cast<const std::byte*>(fine.data()) + fine.bytes());
    std::vector<std::size_t> layers(static_cast<std::size_t>(grid.size[2]));
    std::iota(layers.begin(), layers.end(), std::size_t{0});
    with_type(fine.type(), [&](auto zero) {
        using T = decltype(zero);
        T* const samples = reinterpret_cast<T*>(bytes->data());
        for_each_at_once(layers, [&](std::size_t k) {
            for (int j = 0; j < grid.size[1]; ++j) {
                const double across =
                    std::min(weight[2][k], weight[1][static_cast<std::size_t>(j)]);
                T* const row = samples + (k * static_cast<std::size_t>(grid.size[1]) +
                                          static_cast<std::size_t>(j)) *
                                             static_cast<std::size_t>(grid.size[0]);
                for (int i = 0; i < grid.size[0]; ++i) {
                    const double t = std::min(across, weight[0][static_cast<std::size_t>(i)]);
                    if (t >= 1) continue;
                    const double w = t * t * (3 - 2 * t);
                    const Vec3 at = physical_from_index(grid, Vec3(i, j, static_cast<double>(k)));
                    const double value = w * double(row[i]) + (1 - w) * value_at(overview, at);
                    row[i] = std::is_integral_v<T> ? static_cast<T>(std::nearbyint(value))
                                                   : static_cast<T>(value);
                }
            }
            return true;
        });
    });
    return {grid, fine.type(), std::shared_ptr<const void>(bytes, bytes->data()), bytes->size()};
}

namespace {

/// How far from an edit the border's samples may change [overview samples]: the smooth field
/// reaches two, and a sample of the overview shows edits up to a half away.
constexpr double overview_reach = 2.5;

/// The samples of the touched grid whose edits differ. Null has none.
SampleBox edited_since(const Samples* before, const Samples& now) {
    if (before) return edited_between(*before, now);
    if (!now.bricks()) return {};
    return edited_between(now.with(Bricks(now.geometry().size), 0, 0), now);
}

/// Samples of one grid that lie in a box of samples of another, with so many more on each side. The
/// grids have the same directions.
SampleBox in_grid(const Geometry& grid, const Geometry& other, const SampleBox& box,
                  const Vec3& more) {
    if (box.empty()) return box;
    const auto at = [&](const Vec3& index) {
        return index_from_physical(grid, physical_from_index(other, index));
    };
    const Vec3 half = Vec3::Constant(0.5);
    const Vec3 low = (at(box.low.cast<double>() - half) - more).array().floor();
    const Vec3 high = (at(box.high.cast<double>() + half) + more).array().ceil();
    const Vec3 end = grid.size.cast<double>();
    return {low.cwiseMax(0).cwiseMin(end).cast<int>(),
            high.cwiseMax(-1).cwiseMin(end - Vec3::Ones()).cast<int>()};
}

}  // namespace

DetailMaker::DetailMaker(const Field& overview, std::vector<Index3> level_sizes, Made made,
                         const std::function<void()>& begin_thread)
    : overview_(overview),
      level_sizes_(std::move(level_sizes)),
      made_(std::move(made)),
      shown_overview_(overview.volume()),
      thread_([this, begin_thread](const std::stop_token& stop) {
          if (begin_thread) begin_thread();
          run(stop);
      }) {}

void DetailMaker::show(int viewer, stream::Detail detail) {
    const std::scoped_lock lock(mutex_);
    Place& place = places_[static_cast<std::size_t>(viewer)];
    const bool same_box = place.detail && place.detail->of == detail.of;
    place.changed =
        same_box ? united(place.changed, detail.changed) : whole_box(detail.volume.geometry());
    place.detail = std::move(detail);
    place.due = true;
    changed_.notify_all();
}

void DetailMaker::use_edits(const Samples& felt) {
    const std::scoped_lock lock(mutex_);
    if (edited_since(edited_.get(), felt).empty()) return;
    // Held for as long as nothing is edited, so it must not hold bricks that go.
    edited_ = std::make_shared<const Samples>(felt.with(ResidentBricks(felt.geometry().size)));
    for (Place& place : places_) place.due = place.detail.has_value();
    changed_.notify_all();
}

void DetailMaker::want_patch(const std::optional<PatchChoice>& patch) {
    const std::scoped_lock lock(mutex_);
    patch_ = patch;
}

bool DetailMaker::idle() const {
    const std::scoped_lock lock(mutex_);
    bool due = making_;
    for (const Place& place : places_) due = due || place.due;
    return !due;
}

/// Needs the lock.
std::optional<DetailMaker::Job> DetailMaker::next_job() {
    for (int viewer = 0; viewer < viewers; ++viewer) {
        Place& place = places_[static_cast<std::size_t>(viewer)];
        if (!std::exchange(place.due, false)) continue;
        const bool wanted = viewer != scene || (patch_ && place.detail->of == *patch_);
        if (!wanted) continue;
        return Job{viewer, *place.detail, std::exchange(place.changed, {}), edited_, patch_};
    }
    return std::nullopt;
}

void DetailMaker::run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        const std::optional<Job> job = next_job();
        if (!job) {
            changed_.wait(lock, stop, [&] {
                return std::ranges::any_of(places_, [](const Place& place) { return place.due; });
            });
            continue;
        }
        making_ = true;
        lock.unlock();
        make(*job);
        lock.lock();
        making_ = false;
    }
}

void DetailMaker::make(const Job& job) {
    Place& place = places_[static_cast<std::size_t>(job.viewer)];
    const Volume& read = job.detail.volume;
    if (!place.shown || place.read != read.data()) {
        place.shown.emplace(read);
        place.read = read.data();
        place.samples = std::make_shared<const Samples>(read);
    }
    if (job.edited) place.samples = place.shown->of(*job.edited);
    const Vec3 cell = overview_.geometry().spacing.cwiseQuotient(read.geometry().spacing);
    SampleBox changed = job.changed;
    if (job.edited) {
        const Vec3 reach = job.viewer == scene ? Vec3(overview_reach * cell) : Vec3(Vec3::Zero());
        const SampleBox edits = edited_since(place.edited.get(), *job.edited);
        changed = united(changed, in_grid(read.geometry(), job.edited->geometry(), edits, reach));
    }
    place.edited = job.edited;
    std::shared_ptr<const Samples> samples = place.samples;
    if (job.viewer == scene) {
        Field overview = overview_;
        if (job.edited) overview.use(shown_overview_.of(*job.edited));
        samples = std::make_shared<const Samples>(
            joined_samples(flattened(*samples), overview, *job.patch));
    }
    const auto level = static_cast<std::size_t>(job.detail.of.level);
    made_(job.viewer, std::make_shared<const DetailField>(DetailField{
                          Field(std::move(samples), overview_.solid(), overview_.background(),
                                overview_.interpolation()),
                          job.detail.of, level_sizes_[level], job.detail.missing, changed}));
}

}  // namespace palpate::viewer
