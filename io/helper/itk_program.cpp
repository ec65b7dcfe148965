// palpate-io-itk: writes NRRD, MetaImage and NIfTI.
#include "io/helper/jobs.hpp"

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-itk", {.write = &write_with_itk}, argc, argv);
}
