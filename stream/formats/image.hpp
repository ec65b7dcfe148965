// An image as the metadata of chunked formats describe it: axes, levels and channels. And the
// volume that a choice of channel and time makes of it. None of the text that it reads is trusted.
// Private to stream/.
#pragma once

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "stream/formats/chunked_store.hpp"

namespace palpate::stream {

/// Metadata that cannot be used; what() says why and what to do, without a file's name.
class BadMetadata : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct ImageAxis {
    std::string name;  ///< "t", "c", "z", "y", "x"
    std::string unit;  ///< empty: none
    /// The side of the body to which it runs: L, R, A, P, S, I; "?": another one; empty: none.
    std::string side = {};
};
struct ImageLevel {
    std::string path;                        ///< of its array
    std::vector<double> scale, translation;  ///< along each axis
};
/// One multiscale image, the finest level first.
struct Image {
    std::vector<ImageAxis> axes;  ///< the slowest first
    std::vector<ImageLevel> levels;
    std::vector<std::string> channels = {};     ///< names, as far as they are given
    std::optional<Range> range = std::nullopt;  ///< of the finest level
    std::optional<Mat3> direction =
        std::nullopt;                     ///< of the grid's axes; translations are then LPS
    bool oriented = false;                ///< the grid's axes are the body's
    bool measured = true;                 ///< false: the scales are assumed
    bool scaled = true;                   ///< false: the levels do not tell their scales
    std::vector<std::string> notes = {};  ///< about its metadata
};

/// The axes of an array that does not name them: its last three are z, y, x, before them c and t.
/// Throws BadMetadata unless there are 2 to 5.
std::vector<ImageAxis> usual_axes(std::size_t count);

/// Throws BadMetadata if t, c, z, y or x occurs twice, or there are more axes of space than three.
void check_axes(const std::vector<ImageAxis>& axes);

/// Completes a volume whose info has address, format and perhaps notes, channels and times, and
/// whose arrays are those of the levels: type, range, levels, the choice of channel and time. A
/// level that does not cover the space of the finest is left out, with a note.
/// Throws BadMetadata, io::InputError about a choice that there is not.
ChunkedVolume volume_of(const Image& image, ChunkedVolume begun, const StoreOptions& options);

/// How many samples of the finest level one of level `at` has along each axis, by the sizes of the
/// levels between them.
std::vector<double> factors_by_size(std::span<const ChunkedArray> arrays, std::size_t at);

/// All of an array, the slowest first.
std::vector<int> axes_in_order(const ChunkedArray& array);

/// Throws BadMetadata instead of std::invalid_argument.
void check_array(const ChunkedArray& array);

}  // namespace palpate::stream
