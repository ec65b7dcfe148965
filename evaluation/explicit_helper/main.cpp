// palpate-explicit-helper: touches a surface that is extracted as a whole. It extracts the
// isosurface (VTK, flying edges), builds a bounding volume hierarchy on it (Embree), and intersects
// that with segments. wire.hpp defines questions and answers. It is a separate process, so that its
// memory can be measured.
#include <embree3/rtcore.h>
#include <sys/mman.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkType.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "evaluation/explicit_helper/wire.hpp"
#include "io/helper/child.hpp"
#include "io/helper/report.hpp"
#include "io/helper/vtk_type.hpp"

namespace palpate::evaluation {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Processor time of all threads of this process [s].
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

using Triangle = std::array<std::uint32_t, 3>;

/// The mesh as Embree reads it: VTK's own points, triangles in 32 bit.
struct Mesh {
    vtkSmartPointer<vtkPoints> points;
    std::size_t vertices = 0;
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
    mesh.points = surface->GetPoints();
    if (!mesh.points || mesh.points->GetNumberOfPoints() == 0) return mesh;
    if (mesh.points->GetDataType() != VTK_FLOAT) {
        throw std::runtime_error("VTK gave points that are not float");
    }
    mesh.vertices = static_cast<std::size_t>(mesh.points->GetNumberOfPoints());
    // Embree reads 16 bytes of the last vertex, too.
    mesh.points->GetData()->Resize(static_cast<vtkIdType>(mesh.vertices) + 1);
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

/// Embree's device, with the memory that its hierarchies take [bytes].
class Embree {
  public:
    Embree() : device_(rtcNewDevice(settings)) {
        if (!device_) throw std::runtime_error("Embree could not be started");
        rtcSetDeviceMemoryMonitorFunction(device_, count, &bytes_);
    }
    ~Embree() { rtcReleaseDevice(device_); }

    RTCDevice device() const { return device_; }
    double bytes() const { return static_cast<double>(bytes_.load()); }
    void check() const {
        if (rtcGetDeviceError(device_) == RTC_ERROR_NONE) return;
        throw std::runtime_error("Embree could not build its hierarchy");
    }

  private:
#ifdef PALPATE_SANITIZED
    static constexpr const char* settings = "threads=1";
#else
    static constexpr const char* settings = nullptr;  // all processors
#endif
    static bool count(void* bytes, ssize_t change, bool /*post*/) {
        *static_cast<std::atomic<std::int64_t>*>(bytes) += change;
        return true;
    }

    std::atomic<std::int64_t> bytes_ = 0;
    RTCDevice device_;
};

struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// The mesh has to outlive it. Robust, so that no ray slips through between two triangles.
Scene scene_of(const Mesh& mesh, RTCBuildQuality quality, const Embree& embree) {
    Scene scene(rtcNewScene(embree.device()));
    rtcSetSceneBuildQuality(scene.get(), quality);
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    if (!mesh.triangles.empty()) {
        const RTCGeometry geometry = rtcNewGeometry(embree.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(geometry, quality);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   mesh.points->GetVoidPointer(0), 0, 3 * sizeof(float),
                                   mesh.vertices);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(Triangle),
                                   mesh.triangles.size());
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene.get(), geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene.get());
    embree.check();
    return scene;
}

/// How far along the segment, 0 to 1, it first meets the mesh; NaN without a hit. Single precision,
/// as all of Embree.
double first_hit(RTCScene scene, const std::array<double, 3>& from,
                 const std::array<double, 3>& to) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(from[0]);
    query.ray.org_y = static_cast<float>(from[1]);
    query.ray.org_z = static_cast<float>(from[2]);
    query.ray.dir_x = static_cast<float>(to[0] - from[0]);
    query.ray.dir_y = static_cast<float>(to[1] - from[1]);
    query.ray.dir_z = static_cast<float>(to[2] - from[2]);
    query.ray.tfar = 1;
    query.ray.mask = 0xFFFFFFFF;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::quiet_NaN()
                                                       : double(query.ray.tfar);
}

/// Surface and hierarchy, and how long each took.
struct Explicit {
    Mesh mesh;
    Scene scene;
    double extraction_s = 0, tree_s = 0, cpu_s = 0;
};

/// With the quality that Embree builds fastest: the level may change again at any moment.
Explicit built(vtkImageData* image, double isovalue, const Embree& embree) {
    Explicit result;
    const double cpu = cpu_seconds();
    auto begin = Clock::now();
    auto surface = extracted(image, isovalue);
    result.extraction_s = seconds_since(begin);
    begin = Clock::now();
    result.mesh = mesh_of(surface);
    surface = nullptr;  // its cells; the points are kept
    result.scene = scene_of(result.mesh, RTC_BUILD_QUALITY_LOW, embree);
    result.tree_s = seconds_since(begin);
    result.cpu_s = cpu_seconds() - cpu;
    return result;
}

/// So that libraries and threads are loaded before time and memory are measured.
void warm_up(const Embree& embree) {
    std::vector<std::uint8_t> samples(512, 0);
    samples[219] = 255;
    ExplicitRequest tiny;
    tiny.geometry.size = {8, 8, 8};
    built(image_of(tiny, samples.data()), 100, embree);
}

/// Mean time of a segment's query [ns]; the hits go into the shared memory.
double ask(RTCScene scene, const ExplicitRequest& request, char* shared) {
    constexpr int passes = 5;
    const auto* const ends =
        reinterpret_cast<const std::array<double, 3>*>(shared + request.segments_at());
    auto* const hits = reinterpret_cast<double*>(shared + request.hits_at());
    std::vector<double> times;
    for (int pass = 0; pass < passes; ++pass) {
        const auto begin = Clock::now();
        for (std::size_t i = 0; i < request.segments; ++i) {
            hits[i] = first_hit(scene, ends[2 * i], ends[2 * i + 1]);
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
    const Embree embree;
    warm_up(embree);
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
        const Explicit result = built(image, request.isovalue, embree);
        extraction.push_back(result.extraction_s);
        tree.push_back(result.tree_s);
        cpu.push_back(result.cpu_s);
        if (repeat > 0) continue;
        cost.peak_bytes = memory("VmHWM") - before;
        cost.vertices = double(result.mesh.vertices);
        cost.triangles = double(result.mesh.triangles.size());
        cost.mesh_bytes = 12 * (cost.vertices + cost.triangles);
        cost.tree_bytes = embree.bytes();
        // Queries get the hierarchy that suits them best, as if it were refined meanwhile.
        const Scene fine = scene_of(result.mesh, RTC_BUILD_QUALITY_HIGH, embree);
        cost.query_ns =
            std::min(ask(result.scene.get(), request, shared), ask(fine.get(), request, shared));
    }
    cost.extraction_s = least(extraction);
    cost.tree_s = least(tree);
    cost.cpu_s = least(cpu);
    return cost;
}

std::string words_of(const std::exception& e) {
    const bool memory = dynamic_cast<const std::bad_alloc*>(&e) != nullptr;
    return memory ? "not enough memory for the whole isosurface; use a smaller volume" : e.what();
}

int run(int argc, char** argv) {
    const bool understood = argc == 3 && std::strcmp(argv[1], "extract") == 0;
    const auto work = [&] {
        const auto asked = nlohmann::json::parse(argv[2]);
        io::go_with_caller(asked.at("caller").get<pid_t>());
        return nlohmann::json(extract(request_from(asked)));
    };
    return io::helper_status("palpate-explicit-helper", understood, work, words_of);
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
