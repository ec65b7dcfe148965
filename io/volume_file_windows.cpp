// Reads and writes volumes without the formats' libraries, which are not built for Windows: raw,
// NRRD and MetaImage are read by our own readers, in this process.
#include <algorithm>
#include <cctype>

#include "io/helper/readers.hpp"
#include "io/process/io_helper.hpp"
#include "io/raw_file.hpp"
#include "io/system/system.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::io {
namespace {

/// What the readers share with their caller; elsewhere a process lies between the two.
struct Reading {
    std::shared_ptr<std::byte> samples;
    Progress progress;
};
thread_local Reading reading;

Result read_with_header(const std::filesystem::path& path, const Request& request) {
    const bool is_nifti = header_reader(path) == &nifti_header;
    if (header_reader(path) && !is_nifti) return read_by_header(request);
    throw Failure(
        "Palpate for Windows reads NRRD, MetaImage and raw volumes; convert it to one of them, for "
        "example with `palpate convert` on Linux");
}

}  // namespace

std::span<std::byte> shared_samples(std::uint64_t bytes) {
    reading.samples = fresh_memory(bytes);
    return {reading.samples.get(), bytes};
}

void say_progress(double fraction) {
    if (reading.progress) reading.progress(fraction);
}

void say_doing(const std::string&) {}

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
    reading = {nullptr, options.progress};
    try {
        Result result = read_with_header(path, request);
        const auto bytes =
            static_cast<std::size_t>(sample_count(result.geometry)) * size_of(result.type);
        const Reading done = std::move(reading);
        reading = {};
        return {Volume(result.geometry, result.type, done.samples, bytes),
                result.format,
                result.time_steps,
                std::move(result.notes),
                result.times.interval,
                result.times.first,
                result.values};
    } catch (const Failure& e) {
        reading = {};
        throw InputError(path.string() + ": " + e.what());
    } catch (const std::bad_alloc&) {
        reading = {};
        throw InputError(path.string() + ": not enough memory; crop or downsample the volume");
    }
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
