// VTK's parts of the static scene: surface, volume, slices in the scene and the grid's outline.
#pragma once

#include <vtkActor.h>
#include <vtkPlaneCollection.h>
#include <vtkProp.h>
#include <vtkSmartPointer.h>
#include <vtkVolume.h>
#include <vtkVolumeMapper.h>

#include <array>
#include <atomic>
#include <optional>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/field.hpp"
#include "palpate/volume.hpp"

namespace palpate::viewer {

/// The isosurface as VTK actors, each of several blocks and small enough to be drawn quickly.
class SurfacePart {
  public:
    struct Actor {
        std::size_t first, last;          ///< its blocks, the last not included
        vtkSmartPointer<vtkActor> actor;  ///< null where these have no triangle
    };

    /// While `give_up` is true nothing is drawn; must outlive the actors. `hardware`: drawn by
    /// graphics hardware. `cut`: planes beyond which nothing is drawn.
    SurfacePart(const std::atomic<bool>& give_up, bool hardware, vtkPlaneCollection* cut)
        : give_up_(give_up), hardware_(hardware), cut_(cut) {}

    /// Shows other blocks, with bounds only the triangles that cut() keeps. Actors whose blocks are
    /// the same stay; those that are no longer wanted are returned. If it is cancelled in the
    /// middle, the rest is made the next time.
    std::vector<vtkSmartPointer<vtkActor>> show(const MeshBlocks& blocks,
                                                const std::optional<PatchBounds>& bounds = {},
                                                Keep keep = Keep::outside);
    const std::vector<Actor>& actors() const { return actors_; }

  private:
    void divide();

    const std::atomic<bool>& give_up_;
    bool hardware_;
    vtkSmartPointer<vtkPlaneCollection> cut_;
    MeshBlocks blocks_;
    std::optional<PatchBounds> bounds_;
    std::vector<Actor> actors_;
};

/// One volume in VTK's terms. The samples are not copied; the volume is held as long.
class VolumePart {
  public:
    /// `origin` [mm, physical] becomes the origin of what is drawn.
    VolumePart(const Volume& volume, const Vec3& origin, bool hardware);

    vtkVolume* prop() const { return prop_; }
    /// True if this is the part for these samples.
    bool shows(const Volume& volume) const { return volume.data() == volume_.data(); }
    /// Opacities are for a layer as thick as `layer` [mm]. A maximum intensity projection goes from
    /// black at the transfer function's first level to white at its last.
    void set_look(const Look& look, double layer);
    /// The distance of the pixels that are cast (1: all), and how far apart the samples along
    /// a ray are [mm].
    void set_fineness(double pixels, double step);

  private:
    Volume volume_;
    vtkSmartPointer<vtkVolume> prop_;
    vtkSmartPointer<vtkVolumeMapper> mapper_;
    TransferFunction transfer_;
    bool maximum_ = false;
    double layer_ = 0;
    bool hardware_;
};

/// Three planes of the grid through a point, grey from the least sample to the greatest, at the
/// field's moment; hidden where all of it is as good as black. Positions from the middle of the
/// grid.
std::array<vtkSmartPointer<vtkProp>, 3> slice_actors(const Field& field, const Vec3& crosshair);

/// The twelve edges of the box whose corners lie so many samples beyond the outermost ones.
vtkSmartPointer<vtkActor> box_actor(const Geometry& geometry, int beyond);

}  // namespace palpate::viewer
