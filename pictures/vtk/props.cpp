// Makes the lights, the orientation cube and the scale bar.
#include "pictures/vtk/props.hpp"

#include <vtkAnnotatedCubeActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkProperty.h>

#include <cmath>
#include <cstdio>

namespace palpate::pictures {
namespace {

void name_faces(vtkAnnotatedCubeActor& cube, bool oriented) {
    cube.SetFaceTextScale(oriented ? 0.62 : 0.42);  // two letters are wider
    cube.SetXPlusFaceText(oriented ? "L" : "+X");
    cube.SetXMinusFaceText(oriented ? "R" : "-X");
    cube.SetYPlusFaceText(oriented ? "P" : "+Y");
    cube.SetYMinusFaceText(oriented ? "A" : "-Y");
    cube.SetZPlusFaceText(oriented ? "S" : "+Z");
    cube.SetZMinusFaceText(oriented ? "I" : "-Z");
}

vtkSmartPointer<vtkAnnotatedCubeActor> body_cube() {
    auto cube = vtkSmartPointer<vtkAnnotatedCubeActor>::New();
    name_faces(*cube, true);
    cube->SetXFaceTextRotation(0);
    cube->SetYFaceTextRotation(0);
    cube->SetZFaceTextRotation(-90);
    cube->SetTextEdgesVisibility(0);  // those of sides seen edge-on would be dashes
    cube->GetCubeProperty()->SetColor(0.86, 0.88, 0.9);
    cube->GetCubeProperty()->SetAmbient(0.35);
    cube->GetCubeProperty()->SetDiffuse(0.7);
    // Seen straight on it is one flat face.
    cube->GetCubeProperty()->EdgeVisibilityOn();
    cube->GetCubeProperty()->SetEdgeColor(0.45, 0.46, 0.48);
    constexpr double ink = 0.13;
    for (vtkProperty* face : {cube->GetXPlusFaceProperty(), cube->GetXMinusFaceProperty(),
                              cube->GetYPlusFaceProperty(), cube->GetYMinusFaceProperty(),
                              cube->GetZPlusFaceProperty(), cube->GetZMinusFaceProperty()}) {
        face->SetColor(ink, ink, ink);
        face->SetAmbient(1);
        face->SetDiffuse(0);
    }
    return cube;
}

/// 1, 2 or 5 times a power of ten: the greatest that is at most `most` (> 0).
double round_length(double most) {
    const double power = std::pow(10, std::floor(std::log10(most)));
    for (const double digit : {5.0, 2.0}) {
        if (digit * power <= most) return digit * power;
    }
    return power;
}

/// A length [mm] as people read it: "20 mm", "500 µm", "10 cm", "2 m".
std::string words_of(double length) {
    struct Unit {
        const char* name;
        double mm, from;
    };
    constexpr Unit units[]{{"km", 1e6, 1e6}, {"m", 1e3, 1e3},           {"cm", 10, 100},
                           {"mm", 1, 1},     {"\xC2\xB5m", 1e-3, 1e-3}, {"nm", 1e-6, 0}};
    // Powers of ten are not exact.
    const auto* unit = std::ranges::find_if(
        units, [&](const Unit& one) { return length >= (1 - 1e-9) * one.from; });
    char text[32];
    std::snprintf(text, sizeof text, "%g %s", length / unit->mm, unit->name);
    return text;
}

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

void light(vtkRenderer& renderer) {
    struct Lamp {
        double x, y, z, intensity;
    };
    renderer.AutomaticLightCreationOff();
    for (const Lamp& lamp : {Lamp{-0.55, 0.75, 1, 0.78}, Lamp{0.9, -0.1, 0.6, 0.26},
                             Lamp{0, 0, 1, 0.2}, Lamp{0.2, -1, 0.2, 0.12}}) {
        vtkNew<vtkLight> l;
        l->SetLightTypeToCameraLight();
        l->SetPosition(lamp.x, lamp.y, lamp.z);
        l->SetFocalPoint(0, 0, 0);
        l->SetIntensity(lamp.intensity);
        renderer.AddLight(l);
    }
}

vtkSmartPointer<vtkRenderer> orientation_view(int layer) {
    auto view = vtkSmartPointer<vtkRenderer>::New();
    view->SetLayer(layer);
    view->InteractiveOff();
    view->AddActor(body_cube());
    return view;
}

void turn_orientation(vtkRenderer& view, const Vec3& towards_viewer, const Vec3& up,
                      bool oriented) {
    name_faces(*vtkAnnotatedCubeActor::SafeDownCast(view.GetViewProps()->GetLastProp()), oriented);
    vtkCamera* const camera = view.GetActiveCamera();
    camera->ParallelProjectionOn();
    camera->SetFocalPoint(0, 0, 0);
    camera->SetPosition(Vec3(5 * towards_viewer.normalized()).data());
    camera->SetViewUp(Vec3(up).data());
    camera->SetParallelScale(1.15);
    camera->SetClippingRange(2, 8);
}

ScaleBar scale_bar(double width, double pixels_per_mm, double em, double thick) {
    const double length = round_length(0.22 * width / pixels_per_mm);
    const double pixels = length * pixels_per_mm;
    const double right = width - 1.3 * em, y = 1.1 * em;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> polygons;
    add_box(*points, *polygons, right - pixels, y, pixels, thick);
    for (const double x : {right - pixels, right - thick}) {
        add_box(*points, *polygons, x, y - 0.25 * em, thick, 0.5 * em + thick);
    }
    auto shape = vtkSmartPointer<vtkPolyData>::New();
    shape->SetPoints(points);
    shape->SetPolys(polygons);
    return {shape, words_of(length), right - 0.5 * pixels};
}

}  // namespace palpate::pictures
