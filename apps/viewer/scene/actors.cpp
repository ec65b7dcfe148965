// Makes the actors and mappers of surface, volume, slices and outline.
#include "apps/viewer/scene/actors.hpp"

#include <vtkAOSDataArrayTemplate.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageActor.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkOpenGLActor.h>
#include <vtkOutlineSource.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/viewer/model/sample_block.hpp"
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

std::vector<vtkSmartPointer<vtkActor>> SurfacePart::show(const MeshBlocks& blocks,
                                                         const std::optional<PatchBounds>& bounds,
                                                         Keep keep) {
    std::vector<vtkSmartPointer<vtkActor>> gone;
    const auto drop = [&](Actor& actor) {
        if (actor.actor) gone.push_back(std::exchange(actor.actor, nullptr));
    };
    bool fits = blocks.size() == blocks_.size() && bounds == bounds_;
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
    bounds_ = bounds;
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
        auto mesh = joined(part);
        if (mesh && bounds) mesh = cut(mesh, *bounds, keep);
        if (mesh) {
            actor.actor = actor_of(std::move(mesh), give_up_, waits, cut_);
        }
    }
    return gone;
}

namespace {

vtkSmartPointer<vtkDataArray> samples_of(const Volume& volume) {
    return with_type(volume.type(), [&](auto zero) -> vtkSmartPointer<vtkDataArray> {
        using T = decltype(zero);
        auto array = vtkSmartPointer<vtkAOSDataArrayTemplate<T>>::New();
        const auto samples = volume.samples<T>();
        // VTK only reads them.
        array->SetArray(const_cast<T*>(samples.data()), static_cast<vtkIdType>(samples.size()), 1);
        return array;
    });
}

/// Spacing is the image's, direction (mirrored, too) and place are the prop's: mappers honour
/// those.
vtkSmartPointer<vtkMatrix4x4> placed(const Geometry& g, const Vec3& origin) {
    auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            matrix->SetElement(row, column, g.direction(row, column));
        }
        matrix->SetElement(row, 3, g.origin[row] - origin[row]);
    }
    return matrix;
}

/// From black at the first level to white at the last, opaque but for what is as good as empty.
std::vector<ControlPoint> projected(const std::vector<ControlPoint>& points) {
    constexpr double empty = 0.03;
    const double low = points.front().level, high = points.back().level;
    return {{low, {0, 0, 0}, 0},
            {std::lerp(low, high, empty), {empty, empty, empty}, 1},
            {high, {1, 1, 1}, 1}};
}

}  // namespace

VolumePart::VolumePart(const Volume& volume, const Vec3& origin, bool hardware)
    : volume_(volume), prop_(vtkSmartPointer<vtkVolume>::New()), hardware_(hardware) {
    const Geometry& g = volume.geometry();
    vtkNew<vtkImageData> image;
    image->SetDimensions(g.size[0], g.size[1], g.size[2]);
    image->SetSpacing(g.spacing[0], g.spacing[1], g.spacing[2]);
    image->GetPointData()->SetScalars(samples_of(volume_));
    if (hardware) {
        auto mapper = vtkSmartPointer<vtkGPUVolumeRayCastMapper>::New();
        mapper->AutoAdjustSampleDistancesOff();
        mapper->UseJitteringOn();
        mapper_ = mapper;
    } else {
        auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
        mapper->AutoAdjustSampleDistancesOff();
        mapper->LockSampleDistanceToInputSpacingOff();
        mapper_ = mapper;
    }
    mapper_->SetInputData(image);
    mapper_->SetBlendModeToComposite();
    prop_->SetMapper(mapper_);
    prop_->SetUserMatrix(placed(g, origin));
    vtkVolumeProperty* const p = prop_->GetProperty();
    p->SetInterpolationTypeToLinear();
    p->SetAmbient(0.25);
    p->SetDiffuse(0.8);
    p->SetSpecular(0.12);
    p->SetSpecularPower(20);
}

void VolumePart::set_look(const Look& look, double layer) {
    vtkVolumeProperty* const p = prop_->GetProperty();
    const bool shading = look.shading && !look.maximum;
    if (p->GetShade() != int(shading)) p->SetShade(shading);
    if (look.transfer == transfer_ && look.maximum == maximum_ && layer == layer_) return;
    transfer_ = look.transfer;
    maximum_ = look.maximum;
    layer_ = layer;
    maximum_ ? mapper_->SetBlendModeToMaximumIntensity() : mapper_->SetBlendModeToComposite();
    vtkNew<vtkColorTransferFunction> colour;
    vtkNew<vtkPiecewiseFunction> opacity;
    const std::vector<ControlPoint> points =
        maximum_ ? projected(transfer_.points) : transfer_.points;
    for (const ControlPoint& point : points) {
        colour->AddRGBPoint(point.level, point.colour.red, point.colour.green, point.colour.blue);
        opacity->AddPoint(point.level, point.opacity);
    }
    p->SetColor(colour);
    p->SetScalarOpacity(opacity);
    p->SetScalarOpacityUnitDistance(layer);
}

void VolumePart::set_fineness(double pixels, double step) {
    const auto set = [&](auto* mapper) {
        mapper->SetImageSampleDistance(static_cast<float>(pixels));
        mapper->SetSampleDistance(static_cast<float>(step));
    };
    if (hardware_) {
        set(vtkGPUVolumeRayCastMapper::SafeDownCast(mapper_));
    } else {
        set(vtkFixedPointVolumeRayCastMapper::SafeDownCast(mapper_));
    }
}

namespace {

/// Greys that cannot be told from black.
constexpr unsigned char black = 8;

/// The grey of a plane at a fractional index of `axis`, between the two slices beside it; null
/// where it is all black: such a plane only hides what is behind it.
vtkSmartPointer<vtkImageData> slice_image(const Field& field, int axis, double where) {
    const Index3& size = field.geometry().size;
    const int low = std::clamp(static_cast<int>(std::floor(where)), 0, size[axis] - 1);
    const Samples& samples = field.samples();
    const double span = samples.maximum() - samples.minimum(), range = span > 0 ? span : 1;
    const double t = std::clamp(where - low, 0.0, 1.0), scale = 255 / range;
    const auto layer = [&](int number) {
        Index3 from = Index3::Zero(), count = size;
        from[axis] = std::min(number, size[axis] - 1);
        count[axis] = 1;
        return sample_block(field, from, count);
    };
    const std::vector<float> before = layer(low), after = layer(low + 1);
    auto image = vtkSmartPointer<vtkImageData>::New();
    Index3 sides = size;
    sides[axis] = 1;
    const Vec3& spacing = field.geometry().spacing;
    image->SetDimensions(sides.data());
    image->SetSpacing(spacing[0], spacing[1], spacing[2]);
    image->SetOrigin(Vec3(where * spacing[axis] * Vec3::Unit(axis)).data());
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    auto* out = static_cast<unsigned char*>(image->GetScalarPointer());
    bool empty = true;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const double value = (1 - t) * double(before[i]) + t * double(after[i]);
        out[i] = static_cast<unsigned char>(
            std::lround(std::clamp(scale * (value - samples.minimum()), 0.0, 255.0)));
        empty = empty && out[i] <= black;
    }
    return empty ? nullptr : image;
}

vtkSmartPointer<vtkProp> slice_actor(const Field& field, int axis, double where) {
    auto actor = vtkSmartPointer<vtkImageActor>::New();
    const vtkSmartPointer<vtkImageData> image = slice_image(field, axis, where);
    actor->SetVisibility(image != nullptr);
    if (!image) return actor;
    actor->SetInputData(image);
    actor->SetDisplayExtent(image->GetExtent());
    actor->SetUserMatrix(placed(field.geometry(), physical_centre(field.geometry())));
    return actor;
}

}  // namespace

std::array<vtkSmartPointer<vtkProp>, 3> slice_actors(const Field& field, const Vec3& crosshair) {
    const Geometry& g = field.geometry();
    const Vec3 index = index_from_physical(g, crosshair);
    std::array<vtkSmartPointer<vtkProp>, 3> actors;
    for (int axis = 0; axis < 3; ++axis) {
        const double where = std::clamp(index[axis], 0.0, double(g.size[axis] - 1));
        actors[static_cast<std::size_t>(axis)] = slice_actor(field, axis, where);
    }
    return actors;
}

vtkSmartPointer<vtkActor> box_actor(const Geometry& geometry, int beyond) {
    const Vec3 middle = physical_centre(geometry);
    std::array<double, 24> corners{};
    for (int c = 0; c < 8; ++c) {
        const Index3 side(c & 1, c >> 1 & 1, c >> 2 & 1);
        const Index3 span = geometry.size + Index3::Constant(2 * beyond - 1);
        const Index3 index = side.cwiseProduct(span) - Index3::Constant(beyond);
        const Vec3 corner = physical_from_index(geometry, index.cast<double>()) - middle;
        std::ranges::copy(corner, corners.begin() + 3 * c);
    }
    vtkNew<vtkOutlineSource> source;
    source->SetBoxTypeToOriented();
    source->SetCorners(corners.data());
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(source->GetOutputPort());
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    return actor;
}

}  // namespace palpate::viewer
