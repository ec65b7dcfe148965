// Draws the outline of a cut and its handles, which keep their size on the screen.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <optional>

#include "apps/viewer/scene/cut_handles.hpp"

namespace palpate::viewer {

class CutMarks {
  public:
    explicit CutMarks(vtkRenderer& renderer);
    /// `origin` [mm, physical] of what is drawn; `pixel` [mm] is a logical pixel. `held`: this
    /// handle is under the pointer.
    void show(const Look& look, const Geometry& geometry, const Vec3& origin, double pixel,
              double pixel_ratio, std::optional<std::size_t> held);
    void hide();

  private:
    std::array<vtkSmartPointer<vtkActor>, 6> balls_;
    vtkSmartPointer<vtkActor> lines_;
    vtkSmartPointer<vtkPolyData> outline_;
};

/// [logical pixels] From a cut's point to the tip of its normal.
inline constexpr double cut_arm_px = 70;

}  // namespace palpate::viewer
