// Describes the image in a file of chunks and the places of its chunks. See the header.
#include "io/process/located_chunks.hpp"

#include <unistd.h>

#include <utility>

#include "io/helper/protocol.hpp"
#include "io/process/io_helper.hpp"
#include "io/words.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// Most bytes of a file elsewhere that the helper gets for one question.
constexpr std::uint64_t most_given = std::uint64_t{512} << 20;

std::vector<ChunkPlace> places_from(const nlohmann::json& numbers, std::size_t count) {
    if (!numbers.is_array() || numbers.size() != 3 * count) {
        throw std::invalid_argument("the helper process gave too few places");
    }
    std::vector<ChunkPlace> places(count);
    for (std::size_t i = 0; i < 3 * count; ++i) {
        if (!numbers[i].is_number_unsigned()) throw std::invalid_argument("a place is no number");
        ChunkPlace& place = places[i / 3];
        const auto number = numbers[i].get<std::uint64_t>();
        (i % 3 == 0 ? place.offset : i % 3 == 1 ? place.length : place.skipped) = number;
    }
    return places;
}

}  // namespace

bool is_hdf5_name(const fs::path& path) {
    const std::string extension = lower(path.extension().string());
    return extension == ".ims" || extension == ".h5" || extension == ".hdf5";
}

ChunkedImage ChunkFile::describe(int channel, int time, const std::stop_token& stop) {
    if (!read_) check_readable(path_);
    return asked_of_helper(path_, [&] {
        return chunked_image_from(answer({{"channel", channel}, {"time", time}}, stop));
    });
}

std::vector<ChunkPlace> ChunkFile::locate(const std::string& array,
                                          const std::array<std::int64_t, 3>& first,
                                          const std::array<std::int64_t, 3>& count,
                                          const std::stop_token& stop) {
    const auto chunks = static_cast<std::size_t>(count[0] * count[1] * count[2]);
    return asked_of_helper(path_, [&] {
        const nlohmann::json done =
            answer({{"array", array}, {"first", first}, {"count", count}}, stop);
        return places_from(done.at("places"), chunks);
    });
}

nlohmann::json ChunkFile::answer(const nlohmann::json& question, const std::stop_token& stop) {
    std::uint64_t given = 0;
    const auto give = [&](std::uint64_t offset, std::uint64_t length) {
        if (length == 0 || length > far_page || offset >= size_ || length > size_ - offset) {
            throw std::invalid_argument("the helper process asks for bytes outside the file");
        }
        given += length;
        if (given > most_given) {
            throw std::invalid_argument("its metadata are too large to be read from there");
        }
        return read_(offset, length, stop);
    };
    const auto check = [&](double) {
        if (stop.stop_requested()) throw Cancelled{};
    };
    HelperTalk talk = std::exchange(talk_, nullptr);  // kept only if it answers
    const bool is_new = !talk || talker_ != getpid();
    if (is_new) {
        nlohmann::json request = {{"own_memory", own_memory_}};
        if (read_) request["size"] = size_;
        constexpr double seconds = 60;  // for metadata
        talk = talk_to_helper(
            {io_helper, {}, {"explore", path_.string(), line_from(request)}, nullptr, {}, seconds});
    }
    HelperResult result = talk(question, give, check);
    if (result.failure.empty()) {
        talk_ = std::move(talk);
        talker_ = getpid();
        return std::move(result.done);
    }
    // An earlier question may have harmed it, or the system has ended it meanwhile.
    if (!is_new) return answer(question, stop);
    throw InputError(path_.string() + ": " + result.failure);
}

}  // namespace palpate::io
