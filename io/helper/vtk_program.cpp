// palpate-io-vtk: reads and writes VTI, reads meshes.
#include "io/helper/jobs.hpp"

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-vtk", {.read = &read_vti, .read_mesh = &read_mesh, .write = &write_vti}, argc,
          argv);
}
