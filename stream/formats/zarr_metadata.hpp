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

/// Throws BadMetadata if a node of Zarr 3 has a member that is not known, unless it says that it
/// need not be understood.
void check_members(const nlohmann::json& zarr);

/// If the chunks can be listed, and lie in another layout than the metadata say, the array gets
/// the one in which they lie, with a note. Another note says that there is no chunk at all. Throws
/// BadMetadata if they lie in several others.
void take_stored_layout(const Objects& objects, ChunkedArray& array,
                        std::vector<std::string>& notes);

/// `attributes`: those of the group (Zarr 2: .zattrs; OME-Zarr 0.5: the member "ome" of them is
/// looked into). Nothing if there is no multiscale image in it.
std::optional<Image> ome_image(const nlohmann::json& attributes);

/// The name of an axis in lower case, short enough for messages, t for time and c for channel;
/// empty if it is no text.
std::string axis_name(const nlohmann::json& name);

}  // namespace palpate::stream
