// Lines, dots and words in VTK.
#include "apps/viewer/scene/measure_marks.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>

#include <cmath>

#include "apps/viewer/scene/flat_actor.hpp"

namespace palpate::viewer {
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

}  // namespace palpate::viewer
