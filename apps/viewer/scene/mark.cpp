// Keeps an actor for each mark.
#include "apps/viewer/scene/mark.hpp"

#include <vtkCellArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pictures/vtk/material.hpp"

namespace palpate::viewer {

vtkSmartPointer<vtkPolyData> unit_ball() {
    vtkNew<vtkSphereSource> source;
    source->SetRadius(1);
    source->SetThetaResolution(32);
    source->SetPhiResolution(20);
    source->Update();
    return source->GetOutput();
}

Eigen::Affine3d at_scale(const Vec3& at, double scale) {
    return Eigen::Translation3d(at) * Eigen::Scaling(scale);
}

MarkShape::MarkShape() : data_(vtkSmartPointer<vtkPolyData>::New()) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> dots, lines, polygons;
    points->SetDataTypeToFloat();
    data_->SetPoints(points);
    data_->SetVerts(dots);
    data_->SetLines(lines);
    data_->SetPolys(polygons);
}

vtkIdType MarkShape::point(const Vec3& at) {
    return data_->GetPoints()->InsertNextPoint(at.data());
}

void MarkShape::polygon(const std::vector<vtkIdType>& corners) {
    data_->GetPolys()->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
}

void MarkShape::line(vtkIdType a, vtkIdType b) {
    data_->GetLines()->InsertNextCell({a, b});
}

void MarkShape::dot(vtkIdType at) {
    data_->GetVerts()->InsertNextCell({at});
}

void MarkShape::lines(const std::vector<std::array<Vec3, 2>>& ends, const Vec3& origin) {
    for (const auto& [a, b] : ends) {
        const vtkIdType from = point(a - origin);
        line(from, point(b - origin));
    }
}

std::vector<vtkIdType> MarkShape::ring(const Vec3& at, const Vec3& u, const Vec3& v, int corners) {
    std::vector<vtkIdType> ring;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        ring.push_back(point(at + std::cos(angle) * u + std::sin(angle) * v));
    }
    return ring;
}

namespace {

vtkSmartPointer<vtkActor> new_actor(bool surface) {
    auto actor = vtkSmartPointer<vtkActor>::New();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->ScalarVisibilityOff();
    actor->SetMapper(mapper);
    actor->SetUserMatrix(vtkNew<vtkMatrix4x4>());
    pictures::look_matt(*actor);
    if (surface) pictures::face_the_viewer(*actor);
    actor->GetProperty()->RenderPointsAsSpheresOn();
    return actor;
}

void dress(vtkActor& actor, const Mark& mark, double opacity) {
    auto* const mapper = vtkPolyDataMapper::SafeDownCast(actor.GetMapper());
    if (mapper->GetInput() != mark.shape) mapper->SetInputData(mark.shape);
    vtkMatrix4x4* const matrix = actor.GetUserMatrix();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            matrix->SetElement(row, column, mark.place(row, column));
        }
    }
    vtkProperty* const p = actor.GetProperty();
    p->SetColor(mark.colour.red, mark.colour.green, mark.colour.blue);
    p->SetLighting(mark.lit);
    p->SetSpecular(mark.surface ? 0.08 : 0.35);
    p->SetOpacity(opacity);
    p->SetLineWidth(static_cast<float>(mark.width));
    p->SetPointSize(static_cast<float>(mark.width));
}

void write_colours(vtkViewport* viewport, bool on) {
    auto* const window =
        vtkOpenGLRenderWindow::SafeDownCast(vtkRenderer::SafeDownCast(viewport)->GetRenderWindow());
    const unsigned char write = on ? 1 : 0;
    window->GetState()->vtkglColorMask(write, write, write, write);
}

}  // namespace

MarkProp* MarkProp::New() {
    auto* const made = new MarkProp;
    made->InitializeObjectBase();
    return made;
}

void MarkProp::show(const std::vector<Mark>& marks) {
    drawn_.resize(marks.size());
    for (std::size_t i = 0; i < marks.size(); ++i) {
        const Mark& mark = marks[i];
        Drawn& drawn = drawn_[i];
        const double opacity = faint_ ? mark.faint : mark.opacity;
        drawn.shown = mark.shape && opacity > 0;
        if (!drawn.shown) continue;
        // A surface's shader is none for lines and points.
        if (!drawn.actor || drawn.surface != mark.surface) drawn.actor = new_actor(mark.surface);
        drawn.surface = mark.surface;
        dress(*drawn.actor, mark, opacity);
        drawn.actor->SetForceOpaque(faint_);
        drawn.memory = mark.memory;
        drawn.veil = mark.veil;
    }
    this->Modified();
}

int MarkProp::draw(vtkViewport* viewport, bool veils) {
    int drawn = 0;
    for (const Drawn& one : drawn_) {
        if (!one.shown || one.veil != veils || one.actor->HasTranslucentPolygonalGeometry()) {
            continue;
        }
        one.actor->SetPropertyKeys(this->GetPropertyKeys());
        drawn += one.actor->RenderOpaqueGeometry(viewport);
    }
    return drawn;
}

int MarkProp::RenderOpaqueGeometry(vtkViewport* viewport) {
    int drawn = 0;
    for (const bool veils : {false, true}) {
        if (faint_) {  // depths first
            write_colours(viewport, false);
            draw(viewport, veils);
            write_colours(viewport, true);
        }
        drawn += draw(viewport, veils);
    }
    return drawn;
}

int MarkProp::RenderTranslucentPolygonalGeometry(vtkViewport* viewport) {
    int drawn = 0;
    for (const Drawn& one : drawn_) {
        if (!one.shown || !one.actor->HasTranslucentPolygonalGeometry()) continue;
        one.actor->SetPropertyKeys(this->GetPropertyKeys());
        drawn += one.actor->RenderTranslucentPolygonalGeometry(viewport);
    }
    return drawn;
}

vtkTypeBool MarkProp::HasTranslucentPolygonalGeometry() {
    return std::ranges::any_of(drawn_, [](const Drawn& one) {
        return one.shown && one.actor->HasTranslucentPolygonalGeometry();
    });
}

void MarkProp::ReleaseGraphicsResources(vtkWindow* window) {
    for (const Drawn& one : drawn_) {
        if (one.actor) one.actor->ReleaseGraphicsResources(window);
    }
}

}  // namespace palpate::viewer
