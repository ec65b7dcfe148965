// Metadata of Zarr 2 and 3 arrays and of OME-Zarr images. What is read here is not trusted. Private
// to stream/.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stream/chunked_array.hpp"

namespace palpate::stream {

/// Metadata that cannot be used; what() says why and what to do, without a file's name.
class BadMetadata : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// All of these throw BadMetadata or nlohmann::json::exception.
ChunkedArray zarr2_array(const nlohmann::json& zarray, const std::string& folder);
ChunkedArray zarr3_array(const nlohmann::json& zarr, const std::string& folder);

struct OmeAxis {
    std::string name;  ///< "t", "c", "z", "y", "x"
    std::string unit;  ///< empty: none
};
struct OmeDataset {
    std::string path;
    std::vector<double> scale, translation;  ///< along each axis, with those of the whole image
};
/// One multiscale image: its levels, the finest first.
struct OmeImage {
    std::vector<OmeAxis> axes;  ///< the slowest first
    std::vector<OmeDataset> datasets;
    std::vector<std::string> channels;  ///< names, as far as they are given
    std::optional<Range> range;         ///< as palpate convert writes it, and
    std::optional<Mat3> direction;      ///< of the grid's axes; its translations are then in LPS
};
/// `attributes`: those of the group (Zarr 2: .zattrs; OME-Zarr 0.5: the member "ome" of them is
/// looked into). Nothing if there is no multiscale image in it.
std::optional<OmeImage> ome_image(const nlohmann::json& attributes);

/// [mm] of a unit of length, [s] of a unit of time; 0: not known.
double millimetres_in(const std::string& unit);
double seconds_in(const std::string& unit);

}  // namespace palpate::stream
