// Joins meshes, leaves out their triangles, and passes those for files through VTK's decimation.
#include "apps/viewer/scene/render_mesh.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkDecimatePro.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

namespace palpate::viewer {

std::size_t triangle_count(std::span<const std::shared_ptr<const RenderMesh>> blocks) {
    std::size_t count = 0;
    for (const auto& block : blocks) count += block ? block->triangle_count() : 0;
    return count;
}

std::shared_ptr<const RenderMesh> joined(
    std::span<const std::shared_ptr<const RenderMesh>> blocks) {
    const auto there = [](const auto& block) { return block && !block->triangles.empty(); };
    const auto first = std::ranges::find_if(blocks, there);
    if (first == blocks.end()) return nullptr;
    if (std::none_of(first + 1, blocks.end(), there)) return *first;
    std::size_t vertices = 0;
    for (const auto& block : blocks) vertices += block ? block->vertex_count() : 0;
    RenderMesh all;
    all.positions.reserve(3 * vertices);
    all.normals.reserve(3 * vertices);
    all.triangles.reserve(3 * triangle_count(blocks));
    for (const auto& block : blocks) {
        if (!block) continue;
        const auto before = static_cast<std::int32_t>(all.vertex_count());
        all.positions.insert(all.positions.end(), block->positions.begin(), block->positions.end());
        all.normals.insert(all.normals.end(), block->normals.begin(), block->normals.end());
        for (const std::int32_t v : block->triangles) all.triangles.push_back(before + v);
    }
    return std::make_shared<const RenderMesh>(std::move(all));
}

std::shared_ptr<const RenderMesh> cut(const std::shared_ptr<const RenderMesh>& mesh,
                                      const PatchBounds& bounds, Keep keep) {
    if (!mesh) return nullptr;
    const Vec3 middle = physical_centre(bounds.grid);
    std::vector<Vec3> at(mesh->vertex_count());
    for (std::size_t v = 0; v < at.size(); ++v) {
        const float* const p = mesh->positions.data() + 3 * v;
        at[v] = index_from_physical(bounds.grid, middle + Vec3(p[0], p[1], p[2]));
    }
    const auto is_kept = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        if (keep == Keep::outside) return !bounds.has((a + b + c) / 3);
        const int inside = int(bounds.has(a)) + int(bounds.has(b)) + int(bounds.has(c));
        return keep == Keep::reaching_in ? inside > 0 : inside < 3;
    };
    std::vector<std::int32_t> kept;
    for (std::size_t t = 0; t < mesh->triangles.size(); t += 3) {
        const std::int32_t* const corner = mesh->triangles.data() + t;
        const auto place = [&](std::size_t i) { return at[static_cast<std::size_t>(corner[i])]; };
        if (is_kept(place(0), place(1), place(2))) kept.insert(kept.end(), corner, corner + 3);
    }
    if (kept.empty()) return nullptr;
    if (kept.size() == mesh->triangles.size()) return mesh;
    return std::make_shared<const RenderMesh>(
        RenderMesh{mesh->positions, mesh->normals, std::move(kept)});
}

namespace {

/// VTK is no place for exceptions: they wait here until it has ended.
struct Watch {
    const std::function<void(double)>& progress;
    std::exception_ptr thrown;

    static void look(vtkObject* caller, unsigned long, void* data, void*) {
        auto& watch = *static_cast<Watch*>(data);
        auto* filter = static_cast<vtkAlgorithm*>(caller);
        try {
            watch.progress(filter->GetProgress());
        } catch (...) {
            watch.thrown = std::current_exception();
            filter->SetAbortExecute(1);
        }
    }
};

vtkNew<vtkPolyData> poly_data(const SurfaceMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Vec3& v : mesh.vertices) points->InsertNextPoint(v.data());
    vtkNew<vtkCellArray> triangles;
    for (const auto& t : mesh.triangles) triangles->InsertNextCell({t[0], t[1], t[2]});
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(triangles);
    return data;
}

/// With the vertices that its triangles need.
SurfaceMesh mesh_of(vtkPolyData& data) {
    SurfaceMesh mesh;
    std::vector<std::int64_t> number(static_cast<std::size_t>(data.GetNumberOfPoints()), -1);
    vtkNew<vtkIdList> corners;
    for (vtkIdType t = 0; t < data.GetNumberOfPolys(); ++t) {
        data.GetPolys()->GetCellAtId(t, corners);
        auto& triangle = mesh.triangles.emplace_back();
        for (int c = 0; c < 3; ++c) {
            std::int64_t& known = number[static_cast<std::size_t>(corners->GetId(c))];
            if (known < 0) {
                known = static_cast<std::int64_t>(mesh.vertices.size());
                data.GetPoint(corners->GetId(c), mesh.vertices.emplace_back().data());
            }
            triangle[static_cast<std::size_t>(c)] = static_cast<std::uint32_t>(known);
        }
    }
    return mesh;
}

}  // namespace

SurfaceMesh decimated(const SurfaceMesh& mesh, std::size_t most_triangles,
                      const std::function<void(double)>& progress) {
    if (mesh.triangles.size() <= most_triangles) return mesh;
    constexpr double feature_degrees = 60;  // facets of the lattice are no features
    const vtkNew<vtkPolyData> data = poly_data(mesh);
    vtkNew<vtkDecimatePro> filter;
    filter->SetInputData(data);
    filter->SetTargetReduction(1 - double(most_triangles) / double(mesh.triangles.size()));
    filter->PreserveTopologyOn();
    filter->SetFeatureAngle(feature_degrees);
    Watch watch{progress, nullptr};
    vtkNew<vtkCallbackCommand> observer;
    observer->SetClientData(&watch);
    observer->SetCallback(&Watch::look);
    filter->AddObserver(vtkCommand::ProgressEvent, observer);
    filter->Update();
    if (watch.thrown) std::rethrow_exception(watch.thrown);
    return mesh_of(*filter->GetOutput());
}

}  // namespace palpate::viewer
