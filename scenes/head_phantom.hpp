// A head of ellipsoids after Shepp and Logan (1974), with skin, a nose, eyes and a skull thick
// enough to press on. Internal to scenes/.
#pragma once

#include "palpate/volume.hpp"

namespace palpate::scenes {

/// Left is +x, the face looks to -y, up is +z (LPS).
class HeadPhantom {
  public:
    /// `half_box` [mm]: the head fits in a cube of twice that; `edge` [mm]: edges are ramps that
    /// wide.
    HeadPhantom(double half_box, double edge) : half_box_(half_box), edge_(edge) {}

    /// Hounsfield units at a point [mm, from the centre]: air -1000, skin 60, skull 1000, brain 40.
    double hounsfield(const Vec3& point) const;

  private:
    double half_box_;
    double edge_;
};

}  // namespace palpate::scenes
