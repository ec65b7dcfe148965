// Actors of what stands still.
#include "apps/viewer/scene/bodies.hpp"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLActor.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

#include "pictures/vtk/material.hpp"

namespace palpate::viewer {
namespace {

constexpr std::size_t part_triangles = 50'000;

/// Not drawn any more once it was asked to give up. On software OpenGL it waits until it is drawn:
/// what is given up is then no more than this part, and the window's own pictures, which the same
/// software draws, come between two parts and not after them all.
class PatientActor : public vtkOpenGLActor {
  public:
    // As vtkStandardNewMacro has it, whose semicolons a pedantic compiler refuses.
    static PatientActor* New() {
        auto* const made = new PatientActor;
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
    std::shared_ptr<const DrawnMesh> mesh;  // whose memory the mapper reads
};

vtkSmartPointer<vtkFloatArray> vectors(const std::vector<float>& values) {
    auto array = vtkSmartPointer<vtkFloatArray>::New();
    array->SetNumberOfComponents(3);
    // VTK only reads them.
    array->SetArray(const_cast<float*>(values.data()), static_cast<vtkIdType>(values.size()), 1);
    return array;
}

vtkSmartPointer<vtkPolyData> polydata_of(const DrawnMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetData(vectors(mesh.positions));
    const auto normals = vectors(mesh.normals);
    normals->SetName("Normals");
    vtkNew<vtkTypeInt32Array> connectivity;
    connectivity->SetArray(const_cast<std::int32_t*>(mesh.triangles.data()),
                           static_cast<vtkIdType>(mesh.triangles.size()), 1);
    vtkNew<vtkCellArray> triangles;
    triangles->Use32BitStorage();
    triangles->SetData(3, connectivity);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(triangles);
    data->GetPointData()->SetNormals(normals);
    return data;
}

vtkSmartPointer<PatientActor> part_actor(std::shared_ptr<const DrawnMesh> part,
                                         const std::atomic<bool>& give_up) {
    auto actor = vtkSmartPointer<PatientActor>::New();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(polydata_of(*part));
    mapper->ScalarVisibilityOff();
    mapper->StaticOn();
    actor->SetMapper(mapper);
    actor->give_up = &give_up;
    actor->mesh = std::move(part);
    pictures::look_matt(*actor);
    pictures::face_the_viewer(*actor);
    return actor;
}

/// The grey of a plane at a fractional index of `axis`, between the two slices beside it.
vtkSmartPointer<vtkImageData> slice_image(const Volume& volume, int axis, double where) {
    const Index3& size = volume.geometry().size;
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    const int low = std::clamp(static_cast<int>(std::floor(where)), 0, size[axis] - 1);
    const int high = std::min(low + 1, size[axis] - 1);
    const double t = std::clamp(where - low, 0.0, 1.0), scale = 255 / volume.range();
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(size[u], size[v], 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    auto* out = static_cast<unsigned char*>(image->GetScalarPointer());
    Index3 a = Index3::Zero(), b = Index3::Zero();
    a[axis] = low;
    b[axis] = high;
    for (int j = 0; j < size[v]; ++j) {
        for (int i = 0; i < size[u]; ++i) {
            a[u] = b[u] = i;
            a[v] = b[v] = j;
            const double value = (1 - t) * volume.sample(a) + t * volume.sample(b);
            *out++ = static_cast<unsigned char>(
                std::lround(std::clamp(scale * (value - volume.minimum()), 0.0, 255.0)));
        }
    }
    return image;
}

vtkSmartPointer<vtkActor> slice_actor(const Volume& volume, int axis, double where) {
    const Geometry& g = volume.geometry();
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    const Vec3 middle = physical_centre(g);
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> coordinates;
    coordinates->SetNumberOfComponents(2);
    // Texels are samples: the outermost are half a texel from the texture's edge.
    const auto texel = [&](int along, int side) {
        return (side ? g.size[along] - 0.5 : 0.5) / g.size[along];
    };
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        Vec3 index;
        index[axis] = where;
        index[u] = i * (g.size[u] - 1);
        index[v] = j * (g.size[v] - 1);
        points->InsertNextPoint(Vec3(physical_from_index(g, index) - middle).data());
        coordinates->InsertNextTuple2(texel(u, i), texel(v, j));
    }
    vtkNew<vtkCellArray> quad;
    const vtkIdType corners[] = {0, 1, 2, 3};
    quad->InsertNextCell(4, corners);
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(quad);
    data->GetPointData()->SetTCoords(coordinates);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    vtkNew<vtkTexture> texture;
    texture->SetInputData(slice_image(volume, axis, where));
    texture->SetColorModeToDirectScalars();
    texture->InterpolateOn();
    texture->RepeatOff();
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->SetTexture(texture);
    actor->GetProperty()->LightingOff();
    return actor;
}

}  // namespace

std::vector<vtkSmartPointer<vtkActor>> mesh_actors(const std::shared_ptr<const DrawnMesh>& mesh,
                                                   bool hardware,
                                                   const std::atomic<bool>& give_up) {
    if (!mesh || mesh->triangles.empty()) return {};
    std::vector<vtkSmartPointer<PatientActor>> actors;
    const std::size_t count = mesh->triangle_count();
    if (hardware || count <= 2 * part_triangles) return {part_actor(mesh, give_up)};
    for (std::size_t first = 0; first < count && !give_up; first += part_triangles) {
        const std::size_t last = std::min(first + part_triangles, count);
        actors.push_back(
            part_actor(std::make_shared<const DrawnMesh>(part_of(*mesh, first, last)), give_up));
        actors.back()->waits = true;
    }
    return {actors.begin(), actors.end()};
}

std::array<vtkSmartPointer<vtkActor>, 3> slice_actors(const Volume& volume, const Vec3& crosshair) {
    const Geometry& g = volume.geometry();
    const Vec3 index = index_from_physical(g, crosshair);
    std::array<vtkSmartPointer<vtkActor>, 3> actors;
    for (int axis = 0; axis < 3; ++axis) {
        const double where = std::clamp(index[axis], 0.0, double(g.size[axis] - 1));
        actors[static_cast<std::size_t>(axis)] = slice_actor(volume, axis, where);
    }
    return actors;
}

vtkSmartPointer<vtkActor> box_actor(const Geometry& geometry) {
    const Vec3 middle = physical_centre(geometry);
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 index(corner & 1 ? geometry.size[0] - 1 : 0,
                         corner & 2 ? geometry.size[1] - 1 : 0,
                         corner & 4 ? geometry.size[2] - 1 : 0);
        points->InsertNextPoint(Vec3(physical_from_index(geometry, index) - middle).data());
        for (int axis = 0; axis < 3; ++axis) {
            if (corner >> axis & 1) continue;
            const vtkIdType ends[] = {corner, corner | 1 << axis};
            lines->InsertNextCell(2, ends);
        }
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetLines(lines);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    return actor;
}

}  // namespace palpate::viewer
