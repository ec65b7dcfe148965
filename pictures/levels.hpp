// The isosurfaces of a picture and the path of a hand, with the colours that all our pictures
// share.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "palpate/field.hpp"
#include "pictures/scene.hpp"

namespace palpate::pictures {

/// As many levels as there are colours to tell apart.
inline constexpr std::size_t most_levels = 5;

/// Adds the isosurfaces of up to most_levels levels, the innermost solid and bone-like, those round
/// it like glass. `progress` gets 0 to 1 and may throw to stop. Returns every how manieth sample
/// they were made from: 1 unless they would be too large.
int add_levels(
    PictureScene& scene, const Field& field, std::span<const double> levels,
    const std::function<void(double)>& progress = [](double) {});

/// Adds the paths of hand and proxy; that of the proxy in contact only, since else it is at the
/// hand. `hip` may be empty; `constrained` is for each `scp`. The camera must be directed before.
void add_path(PictureScene& scene, const std::vector<Vec3>& hip, const std::vector<Vec3>& scp,
              const std::vector<bool>& constrained);

}  // namespace palpate::pictures
