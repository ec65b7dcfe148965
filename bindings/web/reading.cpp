// Reads volumes in a page. See the header. Has the functions of io/inflate.hpp without zlib, and
// memory without an operating system.
#include "bindings/web/reading.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <new>

#include "io/helper/in_process.hpp"
#include "io/helper/readers.hpp"
#include "io/inflate.hpp"
#include "io/system/system.hpp"

namespace palpate {
namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 29;  // of samples

/// Name of the data that is unpacked from this place.
std::string unpacked_name(const std::filesystem::path& file, std::uint64_t offset) {
    return file.string() + ".unpacked-" + std::to_string(offset);
}

std::uint64_t bytes_from(const std::filesystem::path& file, std::uint64_t offset) {
    const std::uint64_t all = std::filesystem::file_size(file);
    return all - std::min(offset, all);
}

io::Result read_with_header(const io::Request& request) {
    if (io::header_reader(request.path)) return io::read_by_header(request);
    throw io::Failure(
        "is of no format that is read in the browser (NRRD, MetaImage, NIfTI, DICOM, OME-Zarr); "
        "convert it first, for example with `palpate convert IN OUT.nrrd`");
}

}  // namespace

namespace io {

std::uint64_t inflate_checked(const std::filesystem::path& file, const StreamPlace& place,
                              const ByteSink& sink) {
    const std::string name = unpacked_name(file, place.offset);
    if (!std::filesystem::exists(name)) {
        throw web::Packed{file.string(), place.offset,
                          std::min(place.length, bytes_from(file, place.offset)), name};
    }
    const std::uint64_t size = std::filesystem::file_size(name);
    if (size > place.at_most) {
        throw OversizedStream("the compressed data unpacks to more than its header says");
    }
    std::ifstream in(name, std::ios::binary);
    std::vector<std::byte> chunk(std::size_t{1} << 18);
    for (std::uint64_t left = size; sink && left > 0;) {
        const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(left, chunk.size()));
        in.read(reinterpret_cast<char*>(chunk.data()), static_cast<std::streamsize>(now));
        sink(std::span(chunk.data(), now));
        left -= now;
    }
    return size;
}

std::shared_ptr<std::byte> fresh_memory(std::size_t bytes) {
    void* const at = std::calloc(bytes, 1);
    if (!at) throw std::bad_alloc();
    return {static_cast<std::byte*>(at), &std::free};
}

}  // namespace io

io::VolumeFile web::read(const std::string& file) {
    io::Request request;
    request.path = file;
    request.memory_limit = most_bytes;
    return io::read_in_process(request, nullptr, &read_with_header);
}

}  // namespace palpate
