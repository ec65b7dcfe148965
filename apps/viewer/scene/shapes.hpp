// Shapes of the markers, written into VTK meshes for every frame. All in mm, from the origin of
// what is drawn.
#pragma once

#include <vtkPolyData.h>

#include <vector>

#include "apps/viewer/scene/local.hpp"

namespace palpate::viewer {

/// A coil with straight ends; `radius` is the coil's, its wire a fifth as thick.
void put_spring(vtkPolyData& data, const Vec3& from, const Vec3& to, double radius);
/// `radius` of the shaft.
void put_arrow(vtkPolyData& data, const Vec3& from, const Vec3& to, double radius);

/// Each edge once.
void put_edges(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin);
/// The isosurface in the tetrahedra.
void put_patches(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin);
/// A disc, one and a half voxels [mm] wide, for each plane, and its normal as a line.
void put_planes(vtkPolyData& discs, vtkPolyData& normals, const std::vector<LocalTetrahedron>& all,
                const Vec3& origin, double voxel);

}  // namespace palpate::viewer
