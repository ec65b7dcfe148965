// The isosurface in blocks of cells: a change costs only the blocks that it touches.
#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// So many samples beyond the outermost ones, at most, bodies that the grid's end cuts are closed.
inline int closing_samples(Interpolation interpolation) {
    return interpolation == Interpolation::cubic ? 2 : 1;
}

/// Where the full grid ends in the index space of a coarse one, and the factors by which a coarse
/// surface is drawn together beyond it: there it would be closed a coarse sample away.
struct GridEnds {
    Vec3 last = Vec3::Constant(std::numeric_limits<double>::infinity());
    double before = 1;
    Vec3 behind = Vec3::Ones();
};

/// The isosurface in the `edge`^3 cells from `cell` on; positions from `middle` [mm, physical].
/// Normals as pictures::shaded_surface has them. Looks at samples from one before the cells to one
/// behind their last. Null where nothing of the surface lies.
std::shared_ptr<const RenderMesh> block_mesh(const Field& field, double isovalue,
                                             const Index3& cell, int edge, const Vec3& middle,
                                             const GridEnds& ends = {});

/// The surface of a field, or of its coarse version (coarse_samples.hpp); made piece by piece, by
/// as many threads as there are processors. Blocks meet without cracks, and do not depend on
/// what was there before: the same field has the same blocks.
class SurfaceBlocks {
  public:
    static constexpr int cells = 32;  ///< along each axis of a block

    /// Of the full grid. Nothing is made yet. `every`: of the coarse version; 1: the field itself.
    /// Positions count from `origin` [mm, physical].
    SurfaceBlocks(const Geometry& geometry, int every, Interpolation interpolation,
                  const Vec3& origin);
    /// From the middle of the grid.
    SurfaceBlocks(const Geometry& geometry, int every, Interpolation interpolation)
        : SurfaceBlocks(geometry, every, interpolation, physical_centre(geometry)) {}

    int every() const { return every_; }
    /// These samples, of the full grid, are no longer what they were: the blocks that they touch
    /// are to be made again.
    void mark(const SampleBox& changed);
    /// How many blocks are to be made.
    std::size_t outdated() const;

    enum class Outcome : std::uint8_t { done, interrupted, too_many };
    /// Makes what is to be made of this version of the field, or its coarse one, as long as `go_on`
    /// (called from several threads) says so, and until there are more than `most_triangles`. What
    /// was made stays made.
    Outcome renew(const Field& field, double isovalue, const std::function<bool()>& go_on,
                  std::size_t most_triangles);

    std::size_t triangles() const { return triangle_count(meshes_); }
    /// The blocks, always in the same order.
    const MeshBlocks& meshes() const { return meshes_; }

  private:
    Index3 first_cell(std::size_t block) const;

    Geometry geometry_;
    int every_;
    Vec3 origin_;
    int reach_;  // of a block's cells: samples before the first and after the last
    Index3 count_;
    MeshBlocks meshes_;
    std::vector<std::uint8_t> fresh_;  // the mesh is what it should be
};

}  // namespace palpate::viewer
