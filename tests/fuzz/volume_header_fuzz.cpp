// Any bytes are the header and the samples of a volume, or a failure of one line: our own readers
// and checks of NRRD, MetaImage, NIfTI and DICOM, which run before any library. The first byte
// chooses the format. volume_header_mutator.cpp makes inputs whose sizes and checksums are right.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/helper/dicom_check.hpp"
#include "io/helper/headers.hpp"

namespace {

using namespace palpate::io;

constexpr std::uint64_t memory_limit = 1 << 24;  // [bytes] a volume may have

/// Reads the header and, as far as our own code does it, the samples.
void read_volume(char format, const std::string& path) {
    Request request;
    request.path = path;
    request.memory_limit = memory_limit;
    if (format == 'd') {
        const DicomExtent extent = check_dicom(path);
        require(extent.rows >= 0 && extent.columns >= 0 && extent.frames >= 0);
        return;
    }
    VolumeHeader header = format == 'm'   ? meta_image_header(request)
                          : format == 'n' ? nifti_header(request)
                          : format == 'g' ? mgh_header(request)
                          : format == 'c' ? mrc_header(request)
                          : format == 'v' ? vtk_header(request)
                                          : nrrd_header(request);
    check_geometry(header.geometry);
    require(header.bytes() <= memory_limit * std::uint64_t(header.steps));
    std::uint64_t handed = 0;
    stream_samples(header, [&](std::span<const std::byte> bytes) {
        require(bytes.size() % size_of(header.stored) == 0);
        handed += bytes.size();
    });
    require(handed == header.bytes());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const int file = memfd_create("volume", MFD_CLOEXEC);
    if (file < 0) return 0;
    if (write(file, data + 1, size - 1) == static_cast<ssize_t>(size - 1)) {
        try {
            read_volume(static_cast<char>(data[0]), "/proc/self/fd/" + std::to_string(file));
        } catch (const Failure& failure) {
            require_one_line(failure.what());
        }
    }
    close(file);
    return 0;
}
