// The axes of a NRRD header. Private to the NRRD reader.
#pragma once

#include "io/helper/headers.hpp"

namespace palpate::io {

/// Enters the grid, how many volumes there are, how they lie and when they were taken. The header's
/// sizes and type are known. Throws Failure.
void take_axes(const HeaderFields& fields, VolumeHeader& header);

}  // namespace palpate::io
