// A second volume over the one that is felt: a label map or another image, on a grid of its own.
// Also layers by its labels. Plain values.
#pragma once

#include <string>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/look.hpp"
#include "palpate/run/labels.hpp"
#include "palpate/run/source.hpp"

namespace palpate::viewer {

struct Label {
    int value = 0;
    std::string name;
    Colour colour;
    SampleBox box;  ///< the samples with this value
};

struct Overlay {
    run::Source source;
    Volume volume;
    std::vector<Label> labels;    ///< of a label map, rising; empty: an image
    double dark = 0, bright = 1;  ///< [data units] of an image: no colour, full colour
    double level = 0;             ///< [data units] of an image: the surface suggested first
    int time_steps = 1;           ///< frames of the file it was read from

    bool is_label_map() const { return !labels.empty(); }
};

/// A label map is one whose header names labels, or one of whole numbers of which there are few.
Overlay make_overlay(const run::LoadedVolume& loaded, const run::Source& source);

/// The mask of a label on its part of the grid and a little more, smoothed, so that its surface at
/// 0.5 has small steps; also of a label that is a sample wide.
Volume label_mask(const Overlay& overlay, const Label& label);

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
