// Marks of a hand: probe, spring and force, which keep their size on the screen at any zoom, the
// tool, the brush, and the tetrahedra at the proxy.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/look.hpp"
#include "apps/viewer/scene/local.hpp"
#include "apps/viewer/scene/mark.hpp"

namespace palpate::viewer {

struct SeenHand {
    std::optional<Snapshot> snapshot;
    HandColours colours;
    std::shared_ptr<const Tool> tool;                ///< null: a point
    vtkSmartPointer<vtkPolyData> tool_shape;         ///< from shape_of()
    double brush = 0;                                ///< [mm] its radius round the proxy; 0: none
    vtkSmartPointer<vtkPolyData> patch;              ///< of the surface that is felt; null: none
    std::shared_ptr<const RenderMesh> patch_memory;  ///< that it reads
};
/// The device is ready, and the proxy somewhere.
bool is_seen(const SeenHand& hand);

/// By its triangles, or where it has none by its points.
vtkSmartPointer<vtkPolyData> shape_of(const Tool& tool);

/// Sizes in logical pixels, as in our pictures of 800 pixels in height.
inline constexpr double ball_radius_px = 8.8;
inline constexpr double newton_px = 100;
inline constexpr double shortest_arrow_px = 56, longest_arrow_px = 240;

/// Shapes that do not change.
struct HandShapes {
    HandShapes();
    vtkSmartPointer<vtkPolyData> ball, circles;
};

/// Of a hand that is_seen(). `field`: the finest at its proxy; `ink`: of lines.
void add_hand(std::vector<Mark>& marks, const SeenHand& hand, const Look& look, const Field& field,
              const MarkView& view, const Colour& ink, const HandShapes& shapes);

}  // namespace palpate::viewer
