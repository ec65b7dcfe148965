// A second volume over the one that is felt: a label map or another image, on a grid of its own.
#pragma once

#include <string>
#include <vector>

#include "apps/viewer/model/look.hpp"
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

}  // namespace palpate::viewer
