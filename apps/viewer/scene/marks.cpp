// Keeps an actor for each mark, and draws balls, lines and words in VTK.
#include "apps/viewer/scene/marks.hpp"

#include <vtkCellArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkTextProperty.h>
#include <QCoreApplication>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pictures/vtk/material.hpp"
#include "pictures/vtk/props.hpp"

namespace palpate::viewer {

vtkSmartPointer<vtkPolyData> unit_ball() {
    vtkNew<vtkSphereSource> source;
    source->SetRadius(1);
    source->SetThetaResolution(32);
    source->SetPhiResolution(20);
    source->Update();
    return source->GetOutput();
}

Mark flat_mark(vtkSmartPointer<vtkPolyData> shape, const Colour& colour, double width,
               double faint) {
    Mark mark;
    mark.shape = std::move(shape);
    mark.colour = colour;
    mark.faint = faint;
    mark.lit = false;
    mark.width = width;
    return mark;
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

namespace {

constexpr Colour cut_colour{0.337, 0.706, 0.914};   // sky blue (Okabe and Ito)
constexpr Colour held_colour{0.941, 0.894, 0.259};  // yellow
constexpr Colour measure_colour{0.95, 0.85, 0.1};
// [logical pixels]
constexpr double cut_ball_px = 6, cut_line_px = 1.5, dot_px = 7, line_px = 2;

}  // namespace

void add_cut(std::vector<Mark>& marks, const Look& look, const Geometry& geometry,
             const MarkView& view, std::optional<std::size_t> held,
             const vtkSmartPointer<vtkPolyData>& ball) {
    const auto handles = handles_of(look, geometry, cut_arm_px * view.pixel);
    for (std::size_t i = 0; i < handles.size(); ++i) {
        Mark mark = flat_mark(ball, held == i ? held_colour : cut_colour, 1);
        mark.place = at_scale(handles[i].at - view.origin, cut_ball_px * view.pixel);
        marks.push_back(mark);
    }
    auto lines = outline_of(look, geometry);
    if (look.cut == Cut::plane) lines.push_back({handles[0].at, handles[1].at});
    MarkShape shape;
    shape.lines(lines, view.origin);
    marks.push_back(flat_mark(shape.data(), cut_colour, cut_line_px * view.ratio));
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
        marks.push_back(flat_mark(shape->data(), measure_colour, width * view.ratio, 1));
        marks.back().opacity = 0;
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
