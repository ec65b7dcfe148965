// Makes the lights, the orientation cube and the scale bar.
#include "pictures/vtk/props.hpp"

#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkProperty.h>

#include <cmath>
#include <cstdio>

namespace palpate::pictures {

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

vtkSmartPointer<vtkAnnotatedCubeActor> body_cube() {
    auto cube = vtkSmartPointer<vtkAnnotatedCubeActor>::New();
    cube->SetXPlusFaceText("L");
    cube->SetXMinusFaceText("R");
    cube->SetYPlusFaceText("P");
    cube->SetYMinusFaceText("A");
    cube->SetZPlusFaceText("S");
    cube->SetZMinusFaceText("I");
    cube->SetFaceTextScale(0.62);
    cube->SetXFaceTextRotation(90);
    cube->SetYFaceTextRotation(0);
    cube->SetZFaceTextRotation(90);
    cube->GetCubeProperty()->SetColor(0.86, 0.88, 0.9);
    cube->GetCubeProperty()->SetAmbient(0.35);
    cube->GetCubeProperty()->SetDiffuse(0.7);
    constexpr double ink = 0.13;
    cube->GetTextEdgesProperty()->SetColor(ink, ink, ink);
    for (vtkProperty* face : {cube->GetXPlusFaceProperty(), cube->GetXMinusFaceProperty(),
                              cube->GetYPlusFaceProperty(), cube->GetYMinusFaceProperty(),
                              cube->GetZPlusFaceProperty(), cube->GetZMinusFaceProperty()}) {
        face->SetColor(ink, ink, ink);
        face->SetAmbient(1);
        face->SetDiffuse(0);
    }
    return cube;
}

double round_length(double most) {
    const double power = std::pow(10, std::floor(std::log10(most)));
    for (const double digit : {5.0, 2.0}) {
        if (digit * power <= most) return digit * power;
    }
    return power;
}

std::string in_millimetres(double length) {
    char text[32];
    if (length >= 1) {
        std::snprintf(text, sizeof text, "%g mm", length);
    } else {
        std::snprintf(text, sizeof text, "%g \xC2\xB5m", 1000 * length);
    }
    return text;
}

}  // namespace palpate::pictures
