// The helper's side of io/process/mirror.hpp: reads the parts of a file that are here, and keeps
// the first one that is not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate::io {

struct MissingPart {
    std::uint64_t offset = 0, length = 0;
};

/// From now on the file is the one in the descriptor mirror_descriptor.
void use_mirror();
bool uses_mirror();

/// [bytes]
std::uint64_t mirror_size();
/// False if a part is not here (then it is missing_part(), if it is the first) or outside the file.
bool read_mirror(std::uint64_t offset, std::span<std::byte> to);
std::optional<MissingPart> missing_part();

}  // namespace palpate::io
