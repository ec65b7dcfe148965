// Colour maps: colours for numbers between 0 and 1.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pictures/scene.hpp"

namespace palpate::viewer {

/// "grey", and others as they are known in the field: "hot", "bone", "viridis", "cool-warm",
/// "spectrum".
std::vector<std::string> colour_map_names();

/// 256 colours from the first to the last, 0xffRRGGBB. Throws std::invalid_argument for a name that
/// is not known.
using ColourTable = std::array<std::uint32_t, 256>;
ColourTable colour_table(const std::string& name);

/// A colour for a label without one of its own: neighbours differ.
pictures::Colour label_colour(int value);

}  // namespace palpate::viewer
