// Passes a mesh through VTK's decimation.
#include "apps/viewer/scene/decimated.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkDecimatePro.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <exception>
#include <vector>

namespace palpate::viewer {
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
