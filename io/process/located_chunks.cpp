// What image is in a file of chunks, and where they lie; see the header.
#include "io/process/located_chunks.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "io/helper/protocol.hpp"
#include "io/process/helper_process.hpp"
#include "io/process/io_helper.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// How often the helper may ask for more of a mirror: metadata of a terabyte lie in some hundred
/// places.
constexpr int most_rounds = 10000;

nlohmann::json answer_of(const ChunkFile& file, const char* job_name, nlohmann::json request,
                         const Descriptor* memory, const std::stop_token& stop) {
    request["caller"] = getpid();
    if (file.mirror) request["mirror"] = true;
    constexpr double seconds = 60;  // for metadata
    const HelperJob job{
        io_helper, {},      {job_name, file.path.string(), line_from(request)}, memory, {},
        seconds,   seconds, file.mirror ? &file.mirror->memory() : nullptr};
    if (!file.mirror) return result_of(file.path, job).done;
    const std::scoped_lock lock(file.mirror->mutex());
    file.mirror->tidy();
    for (int round = 0; round < most_rounds; ++round) {
        nlohmann::json done = result_of(file.path, job).done;
        if (!done.contains("missing")) return done;
        const auto part = done["missing"].get<std::array<std::uint64_t, 2>>();
        file.mirror->fetch(part[0], part[1], stop);
    }
    throw std::invalid_argument("its metadata lie in too many places to be read from there");
}

/// What take(answer) makes of the helper's answer.
template <class Take>
auto asked(const ChunkFile& file, const char* job_name, const nlohmann::json& request,
           const Descriptor* memory, const std::stop_token& stop, Take&& take) {
    return asked_of_helper(file.path,
                           [&] { return take(answer_of(file, job_name, request, memory, stop)); });
}

}  // namespace

bool is_hdf5_name(const fs::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return std::tolower(c); });
    return extension == ".ims" || extension == ".h5" || extension == ".hdf5";
}

ChunkedImage describe_image(const ChunkFile& file, int channel, int time) {
    if (!file.mirror) check_readable(file.path);
    return asked(file, "describe", {{"channel", channel}, {"time", time}}, nullptr, {},
                 chunked_image_from);
}

std::vector<ChunkPlace> locate_chunks(const ChunkFile& file, const std::string& array,
                                      const std::array<std::int64_t, 3>& first,
                                      const std::array<std::int64_t, 3>& count,
                                      const std::stop_token& stop) {
    const auto chunks = static_cast<std::size_t>(count[0] * count[1] * count[2]);
    const std::size_t bytes = chunks * sizeof(ChunkPlace);
    const Descriptor memory = shared_memory();
    return asked(file, "chunks", {{"array", array}, {"first", first}, {"count", count}}, &memory,
                 stop, [&](const nlohmann::json&) {
                     struct stat status {};
                     if (fstat(memory.number(), &status) != 0 ||
                         status.st_size != static_cast<off_t>(bytes)) {
                         throw std::invalid_argument("the helper process gave too few places");
                     }
                     std::vector<ChunkPlace> places(chunks);
                     std::memcpy(places.data(), map_shared(memory, bytes).get(), bytes);
                     return places;
                 });
}

}  // namespace palpate::io
