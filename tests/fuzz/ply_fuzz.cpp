// Any bytes are the vertices and faces of a PLY mesh, or a failure of one line.
#include <sys/mman.h>
#include <unistd.h>

#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/helper/decode.hpp"
#include "io/helper/ply_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate::io;
    const int file = memfd_create("mesh", MFD_CLOEXEC);
    if (file < 0) return 0;
    if (write(file, data, size) == static_cast<ssize_t>(size)) {
        try {
            const PolygonMesh mesh = ply_mesh("/proc/self/fd/" + std::to_string(file));
            // Nothing comes from nowhere: an entry takes a byte or more of the file.
            require(mesh.vertices.size() + mesh.faces.size() <= size);
        } catch (const Failure& failure) {
            require_one_line(failure.what());
        }
    }
    close(file);
    return 0;
}
