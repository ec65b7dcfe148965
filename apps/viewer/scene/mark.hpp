// What is drawn over the picture of the scene, as plain values, and the prop that draws them.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkProp.h>
#include <vtkSmartPointer.h>

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

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

}  // namespace palpate::viewer
