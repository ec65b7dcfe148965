// Marks over the scene: cuts with their handles, measurements, the orientation cube and the scale
// bar.
#pragma once

#include <vtkActor2D.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/mark.hpp"
#include "apps/viewer/scene/navigation.hpp"

namespace palpate::viewer {

/// [logical pixels] From a cut's point to the tip of its normal.
inline constexpr double cut_arm_px = 70;

/// The outline of a cut and its handles, which keep their size on the screen. `held`: this handle
/// is under the pointer.
void add_cut(std::vector<Mark>& marks, const Look& look, const Geometry& geometry,
             const MarkView& view, std::optional<std::size_t> held,
             const vtkSmartPointer<vtkPolyData>& ball);

/// Points, and lines between them, where nothing hides them.
void add_measurements(std::vector<Mark>& marks, const std::vector<Measurement>& all,
                      const MarkView& view);

/// What is written and drawn in front of everything: what is measured, a cube that shows where left
/// and right are, and a scale bar.
class Annotations {
  public:
    /// Two renderers of its own, both in this layer.
    explicit Annotations(int layer);
    vtkRenderer& writing() const { return *writing_; }
    vtkRenderer& orientation() const { return *orientation_; }

    struct Content {
        bool orientation = false, scale_bar = false;
        bool oriented = true;  ///< as in Geometry
        Camera camera;
        ViewSize size;      ///< [logical pixels]
        double ratio = 1;   ///< device pixels a logical pixel
        double em = 12;     ///< [device pixels] height of the widget's font
        Colour ink, paper;  ///< of the bar, and behind its words
        std::vector<Measurement> measurements;
        LengthUnit unit = LengthUnit::automatic;
    };
    void show(const Content& what);

  private:
    void show_bar(const Content& what);
    void show_words(const Content& what);
    int points(double em) const;

    vtkSmartPointer<vtkRenderer> writing_, orientation_;
    vtkSmartPointer<vtkActor2D> bar_;
    vtkSmartPointer<vtkTextActor> text_;
    std::vector<vtkSmartPointer<vtkTextActor>> words_;
};

}  // namespace palpate::viewer
