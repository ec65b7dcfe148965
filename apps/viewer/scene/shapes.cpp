// Builds edges and polygons.
#include "apps/viewer/scene/shapes.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpate::viewer {
namespace {

/// Points and cells that become a VTK mesh.
class Shape {
  public:
    Shape() { points_->SetDataTypeToFloat(); }
    vtkIdType point(const Vec3& at) { return points_->InsertNextPoint(at.data()); }
    void polygon(const std::vector<vtkIdType>& corners) {
        polygons_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    }
    void line(vtkIdType a, vtkIdType b) {
        const vtkIdType ends[] = {a, b};
        lines_->InsertNextCell(2, ends);
    }
    void move_to(vtkPolyData& data) {
        data.Initialize();
        data.SetPoints(points_);
        data.SetPolys(polygons_);
        data.SetLines(lines_);
    }

  private:
    vtkNew<vtkPoints> points_;
    vtkNew<vtkCellArray> polygons_, lines_;
};

}  // namespace

void put_edges(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin) {
    std::vector<std::array<Vec3, 2>> edges;
    const auto before = [](const Vec3& a, const Vec3& b) {
        return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    };
    for (const LocalTetrahedron& t : all) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i + 1; j < 4; ++j) {
                std::array<Vec3, 2> edge{t.corners[i], t.corners[j]};
                if (before(edge[1], edge[0])) std::swap(edge[0], edge[1]);
                const bool known = std::ranges::any_of(edges, [&](const auto& e) {
                    return e[0].isApprox(edge[0], 1e-9) && e[1].isApprox(edge[1], 1e-9);
                });
                if (!known) edges.push_back(edge);
            }
        }
    }
    Shape shape;
    for (const auto& [a, b] : edges) shape.line(shape.point(a - origin), shape.point(b - origin));
    shape.move_to(data);
}

void put_patches(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin) {
    Shape shape;
    for (const LocalTetrahedron& t : all) {
        for (const std::vector<Vec3>& polygon : t.patch) {
            std::vector<vtkIdType> corners;
            for (const Vec3& corner : polygon) corners.push_back(shape.point(corner - origin));
            shape.polygon(corners);
        }
    }
    shape.move_to(data);
}

void put_planes(vtkPolyData& discs, vtkPolyData& normals, const std::vector<LocalTetrahedron>& all,
                const Vec3& origin, double voxel) {
    Shape disc, needle;
    for (const LocalTetrahedron& t : all) {
        if (!t.plane) continue;
        const Vec3 at = t.plane->point - origin;
        const Vec3 u = t.plane->normal.unitOrthogonal(), v = t.plane->normal.cross(u);
        std::vector<vtkIdType> rim;
        for (int i = 0; i < 36; ++i) {
            const double angle = 2 * std::numbers::pi * i / 36;
            rim.push_back(
                disc.point(at + 0.75 * voxel * (std::cos(angle) * u + std::sin(angle) * v)));
        }
        disc.polygon(rim);
        needle.line(needle.point(at), needle.point(at + 0.75 * voxel * t.plane->normal));
    }
    disc.move_to(discs);
    needle.move_to(normals);
}

}  // namespace palpate::viewer
