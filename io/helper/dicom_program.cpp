// palpate-io-dicom: reads DICOM, by GDCM and ITK.
#include "io/helper/jobs.hpp"

namespace palpate::io {
namespace {

Result read_dicom(const Request& request) {
    return std::filesystem::is_directory(request.path) ? read_dicom_folder(request)
                                                       : read_dicom_file(request);
}

}  // namespace
}  // namespace palpate::io

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-dicom", {.read = &read_dicom}, argc, argv);
}
