// Groups blocks of the surface into VTK actors.
#include "apps/viewer/scene/surface_part.hpp"

#include <vtkNew.h>
#include <vtkOpenGLActor.h>
#include <vtkPolyDataMapper.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <utility>

#include "pictures/vtk/material.hpp"
#include "pictures/vtk/shapes.hpp"

namespace palpate::viewer {
namespace {

/// So many are drawn at once, and so many more at most.
constexpr std::size_t part_triangles = 50'000, most_part_triangles = 100'000;

/// Is not drawn after cancellation. On software OpenGL it waits until it is drawn: then at most one
/// part is drawn in vain, and the window's own pictures, which the same software draws, come
/// between two parts and not after all of them.
class InterruptibleActor : public vtkOpenGLActor {
  public:
    // As vtkStandardNewMacro has it, whose semicolons a pedantic compiler refuses.
    static InterruptibleActor* New() {
        auto* const made = new InterruptibleActor;
        made->InitializeObjectBase();
        return made;
    }
    int RenderOpaqueGeometry(vtkViewport* viewport) override {
        if (give_up && *give_up) return 0;
        const int drawn = vtkOpenGLActor::RenderOpaqueGeometry(viewport);
        if (waits) {
            vtkRenderer::SafeDownCast(viewport)->GetRenderWindow()->WaitForCompletion();
        }
        return drawn;
    }
    const std::atomic<bool>* give_up = nullptr;
    bool waits = false;
    std::shared_ptr<const RenderMesh> mesh;  // whose memory the mapper reads
};

vtkSmartPointer<vtkActor> actor_of(std::shared_ptr<const RenderMesh> mesh,
                                   const std::atomic<bool>& give_up, bool waits,
                                   vtkPlaneCollection* cut) {
    auto actor = vtkSmartPointer<InterruptibleActor>::New();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(pictures::mesh_of(mesh->positions, mesh->normals, mesh->triangles));
    mapper->ScalarVisibilityOff();
    mapper->StaticOn();
    mapper->SetClippingPlanes(cut);
    actor->SetMapper(mapper);
    actor->give_up = &give_up;
    actor->waits = waits;
    actor->mesh = std::move(mesh);
    pictures::look_matt(*actor);
    pictures::face_the_viewer(*actor);
    return actor;
}

}  // namespace

/// Which blocks go together: those that follow each other.
void SurfacePart::divide() {
    actors_.clear();
    std::size_t triangles = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const std::size_t more = blocks_[b] ? blocks_[b]->triangle_count() : 0;
        const bool full = triangles >= part_triangles ||
                          (triangles > 0 && triangles + more > most_part_triangles);
        if (b == 0 || full) {
            actors_.push_back({b, b, nullptr});
            triangles = 0;
        }
        actors_.back().last = b + 1;
        triangles += more;
    }
}

std::vector<vtkSmartPointer<vtkActor>> SurfacePart::show(const MeshBlocks& blocks) {
    std::vector<vtkSmartPointer<vtkActor>> gone;
    const auto drop = [&](Actor& actor) {
        if (actor.actor) gone.push_back(std::exchange(actor.actor, nullptr));
    };
    bool fits = blocks.size() == blocks_.size();
    for (Actor& actor : actors_) {
        if (!fits) break;
        const auto first = static_cast<std::ptrdiff_t>(actor.first);
        const auto last = static_cast<std::ptrdiff_t>(actor.last);
        if (!std::equal(blocks.begin() + first, blocks.begin() + last, blocks_.begin() + first)) {
            drop(actor);
        }
        const std::span part(blocks.data() + first, blocks.data() + last);
        fits = part.size() == 1 || triangle_count(part) <= most_part_triangles;
    }
    blocks_ = blocks;
    if (!fits) {
        for (Actor& actor : actors_) drop(actor);
        divide();
    }
    for (Actor& actor : actors_) {
        if (give_up_) break;
        if (actor.actor) continue;
        const std::span part(blocks_.data() + actor.first, blocks_.data() + actor.last);
        // The only one is drawn at once in any case.
        const bool waits = !hardware_ && actors_.size() > 1;
        if (auto mesh = joined(part)) {
            actor.actor = actor_of(std::move(mesh), give_up_, waits, cut_);
        }
    }
    return gone;
}

}  // namespace palpate::viewer
