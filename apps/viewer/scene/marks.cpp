// Balls, lines and words in VTK.
#include "apps/viewer/scene/marks.hpp"

#include <vtkNew.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>
#include <QCoreApplication>

#include <algorithm>
#include <cmath>

#include "pictures/vtk/props.hpp"

namespace palpate::viewer {
namespace {

constexpr Colour cut_colour{0.337, 0.706, 0.914};   // sky blue (Okabe and Ito)
constexpr Colour held_colour{0.941, 0.894, 0.259};  // yellow
constexpr Colour measure_colour{0.95, 0.85, 0.1};
// [logical pixels]
constexpr double cut_ball_px = 6, cut_line_px = 1.5, dot_px = 7, line_px = 2;

Mark unlit(const vtkSmartPointer<vtkPolyData>& shape, const Colour& colour, double width) {
    Mark mark;
    mark.shape = shape;
    mark.colour = colour;
    mark.lit = false;
    mark.width = width;
    return mark;
}

}  // namespace

void add_cut(std::vector<Mark>& marks, const Look& look, const Geometry& geometry,
             const MarkView& view, std::optional<std::size_t> held,
             const vtkSmartPointer<vtkPolyData>& ball) {
    const auto handles = handles_of(look, geometry, cut_arm_px * view.pixel);
    for (std::size_t i = 0; i < handles.size(); ++i) {
        Mark mark = unlit(ball, held == i ? held_colour : cut_colour, 1);
        mark.place = at_scale(handles[i].at - view.origin, cut_ball_px * view.pixel);
        marks.push_back(mark);
    }
    auto lines = outline_of(look, geometry);
    if (look.cut == Cut::plane) lines.push_back({handles[0].at, handles[1].at});
    MarkShape shape;
    shape.lines(lines, view.origin);
    marks.push_back(unlit(shape.data(), cut_colour, cut_line_px * view.ratio));
}

void add_measurements(std::vector<Mark>& marks, const std::vector<Measurement>& all,
                      const MarkView& view) {
    MarkShape lines, dots;
    for (const Measurement& m : all) {
        for (std::size_t i = 0; i < m.points.size(); ++i) {
            dots.dot(dots.point(m.points[i] - view.origin));
            if (i > 0) lines.lines({{m.points[i - 1], m.points[i]}}, view.origin);
        }
    }
    for (const auto& [shape, width] : {std::pair{&lines, line_px}, {&dots, dot_px}}) {
        Mark mark = unlit(shape->data(), measure_colour, width * view.ratio);
        mark.opacity = 0;
        mark.faint = 1;
        marks.push_back(mark);
    }
}

Annotations::Annotations(int layer)
    : writing_(vtkSmartPointer<vtkRenderer>::New()),
      orientation_(pictures::orientation_view(layer)),
      bar_(vtkSmartPointer<vtkActor2D>::New()),
      text_(vtkSmartPointer<vtkTextActor>::New()) {
    writing_->SetLayer(layer);
    writing_->InteractiveOff();
    bar_->SetMapper(vtkNew<vtkPolyDataMapper2D>());
    bar_->VisibilityOff();
    writing_->AddActor2D(bar_);
    vtkTextProperty* const p = text_->GetTextProperty();
    p->SetFontFamilyToArial();
    p->SetJustificationToCentered();
    p->SetVerticalJustificationToBottom();
    writing_->AddActor2D(text_);
    orientation_->DrawOff();  // before it has its place it would fill the window
}

/// VTK's sizes are points, of which there are 72 an inch.
int Annotations::points(double em) const {
    vtkRenderWindow* const window = writing_->GetRenderWindow();
    return static_cast<int>(std::lround(em * 72 / (window ? window->GetDPI() : 72)));
}

void Annotations::show_bar(const Content& what) {
    bar_->SetVisibility(what.scale_bar);
    text_->SetVisibility(what.scale_bar);
    if (!what.scale_bar) return;
    const double em = what.em;
    const auto bar = pictures::scale_bar(std::round(what.ratio * what.size.width),
                                         what.ratio / mm_per_pixel(what.camera, what.size), em,
                                         std::max(1.0, 0.14 * em));
    vtkPolyDataMapper2D::SafeDownCast(bar_->GetMapper())->SetInputData(bar.shape);
    bar_->GetProperty()->SetColor(what.ink.red, what.ink.green, what.ink.blue);
    text_->SetInput(bar.text.c_str());
    text_->GetTextProperty()->SetFontSize(points(em));
    text_->GetTextProperty()->SetColor(what.ink.red, what.ink.green, what.ink.blue);
    // The line of the volume's box may lie behind it.
    text_->GetTextProperty()->SetBackgroundColor(what.paper.red, what.paper.green, what.paper.blue);
    text_->GetTextProperty()->SetBackgroundOpacity(0.8);
    text_->SetPosition(bar.middle, 1.6 * em);
}

/// Shows words beside the middle of a length, and beside the corner of an angle.
void Annotations::show_words(const Content& what) {
    while (words_.size() < what.measurements.size()) {
        auto text = vtkSmartPointer<vtkTextActor>::New();
        text->GetTextProperty()->SetFontFamilyToArial();
        text->GetTextProperty()->SetBold(true);
        text->GetTextProperty()->SetShadow(true);
        text->GetTextProperty()->SetColor(measure_colour.red, measure_colour.green,
                                          measure_colour.blue);
        writing_->AddActor2D(text);
        words_.push_back(text);
    }
    const std::string voxel = QCoreApplication::translate("Units", "voxel").toStdString();
    for (std::size_t i = 0; i < words_.size(); ++i) {
        const bool there = i < what.measurements.size();
        const std::string words =
            there ? text_of(what.measurements[i], what.unit, voxel) : std::string();
        words_[i]->SetVisibility(!words.empty());
        if (words.empty()) continue;
        const auto& [kind, p] = what.measurements[i];
        const Vec3 at = kind == Measure::length ? Vec3(0.5 * (p[0] + p[1])) : p[1];
        const Pixel seen = pixel_of(what.camera, what.size, at);
        words_[i]->SetInput(words.c_str());
        words_[i]->GetTextProperty()->SetFontSize(points(what.em));
        words_[i]->SetPosition(what.ratio * (seen.x + 8),
                               what.ratio * (what.size.height - seen.y + 6));
    }
}

void Annotations::show(const Content& what) {
    show_bar(what);
    show_words(what);
    orientation_->SetDraw(what.orientation);
    const double width = what.ratio * what.size.width, height = what.ratio * what.size.height;
    const double side = std::clamp(0.17 * std::min(width, height), 4 * what.em, 9 * what.em);
    orientation_->SetViewport(0, 0, std::min(1.0, side / width), std::min(1.0, side / height));
    pictures::turn_orientation(*orientation_, what.camera.towards_viewer, what.camera.up,
                               what.oriented);
}

}  // namespace palpate::viewer
