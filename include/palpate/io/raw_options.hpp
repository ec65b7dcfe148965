// Parses the options that describe a raw file: "256x256x113", "uint16", "1,1,2".
#pragma once

#include <string_view>

#include "palpate/io/volume_file.hpp"

namespace palpate::io {

/// Three finite numbers with `separator` between them and nothing else. Throws
/// std::invalid_argument, naming `what` (the option) and the text.
Vec3 three_numbers_from(std::string_view text, char separator, std::string_view what);

/// Spacing "X,Y,Z" [mm], each above 0. Throws std::invalid_argument.
Vec3 spacing_from(std::string_view text);

/// `dims` "WxHxD", `type` a sample type's name, `spacing` as above or empty for 1 mm, `skip` in
/// bytes. Throws std::invalid_argument, naming the setting, unless the three make a geometry that
/// check() accepts.
RawLayout raw_layout_from(std::string_view dims, std::string_view type, std::string_view spacing,
                          std::uint64_t skip);

/// Text to print after the name of a saved volume: for .raw how to open it again,
/// " (open it with dims 256x256x113, type uint16, spacing 1,1,2)"; for others empty.
std::string opening_words(const std::filesystem::path& saved, const Volume& volume);

}  // namespace palpate::io
