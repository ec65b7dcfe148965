// The planes of a cut.
#pragma once

#include <vtkPlaneCollection.h>

#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/volume.hpp"

namespace palpate::viewer {

/// As many as cut something: a box that reaches the grid's ends there has none. [mm, physical]
std::vector<CutPlane> planes_of(const Look& look, const Geometry& geometry);

/// Puts them into VTK's collection, from `origin`; touches it only where they differ.
void put_planes(vtkPlaneCollection& collection, const std::vector<CutPlane>& planes,
                const Vec3& origin);

/// The point of the box at parts of the grid along its axes [mm, physical].
Vec3 at_parts(const Geometry& geometry, const Vec3& parts);

}  // namespace palpate::viewer
