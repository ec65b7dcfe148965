// Draws the orientation cube and the scale bar.
#include "apps/viewer/scene/annotations.hpp"

#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "pictures/vtk/props.hpp"

namespace palpate::viewer {
namespace {

void add_box(vtkPoints& points, vtkCellArray& polygons, double x, double y, double width,
             double height) {
    const vtkIdType first = points.InsertNextPoint(x, y, 0);
    points.InsertNextPoint(x + width, y, 0);
    points.InsertNextPoint(x + width, y + height, 0);
    points.InsertNextPoint(x, y + height, 0);
    const vtkIdType corners[] = {first, first + 1, first + 2, first + 3};
    polygons.InsertNextCell(4, corners);
}

}  // namespace

Annotations::Annotations(int layer)
    : writing_(vtkSmartPointer<vtkRenderer>::New()),
      orientation_(vtkSmartPointer<vtkRenderer>::New()),
      bar_(vtkSmartPointer<vtkActor2D>::New()),
      bar_data_(vtkSmartPointer<vtkPolyData>::New()),
      text_(vtkSmartPointer<vtkTextActor>::New()) {
    for (vtkRenderer* renderer : {writing_.Get(), orientation_.Get()}) {
        renderer->SetLayer(layer);
        renderer->InteractiveOff();
    }
    orientation_->AddActor(pictures::body_cube());
    orientation_->GetActiveCamera()->ParallelProjectionOn();
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(bar_data_);
    bar_->SetMapper(mapper);
    writing_->AddActor2D(bar_);
    vtkTextProperty* const p = text_->GetTextProperty();
    p->SetFontFamilyToArial();
    p->SetJustificationToCentered();
    p->SetVerticalJustificationToBottom();
    writing_->AddActor2D(text_);
}

void Annotations::show_bar(const Content& what) {
    bar_->SetVisibility(what.scale_bar);
    text_->SetVisibility(what.scale_bar);
    if (!what.scale_bar) return;
    const double pixels_per_mm = what.height / (2 * what.camera.half_height);
    const double length = pictures::round_length(0.22 * what.width / pixels_per_mm);
    const double pixels = length * pixels_per_mm, em = what.em;
    const double right = what.width - 1.3 * em, y = 1.1 * em, thick = std::max(1.0, 0.14 * em);
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> polygons;
    add_box(*points, *polygons, right - pixels, y, pixels, thick);
    for (const double x : {right - pixels, right - thick}) {
        add_box(*points, *polygons, x, y - 0.25 * em, thick, 0.5 * em + thick);
    }
    bar_data_->SetPoints(points);
    bar_data_->SetPolys(polygons);
    bar_data_->Modified();
    bar_->GetProperty()->SetColor(what.ink.red, what.ink.green, what.ink.blue);
    text_->SetInput(pictures::in_millimetres(length).c_str());
    // VTK's sizes are points, of which there are 72 an inch.
    vtkRenderWindow* const window = writing_->GetRenderWindow();
    const double size = em * 72 / (window ? window->GetDPI() : 72);
    text_->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(size)));
    text_->GetTextProperty()->SetColor(what.ink.red, what.ink.green, what.ink.blue);
    text_->SetPosition(right - 0.5 * pixels, y + 0.5 * em);
}

void Annotations::show(const Content& what) {
    show_bar(what);
    orientation_->SetDraw(what.orientation);
    const double side =
        std::clamp(0.17 * std::min(what.width, what.height), 4 * what.em, 9 * what.em);
    orientation_->SetViewport(0, 0, std::min(1.0, side / what.width),
                              std::min(1.0, side / what.height));
    vtkCamera* const camera = orientation_->GetActiveCamera();
    camera->SetFocalPoint(0, 0, 0);
    camera->SetPosition(Vec3(5 * what.camera.towards_viewer.normalized()).data());
    camera->SetViewUp(Vec3(what.camera.up).data());
    camera->SetParallelScale(1.15);
    camera->SetClippingRange(2, 8);
}

}  // namespace palpate::viewer
