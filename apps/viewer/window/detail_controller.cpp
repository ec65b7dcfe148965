// Chooses levels and parts for the views, from what they show.
#include "apps/viewer/window/detail_controller.hpp"

#include <algorithm>

#include "apps/viewer/scene/background_renderer.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/scene/threads.hpp"
#include "apps/viewer/slices/slice_pane.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

/// Memory for decoded pieces: a quarter of the hand's, but enough for a screen.
constexpr std::uint64_t least_memory = std::uint64_t{1} << 27, memory_part = 4;
constexpr std::int64_t most_slice_samples = 1 << 21, most_patch_samples = 1 << 24;
constexpr std::int64_t most_pieces = 1 << 16;
/// Interval between two incomplete versions, because drawing and extracting take time.
constexpr std::chrono::milliseconds slice_interval{250}, patch_interval{1500};
/// A view that is still for so long is worth a finer surface.
constexpr qint64 rest_ms = 200;

std::uint64_t memory_of(const run::StreamedVolume& streamed) {
    return std::max(least_memory, streamed.loader.memory / memory_part);
}

bool touches(const std::optional<Snapshot>& now) {
    return now && now->session.tick.proxy.mode == Mode::constrained &&
           now->session.tick.proxy.scp.allFinite();
}

}  // namespace

DetailController::DetailController(const Desk& desk) : Controller(desk) {
    connect(&content_, &Content::closing, this, &DetailController::end);
    for (const auto begins :
         {&Content::run_started, &Content::field_replaced, &Content::playback_started}) {
        connect(&content_, begins, this, &DetailController::begin);
    }
}

DetailController::~DetailController() = default;

void DetailController::end() {
    reader_.reset();
    maker_.reset();
    ++generation_;
    wanted_ = {};
    patch_.reset();
    view_.reset();
    chosen_for_.reset();
    made_ = {};
    store_ = {};
    held_.reset();
}

void DetailController::begin() {
    end();
    const run::LoadedVolume& loaded = content_.volume()->loaded;
    if (!loaded.streamed) return;
    held_ = loaded.streamed->store;
    store_ = {&held_->info(), loaded.streamed->loader.level, loaded.volume.geometry()};
    memory_ = memory_of(*loaded.streamed);
    const Field felt = content_.felt();
    interpolation_ = felt.interpolation();
    std::vector<Index3> sizes;
    for (const stream::Level& level : store_.info->levels) sizes.push_back(level.geometry.size);
    maker_ = std::make_shared<DetailMaker>(
        Field(loaded.volume, felt.solid(), felt.background(), felt.interpolation()),
        std::move(sizes),
        [this, generation = generation_](int viewer, const auto& made) {
            ++handed_over_;
            hand_over(this, [this, generation, viewer, made] {
                --handed_over_;
                take(generation, viewer, made);
            });
        },
        lower_thread_priority);
    stream::DetailSettings settings;
    settings.memory = memory_;
    settings.begin_thread = lower_thread_priority;
    settings.shared = loaded.streamed->loader.shared;
    reader_ = std::make_unique<stream::DetailReader>(
        held_, loaded.volume, settings, [maker = maker_](int viewer, stream::Detail detail) {
            maker->show(viewer, std::move(detail));
        });
}

void DetailController::take(std::uint64_t generation, int viewer,
                            const std::shared_ptr<const DetailField>& made) {
    const auto place = static_cast<std::size_t>(viewer);
    if (generation != generation_ || wanted_[place] != made->of) return;
    made_[place] = made;
    if (viewer == scene) {
        views_.scene().set_patch(ScenePatch{made, {store_.overview, patch_->low, patch_->high}});
    } else {
        views_.slice(viewer).set_detail(made);
    }
}

void DetailController::observe(const std::optional<Snapshot>& now) {
    if (!reader_) return;
    if (now) maker_->use_edits(content_.felt_at(*now).samples());
    for (int axis = 0; axis < scene; ++axis) observe_slice(axis);
    observe_scene(now);
}

std::optional<int> DetailController::level_of_slice(const std::optional<SeenBox>& seen) const {
    const DetailLimits limits{most_slice_samples, memory_, most_pieces};
    return seen ? level_for(store_, *seen, limits) : std::nullopt;
}

/// Whether the part that was requested is the one that this slice needs.
bool DetailController::has(int axis, const std::optional<SeenBox>& seen) const {
    const auto& wanted = wanted_[static_cast<std::size_t>(axis)];
    const auto level = level_of_slice(seen);
    if (!level || !wanted) return level.has_value() == wanted.has_value();
    return wanted->level == *level && has_slice(store_, *wanted, *seen, axis);
}

void DetailController::observe_slice(int axis) {
    const auto seen = views_.slice(axis).seen();
    if (has(axis, seen)) return;
    const auto level = level_of_slice(seen);
    if (!level && seen) views_.slice(axis).set_detail(nullptr);
    want(axis,
         level ? std::optional(stream::DetailBox{*level, slice_box(store_, *level, *seen, axis)})
               : std::nullopt,
         slice_interval);
}

void DetailController::want(int viewer, const std::optional<stream::DetailBox>& box,
                            std::chrono::milliseconds interval) {
    const auto place = static_cast<std::size_t>(viewer);
    wanted_[place] = box;
    if (box) return reader_->want(viewer, coarse_to_fine(store_, box->level, box->box), interval);
    made_[place].reset();
    reader_->forget(viewer);
}

DetailController::SceneView DetailController::view_now() const {
    const Scene& shown = views_.scene();
    return {shown.camera(), shown.width(), shown.height(), views_.shown().isovalue};
}

/// Once the view rests and the picture of it is there, whose depths tell what is seen.
void DetailController::observe_scene(const std::optional<Snapshot>& now) {
    const Scene& shown = views_.scene();
    if (!shown.isVisible()) return;
    const SceneView view = view_now();
    if (!(view_ == view)) {
        view_ = view;
        rested_.start();
        return;
    }
    if (rested_.elapsed() < rest_ms || !shown.shows_whole()) return;
    const bool left = touches(now) && patch_ && chosen_for_ == view && !is_in_patch(*now);
    if (chosen_for_ == view && !left) return;
    chosen_for_ = view;
    rested_.start();
    choose_patch(now);
}

bool DetailController::is_in_patch(const Snapshot& now) const {
    const Vec3 index = index_from_physical(store_.overview, now.session.tick.proxy.scp);
    return (index.array() >= patch_->low.array()).all() &&
           (index.array() <= patch_->high.array()).all();
}

void DetailController::choose_patch(const std::optional<Snapshot>& now) {
    auto seen = views_.scene().seen_points();
    if (!seen) return;
    if (touches(now) && views_.scene().is_in_view(now->session.tick.proxy.scp)) {
        seen->middle = now->session.tick.proxy.scp;
        seen->points.push_back(seen->middle);
    }
    const DetailLimits limits{most_patch_samples, memory_, most_pieces};
    if (patch_ && is_enough(*patch_, store_, *seen, interpolation_, limits)) return;
    patch_ = patch_for(store_, *seen, interpolation_, limits);
    maker_->want_patch(patch_);
    want(scene, patch_, patch_interval);
    if (!patch_) views_.scene().set_patch(std::nullopt);
}

bool DetailController::settled() const {
    if (!reader_) return true;
    const stream::DetailStatus status = reader_->status();
    bool all = !views_.scene().isVisible() || chosen_for_ == view_now();
    for (int axis = 0; axis < scene; ++axis) all = all && has(axis, views_.slice(axis).seen());
    for (std::size_t i = 0; i < made_.size(); ++i) {
        all = all &&
              (!wanted_[i] || (made_[i] && made_[i]->of == *wanted_[i] && made_[i]->missing == 0));
    }
    return (all && maker_->idle() && handed_over_ == 0) || status.failed > 0;
}

DetailController::State DetailController::state() const {
    State state;
    if (!reader_) return state;
    state.reading = reader_->status();
    state.felt = store_.finest;
    const auto& levels = store_.info->levels;
    for (std::size_t l = 0; l < levels.size(); ++l) {
        if (levels[l].geometry == store_.overview) state.overview = static_cast<int>(l);
    }
    state.finest = state.overview;
    for (const auto& made : made_) {
        if (made && (!state.finest || made->of.level < *state.finest))
            state.finest = made->of.level;
    }
    return state;
}

}  // namespace palpate::viewer
