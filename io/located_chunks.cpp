// What image is in a file of chunks, and where they lie; see the header.
#include "io/located_chunks.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "io/helper/protocol.hpp"
#include "io/helper_process.hpp"
#include "io/io_helper.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// What take(answer) makes of the helper's answer.
template <class Take>
auto asked(const fs::path& path, const char* job_name, nlohmann::json request,
           const Descriptor* memory, Take&& take) {
    request["caller"] = getpid();
    return asked_of_helper(path, [&] {
        constexpr double seconds = 60;  // for metadata
        const HelperJob job{io_helper, {}, {job_name, path.string(), line_from(request)},
                            memory,    {}, seconds,
                            seconds};
        const HelperResult result = result_of(path, job);
        return take(result.done);
    });
}

}  // namespace

bool is_hdf5_name(const fs::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return std::tolower(c); });
    return extension == ".ims" || extension == ".h5" || extension == ".hdf5";
}

ChunkedImage describe_image(const fs::path& path, int channel, int time) {
    check_readable(path);
    return asked(path, "describe", {{"channel", channel}, {"time", time}}, nullptr,
                 chunked_image_from);
}

std::vector<ChunkPlace> locate_chunks(const fs::path& path, const std::string& array,
                                      const std::array<std::int64_t, 3>& first,
                                      const std::array<std::int64_t, 3>& count) {
    const auto chunks = static_cast<std::size_t>(count[0] * count[1] * count[2]);
    const std::size_t bytes = chunks * sizeof(ChunkPlace);
    const Descriptor memory = shared_memory();
    return asked(path, "chunks", {{"array", array}, {"first", first}, {"count", count}}, &memory,
                 [&](const nlohmann::json&) {
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
