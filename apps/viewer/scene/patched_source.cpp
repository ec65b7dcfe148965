// Keeps a surface and its finer part, and puts them together.
#include "apps/viewer/scene/patched_source.hpp"

#include <algorithm>
#include <utility>

namespace palpate::viewer {
namespace {

/// The finer part comes at once as it is: coarser ones would not fit what is round it.
SurfaceLimits limits_of_patch(SurfaceLimits limits) {
    limits.most_triangles = std::min<std::size_t>(limits.most_triangles, 4'000'000);
    limits.coarse_first = false;
    return limits;
}

}  // namespace

PatchedSource::PatchedSource(const SurfaceLimits& limits) : limits_(limits), whole_(limits) {
    connect(&whole_, &SurfaceSource::made, this, &PatchedSource::put_together);
    connect(&whole_, &SurfaceSource::finished, this, &PatchedSource::finished);
    connect(&whole_, &SurfaceSource::problem, this, &PatchedSource::problem);
}

void PatchedSource::make_source() {
    finer_ = std::make_unique<SurfaceSource>(limits_of_patch(limits_));
    connect(finer_.get(), &SurfaceSource::made, this, &PatchedSource::take_finer);
    connect(finer_.get(), &SurfaceSource::problem, this, &PatchedSource::problem);
}

void PatchedSource::set_field(const Field& field, double level) {
    patch_.reset();
    shown_.reset();
    surface_ = {};
    if (finer_) finer_->clear();
    whole_.set_field(field, level);
}

void PatchedSource::update_field(const Field& field, const SampleBox& changed) {
    whole_.update_field(field, changed);
}

void PatchedSource::set_patch(const std::optional<ScenePatch>& patch) {
    const auto before = std::exchange(patch_, patch);
    if (!patch) {
        if (finer_) finer_->clear();
        if (shown_.has_value()) {
            shown_.reset();
            put_together();
        }
        return;
    }
    if (!finer_) make_source();
    const Field& field = patch->detail->field;
    // Changes of all of it would be taken for a sequence, whose surfaces are coarse.
    const SampleBox& changed = patch->detail->changed;
    if (changed != whole_box(field.geometry()) && before && before->bounds == patch->bounds &&
        before->detail->field.geometry() == field.geometry()) {
        finer_->update_field(field, changed);
        return;
    }
    finer_->set_origin(physical_centre(patch->bounds.grid));
    finer_->set_field(field, whole_.level());
}

void PatchedSource::set_level(double level) {
    whole_.set_level(level);
    if (finer_) finer_->set_level(level);
}

void PatchedSource::clear() {
    patch_.reset();
    shown_.reset();
    surface_ = {};
    if (finer_) finer_->clear();
    whole_.clear();
}

void PatchedSource::take_finer() {
    if (!patch_) return;
    shown_ = {patch_->bounds, finer_->surface()};
    put_together();
}

/// While a level is dragged the finer part may be of another one.
void PatchedSource::put_together() {
    const ExtractedSurface& whole = whole_.surface();
    const bool fits = shown_ && shown_->surface.isovalue == whole.isovalue;
    surface_ = fits ? both_.of(whole, shown_->surface, shown_->bounds) : whole;
    Q_EMIT made();
}

}  // namespace palpate::viewer
