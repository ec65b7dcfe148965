// Attributes of N5 datasets and of multiscale groups. None of the text that it reads is trusted.
// Private to stream/.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "stream/formats/image.hpp"

namespace palpate::stream {

/// All of these throw BadMetadata or nlohmann::json::exception.
ChunkedArray n5_array(const nlohmann::json& attributes, const std::string& folder);

/// Scales and places of levels, from the attributes of each and of the groups around them, the
/// innermost first. Spacings come from `transform` (Janelia), the groups' `multiscales` (Janelia
/// and OME-NGFF), `pixelResolution` or `resolution`, factors from `downsamplingFactors` or
/// `scales`; a sample of a coarser level is the mean of those of the finest, so it lies in the
/// middle of them. Notes say what the attributes lack.
Image n5_image(std::span<const nlohmann::json> groups, std::span<const nlohmann::json> levels,
               std::span<const ChunkedArray> arrays, std::vector<std::string>& notes);

}  // namespace palpate::stream
