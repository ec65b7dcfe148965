// Which part of a store the scene shows more finely than its overview, and how the samples of that
// part join those of the overview at its border.
#pragma once

#include "apps/viewer/model/detail_choice.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// What is seen of surfaces.
struct SeenPoints {
    std::vector<Vec3> points;    ///< [mm, physical] spread over the picture
    Vec3 middle = Vec3::Zero();  ///< of interest: under the middle of the view, or the proxy
    double half_height = 1;      ///< of the view [mm]
    double pixel_mm = 1;         ///< of a device pixel
};

/// A part of the overview that is replaced: whole cells of its lattice.
struct PatchChoice {
    int level = 0;
    SampleBox box;  ///< of that level: two samples more than the cells need
    /// Planes between cells of the overview, in its index space; infinite where the data end.
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();

    bool operator==(const PatchChoice&) const = default;
};

/// A box round what is seen, at the level that the pixels deserve. Where that is too much, only
/// what lies within a view's height of the middle, then a coarser level. Nothing where a finer
/// level than the overview's is not allowed. `interpolation` says where the cells lie.
std::optional<PatchChoice> patch_for(const SeenStore& store, const SeenPoints& seen,
                                     Interpolation interpolation, const DetailLimits& limits);

/// True if this part has all points and is of the level that patch_for() would choose.
bool is_enough(const PatchChoice& patch, const SeenStore& store, const SeenPoints& seen,
               Interpolation interpolation, const DetailLimits& limits);

/// The samples of `fine`, but at the planes of the patch and outside of them those of the field of
/// the overview, and in between within a cell, or four samples if that is less: surfaces extracted
/// from both meet at the planes to within a part of a fine sample.
Volume joined_samples(const Volume& fine, const Field& overview, const PatchChoice& patch);

}  // namespace palpate::viewer
