// palpate-io-itk: writes NRRD, MetaImage and NIfTI.
#include "io/helper/jobs.hpp"

namespace palpate::io {
namespace {

void write(const std::filesystem::path& path, const std::string& extension,
           const WrittenVolume& volume) {
    write_with_itk(path, extension, volume.geometry, volume.type, volume.samples,
                   volume.compress || extension == ".nii.gz");
}

}  // namespace
}  // namespace palpate::io

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-itk", {.write = &write}, argc, argv);
}
