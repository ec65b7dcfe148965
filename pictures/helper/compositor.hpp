// Renders a scene to pixels.
#pragma once

#include <vector>

#include "pictures/helper/bodies.hpp"
#include "pictures/scene.hpp"

namespace palpate::pictures {

/// 3 bytes a pixel, sRGB, row by row from the bottom. Needs a current OpenGL context. Throws
/// Failure.
std::vector<unsigned char> pixels_of(const PictureScene& scene,
                                     const std::vector<SharedMesh>& meshes);

}  // namespace palpate::pictures
