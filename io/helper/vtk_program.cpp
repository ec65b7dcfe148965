// palpate-io-vtk: reads and writes VTI, reads meshes.
#include "io/helper/jobs.hpp"

namespace palpate::io {
namespace {

void write(const std::filesystem::path& path, const std::string&, const WrittenVolume& volume) {
    write_vti(path, volume.geometry, volume.type, volume.samples, volume.compress);
}

}  // namespace
}  // namespace palpate::io

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-vtk", {.read = &read_vti, .read_mesh = &read_mesh, .write = &write}, argc,
          argv);
}
