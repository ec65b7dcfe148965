// The files from which a volume is read, so that no output replaces one of them.
#pragma once

#include <filesystem>

namespace palpate::stream {

/// As io::is_read_from(), also for the original of edits.
bool is_read_from(const std::filesystem::path& path, const std::filesystem::path& source);

}  // namespace palpate::stream
