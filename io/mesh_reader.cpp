// Reads meshes: the helper program gives vertices and triangles in shared memory.
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <system_error>

#include "io/helper/protocol.hpp"
#include "io/process/io_helper.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/mesh_file.hpp"

namespace palpate::io {
namespace {

SurfaceMesh mesh_from(const nlohmann::json& done, const Descriptor& memory) {
    const auto vertices = done.at("vertices").get<std::int64_t>();
    const auto triangles = done.at("triangles").get<std::int64_t>();
    const std::size_t bytes = mesh_bytes(vertices, triangles);
    struct stat status {};
    if (vertices < 0 || triangles <= 0 || fstat(memory.number(), &status) != 0 ||
        status.st_size != static_cast<off_t>(bytes)) {
        throw std::invalid_argument("the helper process gave too few vertices");
    }
    const std::shared_ptr<void> mapped = map_shared(memory, bytes);
    const auto* from = static_cast<const char*>(mapped.get());
    SurfaceMesh mesh;
    mesh.vertices.resize(static_cast<std::size_t>(vertices));
    mesh.triangles.resize(static_cast<std::size_t>(triangles));
    static_assert(sizeof(Vec3) == 24 && sizeof mesh.triangles[0] == 12);
    const std::size_t of_vertices = mesh.vertices.size() * sizeof(Vec3);
    std::memcpy(mesh.vertices.data()->data(), from, of_vertices);
    std::memcpy(mesh.triangles.data(), from + of_vertices, bytes - of_vertices);
    return mesh;
}

}  // namespace

SurfaceMesh read_mesh(const std::filesystem::path& path, const OnProgress& progress,
                      std::uint64_t most_memory) {
    check_readable(path);
    if (std::filesystem::is_directory(path)) {
        throw InputError(path.string() + ": is a folder; give a mesh file");
    }
    if (most_memory == 0) {
        most_memory = std::min(machine_memory(), own_memory(bytes_in(path), 64));
    }
    const nlohmann::json request = {{"caller", getpid()}, {"own_memory", most_memory}};
    return asked_of_helper(path, [&] {
        const Descriptor memory = shared_memory();
        const TimeLimits limits(0, bytes_in(path));
        const HelperJob job{
            io_helper,         {},       {"read-mesh", path.string(), line_from(request)},
            &memory,           progress, limits.wall_s,
            limits.processor_s};
        const HelperResult result = result_of(path, job);
        return mesh_from(result.done, memory);
    });
}

}  // namespace palpate::io
