// The volume of a file of chunks, from the words of the helper process, which are not trusted.
// Private to stream/.
#pragma once

#include <filesystem>

#include "io/chunked_image.hpp"
#include "stream/formats/image.hpp"

namespace palpate::stream {

/// Throws BadMetadata, io::InputError about a choice that there is not.
ChunkedVolume located_volume(const io::ChunkedImage& found,
                             const std::shared_ptr<LocatedFile>& file, const StoreOptions& options);

}  // namespace palpate::stream
