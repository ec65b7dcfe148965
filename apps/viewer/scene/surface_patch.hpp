// A surface whose part in a box is replaced by a finer one, where the data are an overview of a
// store. See docs/viewer_internals.md for how the two meet.
#pragma once

#include <map>
#include <memory>

#include "apps/viewer/model/detail_field.hpp"
#include "apps/viewer/scene/surface_extractor.hpp"

namespace palpate::viewer {

/// A box of whole cells of the overview; on a side where the data end it has no end.
struct PatchBounds {
    Geometry grid;  ///< of the overview
    /// Planes between cells, in its index space; infinite: none.
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();

    bool operator==(const PatchBounds&) const = default;
    bool has(const Vec3& index) const {
        return (index.array() >= low.array()).all() && (index.array() <= high.array()).all();
    }
};

/// The finer part: its samples reach at least two beyond the bounds, and come to be those of the
/// overview's field there (model/patch_samples.hpp).
struct ScenePatch {
    std::shared_ptr<const DetailField> detail;
    PatchBounds bounds;
};

/// Puts the two together. What did not change stays the same, block by block.
class PatchedSurface {
  public:
    /// Of the whole surface the triangles outside, each of which lies in one cell; of the finer one
    /// those that reach in.
    ExtractedSurface of(const ExtractedSurface& whole, const ExtractedSurface& finer,
                        const PatchBounds& bounds);

  private:
    using Mesh = std::shared_ptr<const RenderMesh>;
    enum class Keep : std::uint8_t { outside, not_inside, reaching_in };
    struct Cut {
        Mesh from, to;
    };
    Mesh cut(const Mesh& mesh, Keep keep);

    PatchBounds bounds_;
    ExtractedSurface whole_, finer_, both_;                          // as they were last time
    std::map<std::pair<const RenderMesh*, Keep>, Cut> cuts_, used_;  // of last time, of this time
};

}  // namespace palpate::viewer
