// Makes the actors of slices and grid outline.
#include "apps/viewer/scene/static_actors.hpp"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOutlineSource.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkTexture.h>

#include <algorithm>
#include <cmath>

#include "apps/viewer/model/sample_block.hpp"

namespace palpate::viewer {
namespace {

/// Greys that cannot be told from black.
constexpr unsigned char black = 8;

/// The grey of a plane at a fractional index of `axis`, between the two slices beside it; null
/// where it is all black: such a plane only hides what is behind it.
vtkSmartPointer<vtkImageData> slice_image(const Field& field, int axis, double where) {
    const Index3& size = field.geometry().size;
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
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
    image->SetDimensions(size[u], size[v], 1);
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

vtkSmartPointer<vtkActor> slice_actor(const Field& field, int axis, double where) {
    const Geometry& g = field.geometry();
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
    const vtkSmartPointer<vtkImageData> image = slice_image(field, axis, where);
    texture->SetInputData(image);
    texture->SetColorModeToDirectScalars();
    texture->InterpolateOn();
    texture->RepeatOff();
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->SetTexture(texture);
    actor->GetProperty()->LightingOff();
    actor->SetVisibility(image != nullptr);
    return actor;
}

}  // namespace

std::array<vtkSmartPointer<vtkActor>, 3> slice_actors(const Field& field, const Vec3& crosshair) {
    const Geometry& g = field.geometry();
    const Vec3 index = index_from_physical(g, crosshair);
    std::array<vtkSmartPointer<vtkActor>, 3> actors;
    for (int axis = 0; axis < 3; ++axis) {
        const double where = std::clamp(index[axis], 0.0, double(g.size[axis] - 1));
        actors[static_cast<std::size_t>(axis)] = slice_actor(field, axis, where);
    }
    return actors;
}

vtkSmartPointer<vtkActor> box_actor(const Geometry& geometry) {
    const Vec3 middle = physical_centre(geometry);
    std::array<double, 24> corners{};
    for (int c = 0; c < 8; ++c) {
        const Index3 side(c & 1, c >> 1 & 1, c >> 2 & 1);
        const Index3 index = side.cwiseProduct(geometry.size - Index3::Ones());
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
