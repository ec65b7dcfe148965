// The brush that the user has chosen in the panel, as a plain value.
#pragma once

#include "palpate/run/brush.hpp"

namespace palpate::viewer {

/// Smoothing has no value of its own.
struct BrushChoice : run::HandBrush {
    bool on = false;  ///< the probe edits where it is

    bool operator==(const BrushChoice&) const = default;
};

}  // namespace palpate::viewer
