// Builds meshes, tubes and cones.
#include "pictures/vtk/shapes.hpp"

#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTubeFilter.h>
#include <vtkTypeInt32Array.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::pictures {
namespace {

vtkSmartPointer<vtkFloatArray> vectors(std::span<const float> values) {
    auto array = vtkSmartPointer<vtkFloatArray>::New();
    array->SetNumberOfComponents(3);
    array->SetArray(const_cast<float*>(values.data()), static_cast<vtkIdType>(values.size()), 1);
    return array;
}

/// A polyline without points so near to each other that a tube would fold there.
vtkSmartPointer<vtkPolyData> polyline(const std::vector<Vec3>& path, double least) {
    vtkNew<vtkPoints> kept;
    kept->SetDataTypeToDouble();
    Vec3 last = Vec3::Zero();
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (i > 0 && (path[i] - last).norm() < least) continue;
        last = path[i];
        kept->InsertNextPoint(last.data());
    }
    vtkNew<vtkCellArray> lines;
    lines->InsertNextCell(kept->GetNumberOfPoints());
    for (vtkIdType i = 0; i < kept->GetNumberOfPoints(); ++i) lines->InsertCellPoint(i);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(kept);
    data->SetLines(lines);
    return data;
}

/// The head of an arrow.
vtkSmartPointer<vtkPolyData> cone(const Vec3& base, const Vec3& tip, double radius) {
    constexpr int sides = 32;
    const Vec3 axis = (tip - base).normalized();
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> normals;
    normals->SetNumberOfComponents(3);
    const auto add = [&](const Vec3& at, const Vec3& normal) {
        points->InsertNextPoint(at.data());
        normals->InsertNextTuple3(normal[0], normal[1], normal[2]);
    };
    vtkNew<vtkCellArray> polygons;
    std::vector<vtkIdType> back;
    for (vtkIdType i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / sides;
        const Vec3 out = std::cos(angle) * u + std::sin(angle) * v;
        const Vec3 side = (out + radius / (tip - base).norm() * axis).normalized();
        add(base + radius * out, side);
        add(tip, side);  // each side has a tip of its own, with its normal
        add(base + radius * out, -axis);
        const vtkIdType a = 3 * i, b = 3 * ((i + 1) % sides);
        const vtkIdType quad[] = {a, b, b + 1, a + 1};
        polygons->InsertNextCell(4, quad);
        back.insert(back.begin(), a + 2);
    }
    polygons->InsertNextCell(sides, back.data());
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(polygons);
    data->GetPointData()->SetNormals(normals);
    return data;
}

}  // namespace

vtkSmartPointer<vtkPolyData> mesh_of(std::span<const float> positions,
                                     std::span<const float> normals,
                                     std::span<const std::int32_t> triangles) {
    vtkNew<vtkPoints> points;
    points->SetData(vectors(positions));
    const auto directions = vectors(normals);
    directions->SetName("Normals");
    vtkNew<vtkTypeInt32Array> connectivity;
    connectivity->SetArray(const_cast<std::int32_t*>(triangles.data()),
                           static_cast<vtkIdType>(triangles.size()), 1);
    vtkNew<vtkCellArray> cells;
    cells->Use32BitStorage();
    cells->SetData(3, connectivity);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetPointData()->SetNormals(directions);
    return data;
}

vtkSmartPointer<vtkPolyData> tube(const std::vector<Vec3>& path, double radius) {
    const auto line = polyline(path, 0.25 * radius);
    if (line->GetNumberOfPoints() < 2) return nullptr;
    vtkNew<vtkTubeFilter> filter;
    filter->SetInputData(line);
    filter->SetRadius(radius);
    filter->SetNumberOfSides(16);
    filter->CappingOn();
    filter->Update();
    return filter->GetOutput();
}

vtkSmartPointer<vtkPolyData> spring(const Vec3& from, const Vec3& to, double radius) {
    constexpr int turns = 7, steps = 24;
    const Vec3 axis = to - from;
    const Vec3 u = axis.normalized().unitOrthogonal(), v = axis.normalized().cross(u);
    std::vector<Vec3> path{from};
    for (int i = 0; i <= turns * steps; ++i) {
        const double t = double(i) / (turns * steps);
        const double angle = 2 * std::numbers::pi * turns * t;
        path.push_back(from + (0.12 + 0.76 * t) * axis +
                       radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    path.push_back(to);
    return tube(path, 0.22 * radius);
}

vtkSmartPointer<vtkPolyData> arrow(const Vec3& from, const Vec3& to, double radius) {
    const Vec3 axis = to - from;
    const Vec3 neck = to - std::min(0.6 * axis.norm(), 6 * radius) * axis.normalized();
    const auto head = cone(neck, to, 2.4 * radius);
    const auto shaft = tube({from, neck}, radius);
    if (!shaft) return head;
    vtkNew<vtkAppendPolyData> both;
    for (vtkPolyData* part : {shaft.Get(), head.Get()}) {
        part->GetPointData()->GetNormals()->SetName("Normals");
        both->AddInputData(part);
    }
    both->Update();
    return both->GetOutput();
}

}  // namespace palpate::pictures
