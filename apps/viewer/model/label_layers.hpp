// Layers by label from the label map that lies over the volume. Plain values.
#pragma once

#include <string>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/overlay.hpp"
#include "palpate/run/labels.hpp"

namespace palpate::viewer {

/// A layer for each label that is not hidden, without places yet.
io::LayersFile layers_of(const Overlay& labels, const std::vector<int>& hidden);

/// Layers with levels, by the labels that have their names; nothing if one has no such label.
/// Without places yet.
std::optional<io::LayersFile> by_name(const io::LayersFile& file, const Overlay& labels);

/// The labels that these layers ask for and the map does not have, as in "7 (bone), 9 (skull)".
std::string missing_labels(const Layers& layers, const Overlay& labels);

/// With their places. Throws std::invalid_argument for a map that cannot be felt: of numbers that
/// are not whole in its file, of a sequence, of more than 16 layers.
Layers placed(const Layers& layers, const Overlay& labels);

/// The overlay in the colours of layers that are by label; the same pointer if it has them.
std::shared_ptr<const Overlay> in_colours_of(const std::shared_ptr<const Overlay>& overlay,
                                             const SharedLayers& layers);

}  // namespace palpate::viewer
