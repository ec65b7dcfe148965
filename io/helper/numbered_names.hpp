// The names of slices in a folder: which numbers in them count slices, channels and times. Uses no
// library, reads no file.
#pragma once

#include <filesystem>
#include <vector>

#include "io/helper/decode.hpp"

namespace palpate::io {

/// The slices of one volume, in their order, for each time.
struct NumberedSlices {
    std::vector<std::vector<std::filesystem::path>> times;
    std::vector<std::string> notes;
};

/// A number that differs from name to name counts slices. Among several, those are taken that the
/// letters before them mark as slices, or else those without a mark: they have to give the same
/// order. If several numbers are needed to tell the files apart, each is known by the letters
/// before it (z, slice; c, ch, channel; t, time), one without counts slices, and the first channel
/// is taken, with a note. Throws Failure if that leaves a doubt, or if files are missing.
NumberedSlices numbered_slices(std::vector<std::filesystem::path> files);

}  // namespace palpate::io
