// Marks over the scene: cuts with their handles, measurements, the orientation cube and the scale
// bar.
#pragma once

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkPolyData.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include <array>
#include <optional>
#include <vector>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/navigation.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

/// The mesh in one colour. A later change of the mesh is drawn, too.
vtkSmartPointer<vtkActor> flat_actor(vtkPolyData* data, const pictures::Colour& colour);

/// Draws the outline of a cut and its handles, which keep their size on the screen.
class CutMarks {
  public:
    explicit CutMarks(vtkRenderer& renderer);
    /// `origin` [mm, physical] of what is drawn; `pixel` [mm] is a logical pixel. `held`: this
    /// handle is under the pointer.
    void show(const Look& look, const Geometry& geometry, const Vec3& origin, double pixel,
              double pixel_ratio, std::optional<std::size_t> held);
    void hide();

  private:
    std::array<vtkSmartPointer<vtkActor>, 6> balls_;
    vtkSmartPointer<vtkActor> lines_;
    vtkSmartPointer<vtkPolyData> outline_;
};

/// [logical pixels] From a cut's point to the tip of its normal.
inline constexpr double cut_arm_px = 70;

/// Draws measurements over the scene: points, lines between them, and what they measure.
class MeasureMarks {
  public:
    /// Points and lines go into `overlay`, where nothing hides them; words into `writing`, whose
    /// units are pixels.
    MeasureMarks(vtkRenderer& overlay, vtkRenderer& writing);

    struct View {
        Vec3 origin = Vec3::Zero();  ///< [mm, physical] of what is drawn
        Camera camera;
        ViewSize size;           ///< [logical pixels]
        double pixel_ratio = 1;  ///< device pixels a logical pixel
        double em = 12;          ///< [device pixels] height of the words
        LengthUnit unit = LengthUnit::automatic;
    };
    void show(const std::vector<Measurement>& all, const View& view);

  private:
    void put_points(const std::vector<Measurement>& all, const View& view);
    void put_words(const std::vector<Measurement>& all, const View& view);

    vtkRenderer &overlay_, &writing_;
    vtkSmartPointer<vtkActor> lines_, dots_;
    vtkSmartPointer<vtkPolyData> line_data_, dot_data_;
    std::vector<vtkSmartPointer<vtkTextActor>> words_;
};

/// Annotations over the scene: a cube that shows where left and right are, and a scale bar.
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
