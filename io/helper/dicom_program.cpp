// palpate-io-dicom: reads DICOM, by GDCM and ITK.
#include "io/helper/jobs.hpp"

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-dicom", {.read = &read_dicom}, argc, argv);
}
