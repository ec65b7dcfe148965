// Finds out which slices of different places are of one moment. Uses no library.
#pragma once

#include "io/helper/dicom_stack.hpp"

namespace palpate::io {

/// The slices in order along the normal; all those at one place are one group.
using SliceGroups = std::vector<std::vector<PlacedSlice>>;

/// Puts the slices of each place in an order such that the k-th of every place are one moment. A
/// key decides if it has the same values at every place, or if one moment or one place follows
/// another by it. Adds a note where times say something else than the key that decides. Throws
/// Failure if no key decides.
void sort_by_moment(const DicomSeries& series, SliceGroups& groups,
                    std::vector<std::string>& notes);

}  // namespace palpate::io
