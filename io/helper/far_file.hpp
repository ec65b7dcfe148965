// A file that lies elsewhere: its bytes are asked of the caller, by the page, and the pages are
// kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate::io {

/// From now on the file is elsewhere and has so many bytes.
void use_far_file(std::uint64_t size);
bool is_far();

/// [bytes]
std::uint64_t far_size();
/// False outside the file. Ends the process if there is no caller to ask.
bool read_far(std::uint64_t offset, std::span<std::byte> to);

}  // namespace palpate::io
