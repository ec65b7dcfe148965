// Marks of a hand: probe, spring and force, which keep their size on the screen at any zoom, the
// tool and the brush. Also the tetrahedra at the proxy, as in the paper's figures.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/look.hpp"
#include "apps/viewer/scene/marks.hpp"
#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/lattice.hpp"

namespace palpate::viewer {

/// A constraint plane: the proxy has to stay on the side to which the normal points.
struct ConstraintPlane {
    Vec3 point = Vec3::Zero();   ///< the SCP [mm, physical]
    Vec3 normal = Vec3::Zero();  ///< unit, out of the solid, physical axes
};

struct LocalTetrahedron {
    std::array<Vec3, 4> corners;  ///< cell centre, face centre, the edge's two ends [mm, physical]
    /// The isosurface in it, as convex polygons of 3 or 4 corners, in turn [mm, physical]: one at
    /// most on a linear field, several along the curved surface of a cubic one.
    std::vector<std::vector<Vec3>> patch;
    /// Where the point lies on the isosurface and the field is not constant here.
    std::optional<ConstraintPlane> plane;
};

std::vector<LocalTetrahedron> local_tetrahedra(const Field& field, const LatticePoint& point,
                                               double isovalue);

/// The isosurface within some voxels of the point, from the middle of the grid; null where there
/// is none. A few milliseconds.
std::shared_ptr<const RenderMesh> local_patch(const Field& field, const Vec3& physical,
                                              double isovalue);

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
