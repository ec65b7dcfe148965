// One update of a proxy in a plane cut of the lattice, step by step.
#pragma once

#include <string>
#include <vector>

#include "evaluation/figure.hpp"
#include "evaluation/subject.hpp"
#include "palpate/proxy.hpp"

namespace palpate::evaluation {

/// A volume that does not change along z, so that a motion in a plane of samples stays in it and
/// the cut through that plane tells all: the squares between four samples, each cut by its
/// diagonals into four triangles with a linear field (or squares round the samples, with a cubic in
/// each triangle). And the hand before and in the update.
struct Cut {
    Subject subject;
    double z = 0;                             ///< [mm] of the plane of samples
    Index3 low = Index3::Zero(), high = low;  ///< samples that are shown, both included; z unused
    Vec3 start = Vec3::Zero();                ///< a free place [mm, physical]
    Vec3 hip_before = Vec3::Zero();           ///< hand in the update before
    Vec3 hip = Vec3::Zero();                  ///< hand in the update that is shown
};

/// A plateau, a slope, a floor and a wall of one sample's thickness on it.
Cut wall_cut();
/// The middle slice of a volume, where a ray along its rows first meets the surface. Throws
/// std::invalid_argument if none does.
Cut slice_of(const Subject& subject);

/// What a method did in the update.
struct Walk {
    std::string method;
    Vec3 before = Vec3::Zero();  ///< SCP before the update
    std::vector<Step> steps;     ///< as observed, those that crossed a wall included
    ProxyUpdate end;
};
/// Of a contestant, by its name.
Walk walk_in(const Cut& cut, const std::string& method);

/// Panels of the cut, one for each walk.
Figure walk_figure(const Cut& cut, const std::vector<Walk>& walks);

}  // namespace palpate::evaluation
