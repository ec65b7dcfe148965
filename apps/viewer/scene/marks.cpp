// Balls, lines and words in VTK.
#include "apps/viewer/scene/marks.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkSphereSource.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "pictures/vtk/props.hpp"

namespace palpate::viewer {

vtkSmartPointer<vtkActor> flat_actor(vtkPolyData* data, const pictures::Colour& colour) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
    return actor;
}

namespace {

constexpr Colour cut_colour{0.337, 0.706, 0.914};   // sky blue (Okabe and Ito)
constexpr Colour held_colour{0.941, 0.894, 0.259};  // yellow
constexpr double ball_px = 6;

void put_lines(vtkPolyData& data, const std::vector<std::array<Vec3, 2>>& lines,
               const Vec3& origin) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    for (const auto& line : lines) {
        cells->InsertNextCell(2);
        for (const Vec3& end : line) {
            cells->InsertCellPoint(points->InsertNextPoint(Vec3(end - origin).data()));
        }
    }
    data.SetPoints(points);
    data.SetLines(cells);
    data.Modified();
}

}  // namespace

CutMarks::CutMarks(vtkRenderer& renderer) : outline_(vtkSmartPointer<vtkPolyData>::New()) {
    vtkNew<vtkSphereSource> ball;
    ball->SetRadius(1);
    ball->SetThetaResolution(24);
    ball->SetPhiResolution(16);
    ball->Update();
    for (auto& actor : balls_) {
        actor = flat_actor(ball->GetOutput(), cut_colour);
        renderer.AddActor(actor);
    }
    lines_ = flat_actor(outline_, cut_colour);
    renderer.AddActor(lines_);
    hide();
}

void CutMarks::hide() {
    for (auto& actor : balls_) actor->SetVisibility(false);
    lines_->SetVisibility(false);
}

void CutMarks::show(const Look& look, const Geometry& geometry, const Vec3& origin, double pixel,
                    double pixel_ratio, std::optional<std::size_t> held) {
    hide();
    const auto handles = handles_of(look, geometry, cut_arm_px * pixel);
    for (std::size_t i = 0; i < handles.size(); ++i) {
        vtkActor* const ball = balls_[i];
        const Colour& c = held == i ? held_colour : cut_colour;
        ball->GetProperty()->SetColor(c.red, c.green, c.blue);
        ball->SetPosition(Vec3(handles[i].at - origin).data());
        ball->SetScale(ball_px * pixel);
        ball->SetVisibility(true);
    }
    if (handles.empty()) return;
    auto lines = outline_of(look, geometry);
    if (look.cut == Cut::plane) lines.push_back({handles[0].at, handles[1].at});
    put_lines(*outline_, lines, origin);
    lines_->GetProperty()->SetLineWidth(static_cast<float>(1.5 * pixel_ratio));
    lines_->SetVisibility(true);
}

namespace {

constexpr pictures::Colour colour{0.95, 0.85, 0.1};
constexpr double dot_px = 7, line_px = 2;

}  // namespace

MeasureMarks::MeasureMarks(vtkRenderer& overlay, vtkRenderer& writing)
    : overlay_(overlay),
      writing_(writing),
      line_data_(vtkSmartPointer<vtkPolyData>::New()),
      dot_data_(vtkSmartPointer<vtkPolyData>::New()) {
    lines_ = flat_actor(line_data_, colour);
    dots_ = flat_actor(dot_data_, colour);
    dots_->GetProperty()->RenderPointsAsSpheresOn();
    overlay_.AddActor(lines_);
    overlay_.AddActor(dots_);
}

void MeasureMarks::put_points(const std::vector<Measurement>& all, const View& view) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines, dots;
    for (const Measurement& m : all) {
        const vtkIdType first = points->GetNumberOfPoints();
        for (const Vec3& p : m.points) points->InsertNextPoint(Vec3(p - view.origin).data());
        const auto count = static_cast<vtkIdType>(m.points.size());
        for (vtkIdType i = 0; i < count; ++i) {
            dots->InsertNextCell({first + i});
            if (i > 0) lines->InsertNextCell({first + i - 1, first + i});
        }
    }
    line_data_->SetPoints(points);
    line_data_->SetLines(lines);
    dot_data_->SetPoints(points);
    dot_data_->SetVerts(dots);
    const auto ratio = static_cast<float>(view.pixel_ratio);
    lines_->GetProperty()->SetLineWidth(static_cast<float>(line_px) * ratio);
    dots_->GetProperty()->SetPointSize(static_cast<float>(dot_px) * ratio);
}

/// Beside the middle of a length, and the corner of an angle.
void MeasureMarks::put_words(const std::vector<Measurement>& all, const View& view) {
    while (words_.size() < all.size()) {
        auto text = vtkSmartPointer<vtkTextActor>::New();
        text->GetTextProperty()->SetFontFamilyToArial();
        text->GetTextProperty()->SetBold(true);
        text->GetTextProperty()->SetShadow(true);
        text->GetTextProperty()->SetColor(colour.red, colour.green, colour.blue);
        writing_.AddActor2D(text);
        words_.push_back(text);
    }
    vtkRenderWindow* const window = writing_.GetRenderWindow();
    const double points = view.em * 72 / (window ? window->GetDPI() : 72);
    for (std::size_t i = 0; i < words_.size(); ++i) {
        const std::string words = i < all.size() ? text_of(all[i], view.unit) : std::string();
        words_[i]->SetVisibility(!words.empty());
        if (words.empty()) continue;
        const auto& p = all[i].points;
        const Vec3 at = all[i].kind == Measure::length ? Vec3(0.5 * (p[0] + p[1])) : p[1];
        const Pixel seen = pixel_of(view.camera, view.size, at);
        words_[i]->SetInput(words.c_str());
        words_[i]->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(points)));
        words_[i]->SetPosition(view.pixel_ratio * (seen.x + 8),
                               view.pixel_ratio * (view.size.height - seen.y + 6));
    }
}

void MeasureMarks::show(const std::vector<Measurement>& all, const View& view) {
    put_points(all, view);
    put_words(all, view);
    lines_->SetVisibility(!all.empty());
    dots_->SetVisibility(!all.empty());
}

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
