// Metadata of Zarr 2 and 3 arrays and of OME-Zarr images. None of the text that it reads is
// trusted. Private to stream/.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "stream/formats/image.hpp"

namespace palpate::stream {

/// All of these throw BadMetadata or nlohmann::json::exception.
ChunkedArray zarr2_array(const nlohmann::json& zarray, const std::string& folder);
ChunkedArray zarr3_array(const nlohmann::json& zarr, const std::string& folder);

/// `attributes`: those of the group (Zarr 2: .zattrs; OME-Zarr 0.5: the member "ome" of them is
/// looked into). Nothing if there is no multiscale image in it.
std::optional<Image> ome_image(const nlohmann::json& attributes);

}  // namespace palpate::stream
