// Makes VTK actors of meshes and markers.
#include "pictures/helper/bodies.hpp"

#include <vtkNew.h>
#include <vtkOpenGLPolyDataMapper.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>

#include "pictures/vtk/material.hpp"
#include "pictures/vtk/shapes.hpp"

namespace palpate::pictures {
namespace {

vtkSmartPointer<vtkActor> actor_of(vtkPolyDataMapper* mapper, const Colour& colour) {
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
    return actor;
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

vtkSmartPointer<vtkActor> actor_of(vtkPolyData* mesh, const Colour& colour) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(mesh);
    mapper->ScalarVisibilityOff();
    return actor_of(mapper, colour);
}

}  // namespace

vtkSmartPointer<vtkActor> surface_actor(const Surface& surface, const SharedMesh& mesh) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(mesh_of(mesh.positions, mesh.normals, mesh.triangles));
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
        if (l.points.empty()) continue;
        std::vector<Vec3> points = l.points;
        for (Vec3& point : points) point -= origin;
        const auto mesh = tube(points, l.radius);
        actors.push_back(mesh ? actor_of(mesh, l.colour)
                              : ball(points.front(), l.radius, l.colour));
    }
    for (const Spring& s : scene.springs) {
        if (s.from == s.to) continue;
        actors.push_back(actor_of(spring(s.from - origin, s.to - origin, s.radius), s.colour));
    }
    for (const Arrow& a : scene.arrows) {
        if (a.from == a.to) continue;
        actors.push_back(actor_of(arrow(a.from - origin, a.to - origin, a.radius), a.colour));
    }
    for (const auto& actor : actors) {
        look_matt(*actor);
        actor->GetProperty()->SetSpecular(0.35);
    }
    return actors;
}

}  // namespace palpate::pictures
