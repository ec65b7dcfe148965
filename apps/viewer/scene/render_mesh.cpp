// Simplifies meshes by vertex clustering (Rossignac and Borrel 1993), one pass for any mesh, and
// passes those for files through VTK's decimation.
#include "apps/viewer/scene/render_mesh.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkDecimatePro.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <vector>

namespace palpate::viewer {

namespace {

using Eigen::Map;
using Eigen::Vector3f;

Vector3f at(const std::vector<float>& values, std::size_t i) {
    return Map<const Vector3f>(values.data() + 3 * i);
}

/// From keys to numbers 0, 1, 2, ... in the order in which they come.
class Numbering {
  public:
    explicit Numbering(std::size_t most) {
        std::size_t room = 16;
        while (room < 2 * most) room *= 2;
        slots_.resize(room, {0, -1});
    }
    std::int32_t number_of(std::uint64_t key) {
        std::size_t i = (key * 0x9E3779B97F4A7C15u) >> 20 & (slots_.size() - 1);
        while (slots_[i].number >= 0 && slots_[i].key != key) i = (i + 1) & (slots_.size() - 1);
        if (slots_[i].number < 0) slots_[i] = {key, count_++};
        return slots_[i].number;
    }
    std::size_t count() const { return static_cast<std::size_t>(count_); }

  private:
    struct Slot {
        std::uint64_t key;
        std::int32_t number;
    };
    std::vector<Slot> slots_;
    std::int32_t count_ = 0;
};

/// The box of a grid, and the octant that the vertex faces: the two sides of a thin wall stay two.
std::uint64_t key_of(const Vector3f& p, const Vector3f& normal, float size, std::uint8_t seams) {
    constexpr int bits = 18;
    // Not 0: blocks that meet at a plane of symmetry must not differ by rounding.
    constexpr float edge_on = -0.01F;
    std::uint64_t key = seams;
    for (int a = 0; a < 3; ++a) {
        const auto box = static_cast<std::int64_t>(std::floor(p[a] / size)) + (1 << (bits - 1));
        key = key << (bits + 1) | (static_cast<std::uint64_t>(box & ((1 << bits) - 1)) << 1) |
              std::uint64_t(normal[a] < edge_on);
    }
    return key;
}

/// The triangles that are still ones, each once.
void add_triangles(const RenderMesh& mesh, const std::vector<std::int32_t>& cluster,
                   RenderMesh& result) {
    std::vector<std::array<std::int32_t, 3>> kept;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        const auto corner = [&](std::size_t i) {
            return cluster[static_cast<std::size_t>(mesh.triangles[t + i])];
        };
        const std::int32_t a = corner(0), b = corner(1), c = corner(2);
        if (a == b || b == c || a == c) continue;
        const std::int32_t least = std::min({a, b, c});  // first, and the turn stays
        kept.push_back(a == least ? std::array{a, b, c}
                                  : (b == least ? std::array{b, c, a} : std::array{c, a, b}));
    }
    std::ranges::sort(kept);
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const auto& t : kept) result.triangles.insert(result.triangles.end(), t.begin(), t.end());
}

}  // namespace

double area_of(const RenderMesh& mesh) {
    double twice = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        const auto corner = [&](std::size_t c) {
            return at(mesh.positions, static_cast<std::size_t>(mesh.triangles[t + c]));
        };
        const Vector3f a = corner(0);
        twice += (corner(1) - a).cross(corner(2) - a).norm();
    }
    return 0.5 * twice;
}

RenderMesh clustered(const RenderMesh& mesh, float size) {
    RenderMesh result;
    std::vector<std::int32_t> cluster(mesh.vertex_count());
    std::vector<Eigen::Vector3d> positions, normals;
    std::vector<int> members;
    Numbering numbering(std::min<std::size_t>(mesh.vertex_count(), 1u << 24));
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const Vector3f p = at(mesh.positions, v), n = at(mesh.normals, v);
        const std::uint8_t seams = mesh.seams.empty() ? 0 : mesh.seams[v];
        cluster[v] = numbering.number_of(key_of(p, n, size, seams));
        const auto c = static_cast<std::size_t>(cluster[v]);
        if (members.size() < numbering.count()) {
            members.push_back(0);
            positions.emplace_back(Eigen::Vector3d::Zero());
            normals.emplace_back(Eigen::Vector3d::Zero());
        }
        // In doubles, and it is the same in whatever order: neighbouring blocks meet.
        members[c] += 1;
        positions[c] += p.cast<double>();
        normals[c] += n.cast<double>();
    }
    result.positions.resize(3 * members.size());
    result.normals.resize(3 * members.size());
    for (std::size_t c = 0; c < members.size(); ++c) {
        Map<Vector3f>(result.positions.data() + 3 * c) = (positions[c] / members[c]).cast<float>();
        Map<Vector3f>(result.normals.data() + 3 * c) = normals[c].normalized().cast<float>();
    }
    add_triangles(mesh, cluster, result);
    return result;
}

RenderMesh simplified(const RenderMesh& mesh, std::size_t most_triangles) {
    if (mesh.triangle_count() <= most_triangles) return mesh;
    constexpr int most_attempts = 12;
    // About three triangles a box that the surface goes through.
    const double most = static_cast<double>(std::max<std::size_t>(most_triangles, 1));
    double size = std::sqrt(3 * area_of(mesh) / most);
    for (int attempt = 0;; ++attempt) {
        RenderMesh result = clustered(mesh, static_cast<float>(size));
        const auto count = static_cast<double>(result.triangle_count());
        if (count <= 1.25 * most || attempt == most_attempts) return result;
        size *= std::max(1.1, std::sqrt(count / most));
    }
}

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
