// Numbers requests, takes surfaces that are not too old, and puts two together.
#include "apps/viewer/scene/surface_source.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "apps/viewer/scene/threads.hpp"

namespace palpate::viewer {

PatchedSurface::Mesh PatchedSurface::cut(const Mesh& mesh, Keep keep) {
    if (!mesh) return nullptr;
    const std::pair key{mesh.get(), keep};
    if (const auto known = used_.find(key); known != used_.end()) return known->second.to;
    if (const auto known = cuts_.find(key); known != cuts_.end()) {
        return used_.insert(*known).first->second.to;
    }
    // Positions are from the middle of the overview.
    const Vec3 middle = physical_centre(bounds_.grid);
    std::vector<Vec3> at(mesh->vertex_count());
    for (std::size_t v = 0; v < at.size(); ++v) {
        const float* const p = mesh->positions.data() + 3 * v;
        at[v] = index_from_physical(bounds_.grid, middle + Vec3(p[0], p[1], p[2]));
    }
    const auto is_kept = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        switch (keep) {
            case Keep::outside:
                return !bounds_.has((a + b + c) / 3);
            case Keep::not_inside:
                return !(bounds_.has(a) && bounds_.has(b) && bounds_.has(c));
            case Keep::reaching_in:
                break;
        }
        return bounds_.has(a) || bounds_.has(b) || bounds_.has(c);
    };
    std::vector<std::int32_t> kept;
    for (std::size_t t = 0; t < mesh->triangles.size(); t += 3) {
        const auto corner = [&](std::size_t i) { return std::size_t(mesh->triangles[t + i]); };
        if (!is_kept(at[corner(0)], at[corner(1)], at[corner(2)])) continue;
        kept.insert(kept.end(),
                    {mesh->triangles[t], mesh->triangles[t + 1], mesh->triangles[t + 2]});
    }
    Mesh result = mesh;
    if (kept.empty()) {
        result = nullptr;
    } else if (kept.size() < mesh->triangles.size()) {
        result = std::make_shared<const RenderMesh>(
            RenderMesh{mesh->positions, mesh->normals, std::move(kept), mesh->seams});
    }
    used_[key] = {mesh, result};
    return result;
}

ExtractedSurface PatchedSurface::of(const ExtractedSurface& whole, const ExtractedSurface& finer,
                                    const PatchBounds& bounds) {
    if (bounds == bounds_ && whole == whole_ && finer == finer_) return both_;
    if (!(bounds == bounds_)) cuts_.clear();
    bounds_ = bounds;
    whole_ = whole;
    finer_ = finer;
    used_.clear();
    ExtractedSurface both = whole;
    for (auto& block : both.blocks) block = cut(block, Keep::outside);
    for (const auto& block : finer.blocks) both.blocks.push_back(cut(block, Keep::reaching_in));
    // Simplified triangles do not end with the cells: the two overlap a little while things move.
    both.moving = joined(
        std::array{cut(whole.moving, Keep::not_inside), cut(finer.moving, Keep::reaching_in)});
    both.every = std::max(whole.every, finer.every);
    both.finished = whole.finished && finer.finished;
    std::swap(cuts_, used_);
    used_.clear();
    both_ = both;
    return both;
}

namespace {

/// The finer part comes at once as it is: coarser ones would not fit what is round it.
SurfaceLimits limits_of_patch(SurfaceLimits limits) {
    limits.most_triangles = std::min<std::size_t>(limits.most_triangles, 4'000'000);
    limits.coarse_first = false;
    return limits;
}

}  // namespace

SurfaceSource::SurfaceSource(const SurfaceLimits& limits)
    : limits_(limits),
      extractor_({[this](ExtractedSurface surface) {
                      hand_over(this, [this, surface] { take(surface); });
                  },
                  [this](std::uint64_t request, const std::string& what) {
                      hand_over(this, [this, request, what] {
                          if (request != request_) return;
                          extracting_ = false;
                          Q_EMIT problem(QString::fromStdString(what));
                      });
                  }},
                 limits) {}

void SurfaceSource::set_field(const Field& field, double level) {
    clear();
    field_ = field;
    level_ = std::nan("");
    set_level(level);
}

void SurfaceSource::update_field(const Field& field, const SampleBox& changed) {
    field_ = field;
    if (changed.empty() || !std::isfinite(level_)) return;
    extracting_ = true;
    extractor_.update(++request_, field, level_, changed);
}

void SurfaceSource::set_level(double level) {
    if (!field_ || level == level_) return;
    level_ = level;
    extracting_ = asked_ = true;
    extractor_.ask(++request_, *field_, level);
    if (finer_) finer_->set_level(level);
}

void SurfaceSource::set_patch(const std::optional<ScenePatch>& patch) {
    const auto before = std::exchange(patch_, patch);
    if (!patch) {
        const bool seen = shown_.has_value();
        drop_patch();
        if (seen) put_together();
        return;
    }
    if (!finer_) {
        finer_ = std::make_unique<SurfaceSource>(limits_of_patch(limits_));
        connect(finer_.get(), &SurfaceSource::made, this, &SurfaceSource::take_finer);
        connect(finer_.get(), &SurfaceSource::problem, this, &SurfaceSource::problem);
    }
    const Field& field = patch->detail->field;
    // Changes of all of it would be taken for a sequence, whose surfaces are coarse.
    const SampleBox& changed = patch->detail->changed;
    if (changed != whole_box(field.geometry()) && before && before->bounds == patch->bounds &&
        before->detail->field.geometry() == field.geometry()) {
        return finer_->update_field(field, changed);
    }
    finer_->extractor_.set_origin(physical_centre(patch->bounds.grid));
    finer_->set_field(field, level_);
}

void SurfaceSource::drop_patch() {
    patch_.reset();
    shown_.reset();
    if (finer_) finer_->clear();
}

void SurfaceSource::clear() {
    drop_patch();
    field_.reset();
    whole_ = surface_ = {};
    oldest_ = request_ + 1;
    extracting_ = false;
    extractor_.forget();
}

void SurfaceSource::take(ExtractedSurface surface) {
    // Of an older request, too, while a newer one is not there. Never of other data.
    if (surface.request < oldest_ || surface.request < whole_.request) return;
    const bool last = surface.request == request_ && surface.finished;
    whole_ = std::move(surface);
    if (last) extracting_ = false;
    put_together();
    if (!last || !asked_) return;
    asked_ = false;
    Q_EMIT finished();
}

void SurfaceSource::take_finer() {
    if (!patch_) return;
    shown_ = {patch_->bounds, finer_->surface()};
    put_together();
}

/// While a level is dragged the finer part may be of another one.
void SurfaceSource::put_together() {
    const bool fits = shown_ && shown_->surface.isovalue == whole_.isovalue;
    surface_ = fits ? both_.of(whole_, shown_->surface, shown_->bounds) : whole_;
    Q_EMIT made();
}

namespace {

/// Moves a mesh from the middle of the mask's grid to that of the overlay's.
MeshBlocks moved(const MeshBlocks& blocks, const Vec3& by) {
    MeshBlocks result;
    const Eigen::Vector3f shift = by.cast<float>();
    for (const auto& block : blocks) {
        if (!block) continue;
        auto mesh = std::make_shared<RenderMesh>(*block);
        for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
            mesh->positions[i] += shift[static_cast<Eigen::Index>(i % 3)];
        }
        result.push_back(std::move(mesh));
    }
    return result;
}

}  // namespace

std::vector<ExtractedSurface> label_surfaces(const Overlay& overlay,
                                             const std::function<void(double)>& progress) {
    constexpr std::size_t most_triangles = 4'000'000, moving_triangles = 20'000;
    std::vector<ExtractedSurface> surfaces;
    for (const Label& label : overlay.labels) {
        progress(double(surfaces.size()) / double(overlay.labels.size()));
        // Linear: what is a sample wide stays whole.
        const Field field(label_mask(overlay, label), Solid::above, 0, Interpolation::linear);
        SurfaceBlocks blocks(field.geometry(), 1, field.interpolation());
        (void)blocks.renew(
            field, 0.5, [] { return true; }, most_triangles);
        const Vec3 by =
            physical_centre(field.geometry()) - physical_centre(overlay.volume.geometry());
        ExtractedSurface surface;
        surface.blocks = moved(blocks.meshes(), by);
        const std::size_t few =
            std::max<std::size_t>(500, moving_triangles / overlay.labels.size());
        if (const auto simple = blocks.simplified(few))
            surface.moving = moved({simple}, by).front();
        surface.finished = true;
        surfaces.push_back(std::move(surface));
    }
    progress(1);
    return surfaces;
}

}  // namespace palpate::viewer
