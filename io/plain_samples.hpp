// Finds the uncompressed samples in a volume file, so that they can be read by the box. The
// helper process reads the header, as it does for read_volume(). Private to io/ and stream/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/stored.hpp"
#include "palpate/io/volume_file.hpp"

namespace palpate::io {

struct PlainSamples {
    std::string format;
    Geometry geometry;
    Stored stored = Stored::uint8;
    std::filesystem::path file;  ///< that holds the samples
    std::uint64_t offset = 0;    ///< [bytes] of the first sample; x fastest, then y, z, time
    bool swapped = false;  ///< the bytes of a sample are in the other order than the machine's
    ValueMap value_map;
    int times = 1;
    double frame_interval = 0;  ///< [s]; 0: the file does not say
    std::vector<std::string> notes;
};

/// True for a raw layout of a file that is not packed, and for NRRD, MetaImage and NIfTI files
/// unless their header, which the helper process reads, says that they are read as a whole only.
bool may_be_plain(const std::filesystem::path& path, const ReadOptions& options);

/// Of raw files (options.raw), NRRD, MetaImage and NIfTI. Checks the header and the file's length;
/// reads no samples. Uses options.raw, spacing, helper and time_limit_s. Throws InputError.
PlainSamples locate_samples(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace palpate::io
