// Files that are read with others because these name them. Private to io/.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate::io {

/// What reading these files as volumes reads beside them: data files that headers of NRRD and
/// MetaImage name, the other half of a pair, the XML file of BigDataViewer. The helper process
/// reads the headers. Those that cannot be read name none.
std::vector<std::filesystem::path> files_read_with(const std::vector<std::filesystem::path>& files);

}  // namespace palpate::io
