// Meshes of surfaces and markers in VTK, with normals; shared by the picture helper and the
// viewer's scene.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <cstdint>
#include <span>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::pictures {

/// A mesh of triangles whose arrays stay where they are: VTK only reads them, as long as it draws.
/// 3 numbers a vertex, 3 indices a triangle.
vtkSmartPointer<vtkPolyData> mesh_of(std::span<const float> positions,
                                     std::span<const float> normals,
                                     std::span<const std::int32_t> triangles);

/// A tube along a path. Null if the path is shorter than a quarter of `radius`.
vtkSmartPointer<vtkPolyData> tube(const std::vector<Vec3>& path, double radius);
/// A coil with straight ends from one point to another; `radius` is the coil's, that of its wire
/// 0.22 of it.
vtkSmartPointer<vtkPolyData> spring(const Vec3& from, const Vec3& to, double radius);
/// `radius` of the shaft. Needs `from` other than `to`.
vtkSmartPointer<vtkPolyData> arrow(const Vec3& from, const Vec3& to, double radius);

}  // namespace palpate::pictures
