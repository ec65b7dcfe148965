// Draws the orientation cube and the scale bar.
#include "apps/viewer/scene/annotations.hpp"

#include <vtkNew.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "pictures/vtk/props.hpp"

namespace palpate::viewer {
Annotations::Annotations(int layer)
    : writing_(vtkSmartPointer<vtkRenderer>::New()),
      orientation_(pictures::orientation_view(layer)),
      bar_(vtkSmartPointer<vtkActor2D>::New()),
      bar_data_(vtkSmartPointer<vtkPolyData>::New()),
      text_(vtkSmartPointer<vtkTextActor>::New()) {
    writing_->SetLayer(layer);
    writing_->InteractiveOff();
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(bar_data_);
    bar_->SetMapper(mapper);
    writing_->AddActor2D(bar_);
    vtkTextProperty* const p = text_->GetTextProperty();
    p->SetFontFamilyToArial();
    p->SetJustificationToCentered();
    p->SetVerticalJustificationToBottom();
    writing_->AddActor2D(text_);
    orientation_->DrawOff();  // before it has its place it would fill the window
}

void Annotations::show_bar(const Content& what) {
    bar_->SetVisibility(what.scale_bar);
    text_->SetVisibility(what.scale_bar);
    if (!what.scale_bar) return;
    const double pixels_per_mm = what.height / (2 * what.camera.half_height);
    const double em = what.em;
    const auto bar = pictures::scale_bar(what.width, pixels_per_mm, em, std::max(1.0, 0.14 * em));
    bar_data_->ShallowCopy(bar.shape);
    bar_->GetProperty()->SetColor(what.ink.red, what.ink.green, what.ink.blue);
    text_->SetInput(bar.text.c_str());
    // VTK's sizes are points, of which there are 72 an inch.
    vtkRenderWindow* const window = writing_->GetRenderWindow();
    const double size = em * 72 / (window ? window->GetDPI() : 72);
    text_->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(size)));
    text_->GetTextProperty()->SetColor(what.ink.red, what.ink.green, what.ink.blue);
    // The line of the volume's box may lie behind it.
    text_->GetTextProperty()->SetBackgroundColor(what.paper.red, what.paper.green, what.paper.blue);
    text_->GetTextProperty()->SetBackgroundOpacity(0.8);
    text_->SetPosition(bar.middle, 1.6 * em);
}

void Annotations::show(const Content& what) {
    show_bar(what);
    orientation_->SetDraw(what.orientation);
    const double side =
        std::clamp(0.17 * std::min(what.width, what.height), 4 * what.em, 9 * what.em);
    orientation_->SetViewport(0, 0, std::min(1.0, side / what.width),
                              std::min(1.0, side / what.height));
    pictures::turn_orientation(*orientation_, what.camera.towards_viewer, what.camera.up,
                               what.oriented);
}

}  // namespace palpate::viewer
