// Draws text and small signs, in pixels from the window's lower left corner.
#include "pictures/helper/notes.hpp"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <string>

#include "pictures/vtk/props.hpp"

namespace palpate::pictures {
namespace {

constexpr double ink = 0.13;  // grey of all writing

void add_shape(vtkRenderer& renderer, vtkPolyData* shape, const Colour& colour) {
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(shape);
    vtkNew<vtkActor2D> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
    renderer.AddActor2D(actor);
}

/// A filled rectangle.
void add_box(vtkRenderer& renderer, double x, double y, double width, double height,
             const Colour& colour) {
    vtkNew<vtkPoints> points;
    points->InsertNextPoint(x, y, 0);
    points->InsertNextPoint(x + width, y, 0);
    points->InsertNextPoint(x + width, y + height, 0);
    points->InsertNextPoint(x, y + height, 0);
    const vtkIdType corners[] = {0, 1, 2, 3};
    vtkNew<vtkCellArray> polygons;
    polygons->InsertNextCell(4, corners);
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(polygons);
    add_shape(renderer, data, colour);
}

/// A square in a frame; beside each other, since what is drawn later does not cover.
void add_swatch(vtkRenderer& renderer, double x, double y, double side, double frame,
                const Colour& colour) {
    const Colour grey{0.45, 0.45, 0.45};
    add_box(renderer, x, y, side, side, colour);
    add_box(renderer, x - frame, y - frame, side + 2 * frame, frame, grey);
    add_box(renderer, x - frame, y + side, side + 2 * frame, frame, grey);
    add_box(renderer, x - frame, y, frame, side, grey);
    add_box(renderer, x + side, y, frame, side, grey);
}

struct Text {
    double x = 0, y = 0;  ///< its left end, or middle if centred; the middle of its height
    int size = 12;        ///< [pixels]
    bool centred = false, bold = false;
};

void add_text(vtkRenderer& renderer, const std::string& text, const Text& where) {
    vtkNew<vtkTextActor> actor;
    actor->SetInput(text.c_str());
    vtkTextProperty* const p = actor->GetTextProperty();
    p->SetFontFamilyToArial();
    p->SetFontSize(where.size);
    p->SetBold(where.bold);
    p->SetColor(ink, ink, ink);
    p->SetBackgroundColor(paper.red, paper.green, paper.blue);
    p->SetBackgroundOpacity(0.7);  // readable over a surface, unseen beside it
    p->SetVerticalJustificationToCentered();
    if (where.centred) p->SetJustificationToCentered();
    actor->SetPosition(where.x, where.y);
    renderer.AddActor2D(actor);
}

struct Entry {
    Colour colour;
    std::string label;
};

std::vector<Entry> entries_of(const PictureScene& scene) {
    std::vector<Entry> entries;
    const auto add = [&](const auto& all) {
        for (const auto& one : all) {
            if (!one.label.empty()) entries.push_back({one.colour, one.label});
        }
    };
    add(scene.surfaces);
    add(scene.balls);
    add(scene.springs);
    add(scene.arrows);
    add(scene.lines);
    return entries;
}

void add_legend(vtkRenderer& renderer, const PictureScene& scene, double em, int height) {
    const double line = 1.55 * em;
    double y = height - 1.5 * em;
    const auto size = static_cast<int>(em);
    if (!scene.title.empty()) {
        add_text(renderer, scene.title, {1.1 * em, y, size, false, true});
        y -= 1.15 * line;
    }
    if (!scene.legend) return;
    for (const Entry& entry : entries_of(scene)) {
        add_swatch(renderer, 1.1 * em, y - 0.36 * em, 0.72 * em, 0.06 * em, entry.colour);
        add_text(renderer, entry.label, {2.2 * em, y, size});
        y -= line;
    }
}

void add_scale_bar(vtkRenderer& renderer, const PictureScene& scene, double em, int width,
                   int height) {
    const double pixels_per_mm = height / (2 * scene.camera.half_height);
    const ScaleBar bar = scale_bar(width, pixels_per_mm, em, std::max(1.0, 0.16 * em));
    add_shape(renderer, bar.shape, {ink, ink, ink});
    add_text(renderer, bar.text, {bar.middle, 2.15 * em, static_cast<int>(em), true});
}

/// A cube whose faces say which side of the body they are, seen as the body is.
vtkSmartPointer<vtkRenderer> orientation_of(const PictureScene& scene, int width, int height,
                                            int layer) {
    const double side = 0.17 * std::min(width, height);
    auto renderer = orientation_view(layer);
    renderer->SetViewport(0, 0, side / width, side / height);
    turn_orientation(*renderer, scene.camera.towards_viewer, scene.camera.up, scene.oriented);
    return renderer;
}

}  // namespace

std::vector<vtkSmartPointer<vtkRenderer>> notes_of(const PictureScene& scene, int scale,
                                                   int layer) {
    const int width = scene.width * scale, height = scene.height * scale;
    const double em = std::max(9.0 * scale, 0.024 * std::min(width, height));
    auto writing = vtkSmartPointer<vtkRenderer>::New();
    writing->SetLayer(layer);
    writing->InteractiveOff();
    add_legend(*writing, scene, em, height);
    if (scene.scale_bar) add_scale_bar(*writing, scene, em, width, height);
    std::vector<vtkSmartPointer<vtkRenderer>> notes{writing};
    if (scene.orientation) notes.push_back(orientation_of(scene, width, height, layer));
    return notes;
}

}  // namespace palpate::pictures
