// Annotations over the scene: a cube that shows where left and right are, and a scale bar.
#pragma once

#include <vtkActor2D.h>
#include <vtkPolyData.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include "pictures/scene.hpp"

namespace palpate::viewer {

class Annotations {
  public:
    /// Two renderers of its own, both in this layer.
    explicit Annotations(int layer);
    vtkRenderer& writing() const { return *writing_; }
    vtkRenderer& orientation() const { return *orientation_; }

    struct Content {
        bool orientation = true, scale_bar = true;
        bool oriented = true;  ///< as in Geometry
        pictures::Camera camera;
        int width = 1, height = 1;    ///< [device pixels]
        double em = 12;               ///< [device pixels] height of the widget's font
        pictures::Colour ink, paper;  ///< of the bar, and behind its words
    };
    void show(const Content& what);

  private:
    void show_bar(const Content& what);

    vtkSmartPointer<vtkRenderer> writing_, orientation_;
    vtkSmartPointer<vtkActor2D> bar_;
    vtkSmartPointer<vtkPolyData> bar_data_;
    vtkSmartPointer<vtkTextActor> text_;
};

}  // namespace palpate::viewer
