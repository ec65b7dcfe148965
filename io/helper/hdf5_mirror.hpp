// A driver by which libhdf5 reads a mirrored file.
#pragma once

#include <hdf5.h>

namespace palpate::io {

/// Makes files that are opened with this access list the mirror, whatever their name. False if
/// libhdf5 refuses.
bool read_from_mirror(hid_t access);

}  // namespace palpate::io
