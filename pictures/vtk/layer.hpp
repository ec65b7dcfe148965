// An image with depths, as it comes from OpenGL.
#pragma once

#include <vector>

namespace palpate::pictures {

/// Row by row from the bottom.
struct Layer {
    std::vector<unsigned char> rgba;  ///< sRGB; what alpha means is said where it is used
    std::vector<float> depth;         ///< 0 near, 1 nothing
};

}  // namespace palpate::pictures
