// Isosurfaces for pictures: the mesh that the proxy meets, with normals for shading.
#pragma once

#include <functional>
#include <string>

#include "palpate/field.hpp"
#include "pictures/scene.hpp"

namespace palpate::pictures {

struct SurfaceWork {
    /// The part that is done, 0 to 1; may throw to stop.
    std::function<void(double)> progress = [](double) {};
    /// Above this the field is sampled ever more coarsely until the surface is smaller.
    std::size_t most_triangles = 40'000'000;
    /// Only every so manieth sample along each axis is taken: a quick first look. At least 1.
    int every = 1;
};

/// A surface and what there is to say about how true it is.
struct ShadedSurface {
    Surface surface;
    int every = 1;  ///< every how manieth sample along each axis it was made from
};

/// Every `every`-th sample along each axis, as it is: a mean would move the surface.
Field coarser(const Field& field, int every);

/// The isosurface where the proxy meets it (extract_surface), shaded by the field's differences
/// over a voxel, which are smoother than the facets of the lattice. No colour yet. Throws what
/// `progress` throws, and std::invalid_argument for an isovalue that is not finite or `every` < 1.
ShadedSurface shaded_surface(const Field& field, double isovalue, const SurfaceWork& work = {});

/// The mean of the triangles round each vertex, by their area; of length 1, or (0, 0, 1) where
/// they cancel.
std::vector<Eigen::Vector3f> mesh_normals(const SurfaceMesh& mesh);

}  // namespace palpate::pictures
