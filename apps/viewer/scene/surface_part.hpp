// The isosurface as VTK actors, each of several blocks and small enough to be drawn quickly.
#pragma once

#include <vtkActor.h>
#include <vtkPlaneCollection.h>
#include <vtkSmartPointer.h>

#include <atomic>
#include <vector>

#include "apps/viewer/scene/render_mesh.hpp"

namespace palpate::viewer {

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

    /// Shows other blocks. Actors whose blocks are the same stay; those that are no longer wanted
    /// are returned. If it is cancelled in the middle, the rest is made the next time.
    std::vector<vtkSmartPointer<vtkActor>> show(const MeshBlocks& blocks);
    const std::vector<Actor>& actors() const { return actors_; }

  private:
    void divide();

    const std::atomic<bool>& give_up_;
    bool hardware_;
    vtkSmartPointer<vtkPlaneCollection> cut_;
    MeshBlocks blocks_;
    std::vector<Actor> actors_;
};

}  // namespace palpate::viewer
