// Makes VTK actors of meshes and markers.
#include "pictures/helper/bodies.hpp"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkLine.h>
#include <vtkNew.h>
#include <vtkOpenGLPolyDataMapper.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>
#include <vtkTypeInt32Array.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pictures/vtk/material.hpp"

namespace palpate::pictures {
namespace {

vtkSmartPointer<vtkActor> actor_of(vtkPolyDataMapper* mapper, const Colour& colour) {
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
    return actor;
}

vtkSmartPointer<vtkFloatArray> vectors(std::span<float> values) {
    auto array = vtkSmartPointer<vtkFloatArray>::New();
    array->SetNumberOfComponents(3);
    array->SetArray(values.data(), static_cast<vtkIdType>(values.size()), 1);
    return array;
}

/// A polyline without points so near to each other that a tube would fold there.
vtkSmartPointer<vtkPolyData> polyline(const std::vector<Vec3>& points, double least,
                                      const Vec3& origin) {
    vtkNew<vtkPoints> kept;
    kept->SetDataTypeToDouble();
    Vec3 last = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0 && (points[i] - last).norm() < least) continue;
        last = points[i];
        kept->InsertNextPoint(Vec3(last - origin).data());
    }
    vtkNew<vtkCellArray> lines;
    lines->InsertNextCell(kept->GetNumberOfPoints());
    for (vtkIdType i = 0; i < kept->GetNumberOfPoints(); ++i) lines->InsertCellPoint(i);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(kept);
    data->SetLines(lines);
    return data;
}

vtkSmartPointer<vtkActor> ball(const Vec3& centre, double radius, const Colour& colour) {
    vtkNew<vtkSphereSource> source;
    source->SetRadius(radius);
    source->SetThetaResolution(48);
    source->SetPhiResolution(32);
    source->SetCenter(Vec3(centre).data());
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(source->GetOutputPort());
    return actor_of(mapper, colour);
}

vtkSmartPointer<vtkActor> tube(const std::vector<Vec3>& points, double radius, const Colour& colour,
                               const Vec3& origin) {
    const auto line = polyline(points, 0.25 * radius, origin);
    if (line->GetNumberOfPoints() < 2) return ball(points.front() - origin, radius, colour);
    vtkNew<vtkTubeFilter> filter;
    filter->SetInputData(line);
    filter->SetRadius(radius);
    filter->SetNumberOfSides(16);
    filter->CappingOn();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(filter->GetOutputPort());
    mapper->ScalarVisibilityOff();
    return actor_of(mapper, colour);
}

Vec3 across(const Vec3& along) {
    return along.unitOrthogonal();
}

std::vector<Vec3> coil(const Spring& spring) {
    constexpr int turns = 7, steps = 24;
    const Vec3 axis = spring.to - spring.from;
    const Vec3 u = across(axis.normalized()), v = axis.normalized().cross(u);
    std::vector<Vec3> points{spring.from};
    for (int i = 0; i <= turns * steps; ++i) {
        const double t = double(i) / (turns * steps);
        const double angle = 2 * std::numbers::pi * turns * t;
        points.push_back(spring.from + (0.12 + 0.76 * t) * axis +
                         spring.radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    points.push_back(spring.to);
    return points;
}

/// The head of an arrow: a cone turned round its axis.
vtkSmartPointer<vtkActor> cone(const Vec3& base, const Vec3& tip, double radius,
                               const Colour& colour) {
    constexpr int sides = 32;
    const Vec3 axis = (tip - base).normalized();
    const Vec3 u = across(axis), v = axis.cross(u);
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> triangles;
    points->InsertNextPoint(tip.data());
    points->InsertNextPoint(base.data());
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        points->InsertNextPoint(
            Vec3(base + radius * (std::cos(angle) * u + std::sin(angle) * v)).data());
    }
    for (int i = 0; i < sides; ++i) {
        const vtkIdType a = 2 + i, b = 2 + (i + 1) % sides;
        const vtkIdType side[] = {0, a, b}, bottom[] = {1, b, a};
        triangles->InsertNextCell(3, side);
        triangles->InsertNextCell(3, bottom);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(triangles);
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(data);
    normals->SetFeatureAngle(80);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(normals->GetOutputPort());
    return actor_of(mapper, colour);
}

}  // namespace

vtkSmartPointer<vtkActor> surface_actor(const Surface& surface, const SharedMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetData(vectors(mesh.positions));
    const auto normals = vectors(mesh.normals);
    normals->SetName("Normals");
    vtkNew<vtkTypeInt32Array> connectivity;
    connectivity->SetArray(mesh.triangles.data(), static_cast<vtkIdType>(mesh.triangles.size()), 1);
    vtkNew<vtkCellArray> triangles;
    triangles->Use32BitStorage();
    triangles->SetData(3, connectivity);
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(triangles);
    data->GetPointData()->SetNormals(normals);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    mapper->ScalarVisibilityOff();
    mapper->StaticOn();
    auto actor = actor_of(mapper, surface.colour);
    look_matt(*actor);
    face_the_viewer(*actor);
    if (surface.opacity < 1) set_glass(*actor, surface.opacity);
    return actor;
}

std::vector<vtkSmartPointer<vtkActor>> marker_actors(const PictureScene& scene) {
    const Vec3& origin = scene.camera.focus;
    std::vector<vtkSmartPointer<vtkActor>> actors;
    for (const Ball& b : scene.balls) {
        actors.push_back(ball(b.centre - origin, b.radius, b.colour));
    }
    for (const Line& l : scene.lines) {
        if (!l.points.empty()) actors.push_back(tube(l.points, l.radius, l.colour, origin));
    }
    for (const Spring& s : scene.springs) {
        if (s.from == s.to) continue;
        actors.push_back(tube(coil(s), 0.22 * s.radius, s.colour, origin));
    }
    for (const Arrow& a : scene.arrows) {
        if (a.from == a.to) continue;
        const Vec3 axis = a.to - a.from;
        const Vec3 neck = a.to - std::min(0.6 * axis.norm(), 6 * a.radius) * axis.normalized();
        actors.push_back(tube({a.from, neck}, a.radius, a.colour, origin));
        actors.push_back(cone(neck - origin, a.to - origin, 2.4 * a.radius, a.colour));
    }
    for (const auto& actor : actors) {
        look_matt(*actor);
        actor->GetProperty()->SetSpecular(0.35);
    }
    return actors;
}

}  // namespace palpate::pictures
