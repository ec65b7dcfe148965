// palpate-io-images: reads and writes TIFF, reads images in chunks of HDF5.
#include "io/helper/jobs.hpp"

namespace palpate::io {
namespace {

Result read_tiff(const Request& request) {
    return std::filesystem::is_directory(request.path) ? read_tiff_folder(request)
                                                       : read_tiff_file(request);
}

ChunkedImage describe(const std::filesystem::path& path, int channel, int time) {
    return looks_like_tiff(path) ? tiff_image(path, channel, time)
                                 : hdf5_image(path, channel, time);
}

void places(const std::filesystem::path& path, const ChunkBox& box, std::span<ChunkPlace> places) {
    looks_like_tiff(path) ? tiff_places(path, box, places) : hdf5_places(path, box, places);
}

void write(const std::filesystem::path& path, const std::string&, const WrittenVolume& volume) {
    write_tiff(path, volume.geometry, volume.type, volume.samples, volume.compress);
}

}  // namespace
}  // namespace palpate::io

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-images",
          {.read = &read_tiff, .describe = &describe, .places = &places, .write = &write}, argc,
          argv);
}
