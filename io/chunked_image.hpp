// The description of the image in a file of chunks (HDF5, TIFF), which the helper process gives its
// caller. The chunks are then read from the file. Private to io/ and stream/.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/stored.hpp"

namespace palpate::io {

/// One level of one channel and time. Lists are along z, y, x.
struct ImageArray {
    std::string id;  ///< by which the helper finds it again
    std::array<std::int64_t, 3> shape = {1, 1, 1}, chunk = {1, 1, 1};  ///< [samples]
    Stored stored = Stored::uint8;
    bool swapped = false;  ///< in the other byte order than the machine's
    ValueMap values = {};
    double fill = 0;  ///< of chunks that are not stored [data units]
    std::vector<std::string>
        codecs;  ///< in the order of decoding, by the names of stream/formats/codecs.hpp
    std::array<double, 3> scale = {1, 1, 1}, translation = {0, 0, 0};  ///< [unit]
};

struct ChunkedImage {
    std::string format;
    std::string unit;                   ///< of length; empty: the file gives none
    bool measured = true;               ///< false: the file gives no spacing
    std::vector<std::string> channels;  ///< names; empty: one, without a name
    int times = 1;
    double frame_interval = 0;                     ///< [s]; 0: the file does not say
    std::optional<std::array<double, 2>> range{};  ///< of the finest level [data units]
    std::vector<std::string> notes{};
    std::vector<ImageArray>
        levels{};  ///< the finest first; none if there is no such channel or time
};

/// Where a chunk lies in its file, as the helper tells it.
struct ChunkPlace {
    std::uint64_t offset = 0, length = 0;  ///< [bytes]; no length: it is not stored
    std::uint64_t skipped = 0;  ///< bit i: codec i, in the order of decoding, was not used
};

/// Of a level and the next coarser one. Halves of odd sizes are rounded either way, so it is whole.
double factor_between(std::int64_t fine, std::int64_t coarse);
/// Places a level whose samples are the means of `factor` ones of the finest.
void place(ImageArray& level, const std::array<double, 3>& spacing,
           const std::array<double, 3>& origin, const std::array<double, 3>& factor);
/// The number of a time in its file, where `numbers` may begin anywhere and have gaps. Notes it if
/// it is another one.
int number_of_time(int time, const std::vector<int>& numbers, std::vector<std::string>& notes);

nlohmann::json json_from(const ChunkedImage& image);

/// Throws nlohmann::json::exception, std::bad_optional_access, std::invalid_argument for what the
/// other function does not make.
ChunkedImage chunked_image_from(const nlohmann::json& json);

}  // namespace palpate::io
