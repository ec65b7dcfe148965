// Materials as VTK properties and shaders.
#include "pictures/vtk/material.hpp"

#include <vtkProperty.h>
#include <vtkShaderProperty.h>

#include <algorithm>
#include <cstdio>

namespace palpate::pictures {

void look_matt(vtkActor& actor) {
    vtkProperty* const p = actor.GetProperty();
    p->SetInterpolationToPhong();
    p->SetAmbient(0.16);
    p->SetDiffuse(0.9);
    p->SetSpecular(0.08);
    p->SetSpecularPower(25);
}

void face_the_viewer(vtkActor& actor) {
    actor.GetShaderProperty()->AddFragmentShaderReplacement(
        "//VTK::Normal::Impl", true,
        "//VTK::Normal::Impl\n"
        "  if (normalVCVSOutput.z < 0.0) normalVCVSOutput = -normalVCVSOutput;\n",
        false);
}

void set_glass(vtkActor& actor, double opacity) {
    vtkShaderProperty* const shader = actor.GetShaderProperty();
    shader->ClearFragmentShaderReplacement("//VTK::Light::Impl", false);
    actor.ForceOpaqueOn();
    if (opacity >= 1) return;
    char code[256];
    std::snprintf(code, sizeof code,
                  "//VTK::Light::Impl\n"
                  "  float aslant = 1.0 - abs(normalVCVSOutput.z);\n"
                  "  gl_FragData[0].a = %.3f + %.3f * aslant * aslant * aslant;\n",
                  opacity, std::min(0.6, 1 - opacity));
    shader->AddFragmentShaderReplacement("//VTK::Light::Impl", false, code, false);
}

}  // namespace palpate::pictures
