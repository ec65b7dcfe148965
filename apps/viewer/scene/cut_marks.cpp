// Balls and lines in VTK.
#include "apps/viewer/scene/cut_marks.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>

#include "apps/viewer/scene/flat_actor.hpp"

namespace palpate::viewer {
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

}  // namespace palpate::viewer
