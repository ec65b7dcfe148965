// palpate-io-images: reads and writes TIFF, reads images in chunks of HDF5.
#include "io/helper/images.hpp"
#include "io/helper/jobs.hpp"
#include "io/tiff_peek.hpp"

namespace palpate::io {
namespace {

nlohmann::json explore(const std::filesystem::path& path, const nlohmann::json& question) {
    const bool tiff = is_tiff_name(path);
    if (!question.contains("array")) {
        const int channel = question.at("channel").get<int>(),
                  time = question.at("time").get<int>();
        return json_from((tiff ? tiff_image : hdf5_image)(path, channel, time));
    }
    const ChunkBox box{question["array"].get<std::string>(),
                       question.at("first").get<std::array<std::int64_t, 3>>(),
                       question.at("count").get<std::array<std::int64_t, 3>>()};
    std::vector<ChunkPlace> places(
        static_cast<std::size_t>(box.count[0] * box.count[1] * box.count[2]));
    (tiff ? tiff_places : hdf5_places)(path, box, places);
    nlohmann::json numbers = nlohmann::json::array();
    for (const auto& [offset, length, skipped] : places) {
        for (const std::uint64_t number : {offset, length, skipped}) numbers.push_back(number);
    }
    return {{"places", std::move(numbers)}};
}

}  // namespace
}  // namespace palpate::io

int main(int argc, char** argv) {
    using namespace palpate::io;
    serve("palpate-io-images", {.read = &read_tiff, .explore = &explore, .write = &write_tiff},
          argc, argv);
}
