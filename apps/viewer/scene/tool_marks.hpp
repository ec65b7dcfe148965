// The tool in the hand, transparent, and where its proxy is, with its contacts and the torque.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/scene/markers.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// The part of a snapshot that is drawn of a tool.
struct SeenTool {
    std::shared_ptr<const Tool> tool;
    Pose hand, proxy;                   ///< [mm, physical]
    Vec3 torque = Vec3::Zero();         ///< [N mm] on the hand, physical axes
    std::vector<ToolContact> contacts;  ///< those that hold it
};
/// Nothing without a tool, and while the device is not ready.
std::optional<SeenTool> seen_tool(const std::optional<Snapshot>& snapshot,
                                  const std::shared_ptr<const Tool>& tool);

class ToolMarks {
  public:
    /// As Markers.
    ToolMarks(vtkRenderer& solid, vtkRenderer& overlay, const HandColours& colours);

    /// `origin` [mm, physical] of what is drawn; `pixel` [mm] is a logical pixel.
    void show(const std::optional<SeenTool>& seen, const Vec3& origin, double pixel,
              double pixel_ratio);

  private:
    void use_shape(const std::shared_ptr<const Tool>& tool);
    void show_contacts(const SeenTool& seen, const Vec3& origin, double pixel);
    void show_torque(const SeenTool& seen, const Vec3& origin, double pixel);

    std::shared_ptr<const Tool> tool_;  // whose shape the actors have
    vtkSmartPointer<vtkActor> hand_;
    Twin proxy_, contacts_, torque_;
};

}  // namespace palpate::viewer
