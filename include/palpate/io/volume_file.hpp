// Reads and writes volume files: NRRD, MetaImage, NIfTI, DICOM, TIFF, VTI and raw. The formats'
// libraries run in a helper process, so that a damaged file that crashes or hangs a library only
// causes an InputError. Needs the core, nlohmann-json and zlib only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/io/series.hpp"
#include "palpate/io/value_info.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

using Progress = OnProgress;

/// Layout of a headerless file: x fastest, then y, then z.
struct RawLayout {
    Index3 size = Index3::Zero();
    SampleType type = SampleType::uint8;
    Vec3 spacing = Vec3::Ones();  ///< [mm]
    std::uint64_t skip = 0;       ///< bytes before the first sample (after unpacking a .gz)
    bool big_endian = false;      ///< the first byte of a sample is the highest
};

struct ReadOptions {
    /// Read the file as headerless samples, whatever its name. Gzip is unpacked.
    std::optional<RawLayout> raw;
    /// Replaces the spacing of the file [mm].
    std::optional<Vec3> spacing;
    /// Replaces the orientation of the file: direction_from().
    std::string orientation = {};
    /// Which DICOM series: its UID, or its number in the list that the error message gives.
    std::string series;
    /// Make pictures for SeriesChoice if a series has to be chosen.
    bool series_pictures = false;
    /// Which volume of a 4-D file, counted from 0.
    int time_step = 0;
    Progress progress;
    /// The program palpate-io-helper. Empty: the environment variable PALPATE_IO_HELPER, or else
    /// the places in docs/package.md.
    std::filesystem::path helper;
    /// Memory limit of the samples [bytes]. 0: the memory of this machine.
    std::uint64_t memory_limit_bytes = 0;
    /// The helper is ended after this time [s], and after the same processor time. 0: it depends on
    /// the size of the file or folder: 600 s (120 s of processor time) and 2 s for each MB.
    double time_limit_s = 0;
};

/// A volume, and notes on how it was read.
struct VolumeFile {
    Volume volume;
    std::string format;  ///< "NRRD", "DICOM series", ...
    int time_steps = 1;  ///< number of volumes in the file
    std::vector<std::string>
        notes;                  ///< one sentence each: conversions, gaps, tilt, missing spacing
    double frame_interval = 0;  ///< [s] from one volume to the next. 0: not in the file
    double first_time = 0;      ///< [s] of the first volume
    ValueInfo values = {};
};

/// Reads a file, or a folder of DICOM or TIFF slices. Physical space is LPS, mm. Samples of uint8,
/// int16, uint16 and float32 keep their type; int8 becomes int16, anything wider float32, with a
/// note. Samples that are not finite become the least finite one, with a note.
/// The volume holds the samples once. Nothing else stays in memory.
/// Throws InputError, with a message of one line; SeriesChoice for a folder or file with several
/// DICOM series and none chosen.
VolumeFile read_volume(const std::filesystem::path& path, const ReadOptions& options = {});

struct WriteOptions {
    /// Compress the samples with zlib (NRRD, MetaImage, VTI, TIFF). NIfTI: if named .nii.gz.
    bool compress = false;
    Progress progress;
    std::filesystem::path helper;  ///< as in ReadOptions
    double time_limit_s = 0;       ///< as in ReadOptions, by the size of the samples
};

/// Writes one of written_extensions() (io/written_formats.hpp). The file appears under its name
/// only when it is complete (.nhdr and .mhd: data_file_of it before the header). MetaImage and
/// VTI store the geometry bit for bit, NRRD up to rounding of the last bit, NIfTI as 32-bit floats.
/// TIFF, with one page per slice, stores the spacing as 32-bit floats in ImageJ's description. Raw
/// stores none. These two refuse a volume with an origin or directions. Throws OutputError. An
/// existing file is then unchanged.
void write_volume(const Volume& volume, const std::filesystem::path& path,
                  const WriteOptions& options = {});

}  // namespace palpate::io
