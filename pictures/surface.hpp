// Isosurfaces ready for a picture: the mesh that the proxy meets, with normals to shade it by.
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
};

/// A surface and what there is to say about how true it is.
struct ShadedSurface {
    Surface surface;
    int every = 1;  ///< every how manieth sample along each axis it was made from
};

/// The isosurface where the proxy meets it (extract_surface), shaded by the field's differences
/// over a voxel, which are smoother than the facets of the lattice. No colour yet.
ShadedSurface shaded_surface(const Field& field, double isovalue, const SurfaceWork& work = {});

/// The mean of the triangles round each vertex, by their area; of length 1, or (0, 0, 1) where
/// they cancel.
std::vector<Eigen::Vector3f> mesh_normals(const SurfaceMesh& mesh);

}  // namespace palpate::pictures
