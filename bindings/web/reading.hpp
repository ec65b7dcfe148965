// Reads NRRD, MetaImage and NIfTI in a page with the native readers. Their files are those that the
// page has given (given_files.js).
#pragma once

#include <cstdint>
#include <string>

#include "palpate/io/volume_file.hpp"

namespace palpate::web {

/// A compressed part of a file, which the page has to unpack before the file can be read: only
/// browsers can, and not within a call.
struct Packed {
    std::string file;
    std::uint64_t offset = 0, length = 0;  ///< [bytes]
    std::string unpacked;                  ///< the file for what comes out of it
};

/// Throws io::InputError, or Packed.
io::VolumeFile read(const std::string& file);

}  // namespace palpate::web
