// Copies a box of a field's samples into one array, edits and moment included; for surface, slices
// and volume rendering. The cost depends on the box, not on the volume.
#pragma once

#include <vector>

#include "palpate/field.hpp"

namespace palpate::viewer {

/// Samples [data units] at `low` + (0, 0, 0) to `size` - 1, x fastest, at the field's moment and
/// with its edits. Outside the grid they are background.
std::vector<float> sample_block(const Field& field, const Index3& low, const Index3& size);

/// True if both are the same samples at the same moment.
bool same_samples(const Field& a, const Field& b);
/// The samples that differ between two versions on one grid, or a few more: whole bricks, or all
/// where more than edits has changed.
SampleBox changed_between(const Field& a, const Field& b);
/// The same for samples of one grid of which only edits differ.
SampleBox edited_between(const Samples& a, const Samples& b);
/// False where more than edits differs: the moment, the volume under them, the side that is solid.
bool same_but_for_edits(const Field& a, const Field& b);

}  // namespace palpate::viewer
