// palpate-explicit-helper: the explicit way to a surface that can be touched. Extracts the whole
// isosurface (VTK, flying edges), builds a tree of boxes on it, and asks that for segments;
// wire.hpp says what crosses. A process of its own, so that its memory is nobody else's.
#include <sys/mman.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkType.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include "evaluation/scaling/explicit_helper/aabb_tree.hpp"
#include "evaluation/scaling/explicit_helper/wire.hpp"
#include "io/helper/child.hpp"
#include "io/helper/report.hpp"
#include "io/helper/vtk_type.hpp"

namespace palpate::evaluation {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Of all threads of this process [s].
double cpu_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

/// Other programs only ever make it slower.
double least(const std::vector<double>& values) {
    return *std::min_element(values.begin(), values.end());
}

/// VmRSS (now) or VmHWM (peak) of this process [bytes].
double memory(const char* what) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        double kibibytes = 0;
        if (word == std::string(what) + ":" && status >> kibibytes) return kibibytes * 1024;
    }
    throw std::runtime_error("/proc/self/status does not tell how much memory is used");
}

/// From here on VmHWM is the peak since now.
void forget_peak() {
    std::ofstream("/proc/self/clear_refs") << 5;
}

/// A view of the samples; nothing is copied.
vtkSmartPointer<vtkImageData> image_of(const ExplicitRequest& request, void* samples) {
    const Geometry& geometry = request.geometry;
    auto array = vtkSmartPointer<vtkDataArray>::Take(
        vtkDataArray::CreateDataArray(io::vtk_type(request.type)));
    constexpr int keep = 1;  // it is not VTK's to free
    array->SetVoidArray(samples, sample_count(geometry), keep);
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(geometry.size.data());
    image->SetSpacing(geometry.spacing.data());
    image->GetPointData()->SetScalars(array);
    return image;
}

/// The mesh as the tree wants it: VTK's own points, triangles in 32 bit.
struct Mesh {
    vtkSmartPointer<vtkPoints> owner;
    std::span<const Point3> points;
    std::vector<Triangle> triangles;
};

vtkSmartPointer<vtkPolyData> extracted(vtkImageData* image, double isovalue) {
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputData(image);
    filter->SetValue(0, isovalue);
    filter->ComputeNormalsOff();  // the least that it can do
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
    filter->Update();
    return filter->GetOutput();
}

Mesh mesh_of(vtkPolyData* surface) {
    Mesh mesh;
    mesh.owner = surface->GetPoints();
    if (!mesh.owner || mesh.owner->GetNumberOfPoints() == 0) return mesh;
    auto* const coordinates = vtkFloatArray::SafeDownCast(mesh.owner->GetData());
    if (!coordinates) throw std::runtime_error("VTK gave points that are not float");
    mesh.points = {reinterpret_cast<const Point3*>(coordinates->GetPointer(0)),
                   static_cast<std::size_t>(mesh.owner->GetNumberOfPoints())};
    vtkCellArray* const cells = surface->GetPolys();
    mesh.triangles.resize(static_cast<std::size_t>(cells->GetNumberOfCells()));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        vtkIdType count = 0;
        const vtkIdType* corners = nullptr;
        cells->GetCellAtId(static_cast<vtkIdType>(i), count, corners);
        if (count != 3) throw std::runtime_error("VTK gave a cell that is not a triangle");
        for (std::size_t c = 0; c < 3; ++c) {
            mesh.triangles[i][c] = static_cast<std::uint32_t>(corners[c]);
        }
    }
    return mesh;
}

/// Surface and tree, and how long each took.
struct Explicit {
    Mesh mesh;
    std::optional<AabbTree> tree;
    double extraction_s = 0, tree_s = 0, cpu_s = 0;
};

Explicit built(vtkImageData* image, double isovalue) {
    Explicit result;
    const double cpu = cpu_seconds();
    auto begin = Clock::now();
    auto surface = extracted(image, isovalue);
    result.extraction_s = seconds_since(begin);
    begin = Clock::now();
    result.mesh = mesh_of(surface);
    surface = nullptr;  // its cells; the points are kept
    result.tree.emplace(result.mesh.points, result.mesh.triangles);
    result.tree_s = seconds_since(begin);
    result.cpu_s = cpu_seconds() - cpu;
    return result;
}

/// So that libraries and threads are loaded before memory is measured.
void warm_up() {
    std::vector<std::uint8_t> samples(512, 0);
    samples[219] = 255;
    ExplicitRequest tiny;
    tiny.geometry.size = {8, 8, 8};
    built(image_of(tiny, samples.data()), 100);
}

/// Mean time of a segment's query [ns]; the hits go into the shared memory.
double ask(const AabbTree& tree, const ExplicitRequest& request, char* shared) {
    constexpr int passes = 5;
    const auto* const ends =
        reinterpret_cast<const std::array<double, 3>*>(shared + request.segments_at());
    auto* const hits = reinterpret_cast<double*>(shared + request.hits_at());
    std::vector<double> times;
    for (int pass = 0; pass < passes; ++pass) {
        const auto begin = Clock::now();
        for (std::size_t i = 0; i < request.segments; ++i) {
            hits[i] = tree.first_hit(ends[2 * i], ends[2 * i + 1]);
        }
        times.push_back(seconds_since(begin) * 1e9 /
                        double(std::max<std::size_t>(1, request.segments)));
    }
    return least(times);
}

ExplicitCost extract(const ExplicitRequest& request) {
    check(request.geometry);
    void* const mapped = mmap(nullptr, request.bytes(), PROT_READ | PROT_WRITE, MAP_SHARED,
                              io::samples_descriptor, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    auto* const shared = static_cast<char*>(mapped);
    warm_up();
    for (std::size_t i = 0; i < request.bytes();
         i += 4096) {  // a page: counted before, not as growth
        static_cast<void>(static_cast<volatile char*>(shared)[i]);
    }
    const auto image = image_of(request, shared);
    forget_peak();
    const double before = memory("VmRSS");
    ExplicitCost cost;
    std::vector<double> extraction, tree, cpu;
    for (int repeat = 0; repeat < request.repeats; ++repeat) {
        io::report({{"progress", double(repeat) / request.repeats}});
        const Explicit result = built(image, request.isovalue);
        extraction.push_back(result.extraction_s);
        tree.push_back(result.tree_s);
        cpu.push_back(result.cpu_s);
        if (repeat > 0) continue;
        cost.peak_bytes = memory("VmHWM") - before;
        cost.vertices = static_cast<std::int64_t>(result.mesh.points.size());
        cost.triangles = static_cast<std::int64_t>(result.mesh.triangles.size());
        cost.mesh_bytes = double(result.mesh.points.size_bytes()) +
                          double(result.mesh.triangles.size() * sizeof(Triangle));
        cost.tree_bytes = double(result.tree->bytes());
        cost.query_ns = ask(*result.tree, request, shared);
    }
    cost.extraction_s = least(extraction);
    cost.tree_s = least(tree);
    cost.cpu_s = least(cpu);
    return cost;
}

int run(int argc, char** argv) {
    if (argc != 3 || std::strcmp(argv[1], "extract") != 0) {
        std::fputs(
            "palpate-explicit-helper is started by palpate; there is nothing to do by hand\n",
            stderr);
        return 2;
    }
    try {
        const auto asked = nlohmann::json::parse(argv[2]);
        io::go_with_caller(asked.at("caller").get<pid_t>());
        io::report({{"done", json_from(extract(request_from(asked)))}});
        return 0;
    } catch (const std::bad_alloc&) {
        io::report({{"error", "not enough memory for the whole isosurface; use a smaller volume"}});
    } catch (const std::exception& e) {
        io::report({{"error", e.what()}});
    }
    return 1;
}

}  // namespace
}  // namespace palpate::evaluation

int main(int argc, char** argv) {
#ifdef PALPATE_SANITIZED
    // A thread sanitizer does not see how TBB, which was built without it, orders its threads.
    setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 1);
#endif
    const int status = palpate::evaluation::run(argc, argv);
    std::_Exit(status);  // no destructors of libraries
}
