// Colours for numbers: colour maps, and transfer functions to begin with, from the data at hand.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/run/statistics.hpp"
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

/// int16 or float from -4096..-500 up, as CT has them.
bool looks_like_hounsfield(const Volume& volume);

/// The presets that are made for such data, in the order in which people are offered them: those of
/// CT where the data look like Hounsfield units, or like those and 1000 or 1024 more.
std::vector<std::string> preset_names(const run::Histogram& histogram, const Volume& volume);

/// A transfer function for this volume; its points lie within the data's range. In Hounsfield units
/// the CT presets stand at those of tissues; else all presets stand at the levels that the
/// histogram suggests. Knows all presets, whatever the data. Throws std::invalid_argument, listing
/// the names, for one that there is not.
TransferFunction preset(std::string_view name, const run::Histogram& histogram,
                        const Volume& volume);

/// The preset that is likely to show something of this volume: a guess by type, range and shape of
/// the histogram.
std::string suggested_preset(const run::Histogram& histogram, const Volume& volume);

/// Colour and opacity at a level [data units]; beyond the outer points theirs. The function
/// must have points.
ControlPoint sampled(const TransferFunction& transfer, double level);

}  // namespace palpate::viewer
