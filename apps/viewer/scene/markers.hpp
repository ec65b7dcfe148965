// Markers for hand, proxy, spring and force, which keep their size on the screen at any zoom; and
// the tetrahedra at the proxy.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/look.hpp"
#include "apps/viewer/scene/local.hpp"
#include "palpate/servo.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

/// Something drawn twice: with the scene, and faintly over it, so that it can be seen behind a
/// surface.
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

/// Each edge once.
void put_edges(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin);
/// The isosurface in the tetrahedra.
void put_patches(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin);
/// A disc, one and a half voxels [mm] wide, for each plane, and its normal as a line.
void put_planes(vtkPolyData& discs, vtkPolyData& normals, const std::vector<LocalTetrahedron>& all,
                const Vec3& origin, double voxel);

/// The part of a snapshot that is drawn.
struct Contact {
    Vec3 hip = Vec3::Zero(), scp = Vec3::Zero();  ///< [mm, physical]
    Vec3 force = Vec3::Zero();                    ///< [N] on the hand, physical axes
    bool as_tool = false;                         ///< hand and proxy are drawn as a tool, not here
    std::vector<LocalTetrahedron> lattice;
    double brush = 0;                         ///< [mm] its radius round the proxy; 0: none
    std::shared_ptr<const RenderMesh> patch;  ///< of the surface that is felt; null: none
};
/// Nothing while the device is not ready. The lattice only where it is asked for.
std::optional<Contact> contact_of(const std::optional<Snapshot>& snapshot, const Field& field,
                                  bool with_lattice);

/// Sizes in logical pixels, as in our pictures of 800 pixels in height.
inline constexpr double ball_radius_px = 8.8;
inline constexpr double newton_px = 100;
inline constexpr double shortest_arrow_px = 56, longest_arrow_px = 240;

class Markers {
  public:
    /// Draws into `solid`, and faintly into `overlay`, which is drawn over it, so that markers
    /// behind a surface can be seen.
    Markers(vtkRenderer& solid, vtkRenderer& overlay, const HandColours& colours);

    /// `origin` [mm, physical] of what is drawn; `pixel` [mm] is a logical pixel.
    void show(const std::optional<Contact>& contact, const Look& look, const Vec3& origin,
              double pixel, double voxel, const Colour& ink, double pixel_ratio);

  private:
    void show_probe(const Contact& contact, const Vec3& origin, double pixel);
    void show_lattice(const Contact& contact, const Look& look, const Vec3& origin, double voxel);

    void show_patch(const std::shared_ptr<const RenderMesh>& patch, const Colour& colour);

    vtkRenderer& solid_;
    std::shared_ptr<const RenderMesh> patch_;  // whose memory the actor reads
    vtkSmartPointer<vtkActor> patch_actor_;
    Twin hip_, scp_, spring_, arrow_, brush_, edges_, patches_, discs_, normals_;
};

}  // namespace palpate::viewer
