// Finds the files that the headers of other files name. Private to io/.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate::io {

/// The other files that are read if these files are read as volumes: data files that headers of
/// NRRD and MetaImage name, the other half of a pair, and the XML file of BigDataViewer. The helper
/// process reads the headers. A header that cannot be read names none.
std::vector<std::filesystem::path> files_read_with(const std::vector<std::filesystem::path>& files);

}  // namespace palpate::io
