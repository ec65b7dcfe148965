// The tetrahedra at the proxy, written into VTK meshes for every frame. All in mm, from the origin
// of what is drawn.
#pragma once

#include <vtkPolyData.h>

#include <vector>

#include "apps/viewer/scene/local.hpp"

namespace palpate::viewer {

/// Each edge once.
void put_edges(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin);
/// The isosurface in the tetrahedra.
void put_patches(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin);
/// A disc, one and a half voxels [mm] wide, for each plane, and its normal as a line.
void put_planes(vtkPolyData& discs, vtkPolyData& normals, const std::vector<LocalTetrahedron>& all,
                const Vec3& origin, double voxel);

}  // namespace palpate::viewer
