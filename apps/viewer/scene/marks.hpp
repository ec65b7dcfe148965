// Marks over the picture of the scene, as plain values, and the prop that draws them. Also cuts
// with their handles, measurements, the orientation cube and the scale bar.
#pragma once

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkPolyData.h>
#include <vtkProp.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/navigation.hpp"
#include "palpate/volume.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

/// A shape in one colour. Positions are from the middle of the grid [mm, physical axes].
struct Mark {
    vtkSmartPointer<vtkPolyData> shape;  ///< null: nothing now; later marks keep their actors
    pictures::Colour colour;
    Eigen::Affine3d place = Eigen::Affine3d::Identity();  ///< of the shape
    /// Where it is seen with the scene, and over what hides it; 0: not there. A faint one over its
    /// visible twin changes nothing. Of all faint ones only the nearest part is seen.
    double opacity = 1, faint = 0;
    bool veil = false;  ///< faint marks behind this one are seen through it
    bool lit = true;
    bool surface = false;                ///< of the data: matt, shaded by its normals alone
    double width = 1;                    ///< [device pixels] of lines and points
    std::shared_ptr<const void> memory;  ///< that the shape reads
};
inline constexpr double faint_opacity = 0.4;

/// As is, without light and shadow.
Mark flat_mark(vtkSmartPointer<vtkPolyData> shape, const Colour& colour, double width,
               double faint = 0);

/// How marks are seen.
struct MarkView {
    Vec3 origin = Vec3::Zero();  ///< [mm, physical] of what is drawn
    double pixel = 1;            ///< [mm] a logical pixel
    double ratio = 1;            ///< device pixels a logical pixel
};

/// Of radius 1 about the origin.
vtkSmartPointer<vtkPolyData> unit_ball();
/// Sizes are in mm; a ball of this radius is placed there.
Eigen::Affine3d at_scale(const Vec3& at, double scale);

/// Points and cells that become a shape.
class MarkShape {
  public:
    vtkIdType point(const Vec3& at);
    void polygon(const std::vector<vtkIdType>& corners);
    void line(vtkIdType a, vtkIdType b);
    void dot(vtkIdType at);
    void lines(const std::vector<std::array<Vec3, 2>>& ends, const Vec3& origin);
    /// Round `at`, from `u` over `v`.
    std::vector<vtkIdType> ring(const Vec3& at, const Vec3& u, const Vec3& v, int corners);
    vtkSmartPointer<vtkPolyData> data() const { return data_; }

    MarkShape();

  private:
    vtkSmartPointer<vtkPolyData> data_;
};

/// Draws marks with the scene, or the faint ones over it, in its turn among the opaque props.
class MarkProp : public vtkProp {
  public:
    static MarkProp* New();
    void draw_faint_ones() { faint_ = true; }
    void show(const std::vector<Mark>& marks);

    double* GetBounds() override { return nullptr; }
    int RenderOpaqueGeometry(vtkViewport* viewport) override;
    int RenderTranslucentPolygonalGeometry(vtkViewport* viewport) override;
    vtkTypeBool HasTranslucentPolygonalGeometry() override;
    void ReleaseGraphicsResources(vtkWindow* window) override;

  private:
    struct Drawn {
        vtkSmartPointer<vtkActor> actor;
        std::shared_ptr<const void> memory;
        bool shown = false, veil = false, surface = false;
    };
    int draw(vtkViewport* viewport, bool veils);

    bool faint_ = false;
    std::vector<Drawn> drawn_;  // as the marks
};

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
