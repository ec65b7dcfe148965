// Applies edits to the samples that were read, and joins them with the overview; see the header.
#include "apps/viewer/model/detail_maker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/viewer/model/sample_block.hpp"

namespace palpate::viewer {
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
