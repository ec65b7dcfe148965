// Surfaces of the labels of a label map.
#pragma once

#include <functional>
#include <vector>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/scene/surface_extractor.hpp"

namespace palpate::viewer {

/// One for each label, as smooth as its mask allows; positions from the middle of the overlay's
/// grid. `progress` may throw to stop.
std::vector<ExtractedSurface> label_surfaces(const Overlay& overlay,
                                             const std::function<void(double part)>& progress);

}  // namespace palpate::viewer
