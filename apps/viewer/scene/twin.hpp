// Something drawn twice: with the scene, and faintly over it, so that it can be seen behind a
// surface.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <initializer_list>

#include "pictures/scene.hpp"

namespace palpate::viewer {

struct Twin {
    vtkSmartPointer<vtkActor> solid, depth, faint;
    vtkSmartPointer<vtkPolyData> data;  ///< of all three

    std::array<vtkActor*, 3> actors() const { return {solid, depth, faint}; }
};
inline constexpr double faint_opacity = 0.4;

/// Not visible yet.
Twin twin_of(const pictures::Colour& colour, vtkSmartPointer<vtkPolyData> data);
void set_visible(const Twin& twin, bool visible);
/// Adds the faint actors of these. One over its visible twin changes nothing; over a surface that
/// hides the twin it shows where that is. Of all of them only the nearest part is seen.
void add_faint_actors(vtkRenderer& overlay, std::initializer_list<const Twin*> twins);

}  // namespace palpate::viewer
