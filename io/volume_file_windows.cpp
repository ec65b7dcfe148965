// Reads and writes volumes without the formats' libraries, which are not built for Windows: raw,
// NRRD and MetaImage are read by our own readers, in this process.
#include <algorithm>
#include <cctype>

#include "io/helper/in_process.hpp"
#include "io/helper/readers.hpp"
#include "io/process/io_helper.hpp"
#include "io/raw_file.hpp"
#include "io/system/system.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::io {
namespace {

Result read_with_header(const Request& request) {
    ReadHeader* const reader = header_reader(request.path);
    if (reader && reader != &nifti_header) return read_by_header(request);
    throw Failure(
        "Palpate for Windows reads NRRD, MetaImage and raw volumes; convert it to one of them, for "
        "example with `palpate convert` on Linux");
}

}  // namespace

VolumeFile read_volume(const std::filesystem::path& path, const ReadOptions& options) {
    check_readable(path);
    ReadOptions limited = options;
    if (limited.memory_limit_bytes == 0) limited.memory_limit_bytes = machine_memory();
    if (options.raw) {
        if (std::filesystem::is_directory(path)) {
            throw InputError(path.string() + ": is a folder; dims and type are for one file");
        }
        return read_raw(path, limited);
    }
    Request request;
    request.path = path;
    request.time_step = options.time_step;
    request.memory_limit = limited.memory_limit_bytes;
    request.grid = {options.spacing, options.orientation};
    return read_in_process(request, options.progress, &read_with_header);
}

void write_volume(const Volume& volume, const std::filesystem::path& path,
                  const WriteOptions& options) {
    const std::string problem = why_not_written(path, volume.geometry());
    if (!problem.empty()) throw OutputError(problem);
    if (written_extension_of(path) == ".raw") return write_raw(volume, path, options.progress);
    throw OutputError(path.string() +
                      ": Palpate for Windows writes raw volumes only; name it .raw");
}

}  // namespace palpate::io
