// Builds tubes, cones and polygons.
#include "apps/viewer/scene/shapes.hpp"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpate::viewer {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;

/// Points, cells and normals that become a VTK mesh.
class Shape {
  public:
    Shape() {
        points_->SetDataTypeToFloat();
        normals_->SetNumberOfComponents(3);
        normals_->SetName("Normals");
    }
    vtkIdType point(const Vec3& at) { return points_->InsertNextPoint(at.data()); }
    vtkIdType point(const Vec3& at, const Vec3& normal) {
        normals_->InsertNextTuple3(normal[0], normal[1], normal[2]);
        return point(at);
    }
    void polygon(std::initializer_list<vtkIdType> corners) {
        polygons_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.begin());
    }
    void polygon(const std::vector<vtkIdType>& corners) {
        polygons_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    }
    void line(vtkIdType a, vtkIdType b) {
        const vtkIdType ends[] = {a, b};
        lines_->InsertNextCell(2, ends);
    }
    void give(vtkPolyData& data) {
        data.Initialize();
        data.SetPoints(points_);
        data.SetPolys(polygons_);
        data.SetLines(lines_);
        if (normals_->GetNumberOfTuples() > 0) data.GetPointData()->SetNormals(normals_);
    }

    /// A ring of points round `at`, across `along`; returns the first of `sides`.
    vtkIdType ring(const Vec3& at, const Vec3& u, const Vec3& v, double radius, double lean,
                   const Vec3& along) {
        vtkIdType first = 0;
        for (int i = 0; i < sides; ++i) {
            const double angle = full_turn * i / sides;
            const Vec3 out = std::cos(angle) * u + std::sin(angle) * v;
            const vtkIdType added = point(at + radius * out, (out + lean * along).normalized());
            if (i == 0) first = added;
        }
        return first;
    }
    /// Quads between two rings.
    void sleeve(vtkIdType below, vtkIdType above) {
        for (int i = 0; i < sides; ++i) {
            const int j = (i + 1) % sides;
            polygon({below + i, below + j, above + j, above + i});
        }
    }
    static constexpr int sides = 12;

  private:
    vtkNew<vtkPoints> points_;
    vtkNew<vtkFloatArray> normals_;
    vtkNew<vtkCellArray> polygons_, lines_;
};

void add_tube(Shape& shape, const std::vector<Vec3>& path, double radius) {
    vtkIdType last = -1;
    Vec3 u = Vec3::Zero();
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Vec3 along =
            (path[std::min(i + 1, path.size() - 1)] - path[i > 0 ? i - 1 : 0]).normalized();
        // The ring before, carried on without a twist.
        u = i == 0 ? along.unitOrthogonal() : Vec3(u - along.dot(u) * along);
        u = u.norm() > 1e-6 ? u.normalized() : along.unitOrthogonal();
        const vtkIdType ring = shape.ring(path[i], u, along.cross(u), radius, 0, along);
        if (last >= 0) shape.sleeve(last, ring);
        last = ring;
    }
}

}  // namespace

void put_spring(vtkPolyData& data, const Vec3& from, const Vec3& to, double radius) {
    constexpr int turns = 7, steps = 20;
    const Vec3 path = to - from;
    const Vec3 u = path.unitOrthogonal(), v = path.normalized().cross(u);
    std::vector<Vec3> points{from};
    for (int i = 0; i <= turns * steps; ++i) {
        const double t = double(i) / (turns * steps);
        const double angle = full_turn * turns * t;
        points.push_back(from + (0.12 + 0.76 * t) * path +
                         radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    points.push_back(to);
    Shape shape;
    add_tube(shape, points, 0.22 * radius);
    shape.give(data);
}

void put_arrow(vtkPolyData& data, const Vec3& from, const Vec3& to, double radius) {
    const Vec3 path = to - from;
    const Vec3 along = path.normalized();
    const double head = std::min(0.6 * path.norm(), 6 * radius), broad = 2.4 * radius;
    const Vec3 neck = to - head * along;
    const Vec3 u = along.unitOrthogonal(), v = along.cross(u);
    Shape shape;
    add_tube(shape, {from, neck}, radius);
    const vtkIdType shoulder = shape.ring(neck, u, v, broad, broad / head, along);
    const vtkIdType tip = shape.ring(to, u, v, 0, broad / head, along);
    shape.sleeve(shoulder, tip);
    // The back of the head, seen from behind.
    std::vector<vtkIdType> back(Shape::sides);
    for (int i = 0; i < Shape::sides; ++i) {
        const double angle = -full_turn * i / Shape::sides;
        back[static_cast<std::size_t>(i)] =
            shape.point(neck + broad * (std::cos(angle) * u + std::sin(angle) * v), -along);
    }
    shape.polygon(back);
    shape.give(data);
}

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
    shape.give(data);
}

void put_patches(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin) {
    Shape shape;
    for (const LocalTetrahedron& t : all) {
        if (t.patch.empty()) continue;
        std::vector<vtkIdType> corners;
        for (const Vec3& corner : t.patch) corners.push_back(shape.point(corner - origin));
        shape.polygon(corners);
    }
    shape.give(data);
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
            const double angle = full_turn * i / 36;
            rim.push_back(
                disc.point(at + 0.75 * voxel * (std::cos(angle) * u + std::sin(angle) * v)));
        }
        disc.polygon(rim);
        needle.line(needle.point(at), needle.point(at + 0.75 * voxel * t.plane->normal));
    }
    disc.give(discs);
    needle.give(normals);
}

}  // namespace palpate::viewer
