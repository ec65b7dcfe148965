// Drops triangles of two surfaces so that together they are one.
#include "apps/viewer/scene/surface_patch.hpp"

#include <algorithm>
#include <array>

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

}  // namespace palpate::viewer
