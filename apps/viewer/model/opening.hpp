// A volume that is ready to be shown and felt, and guesses about a file without a header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "palpate/filters/dequantize.hpp"
#include "palpate/io/series.hpp"
#include "palpate/io/tool_file.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/run/source.hpp"
#include "palpate/run/statistics.hpp"

namespace palpate::viewer {

struct Opened {
    run::LoadedVolume loaded;
    run::Histogram histogram;  ///< of 256 bins, as `palpate info`
    /// What rounding does to its surfaces; nothing where it has no levels, was dequantized, or is a
    /// store.
    std::optional<filters::Terraces> terraces = {};

    /// When the file was written that was read; the earliest time for other sources.
    std::filesystem::file_time_type written = std::filesystem::file_time_type::min();
    /// The command line's tool with its points for this grid, if making them takes time.
    std::optional<io::PointsSpec> tool = {};

    /// The grey levels that the file suggests, or those between which nearly all samples lie [data
    /// units].
    double dark() const;
    double bright() const;
};

/// Whether its file was written since it was opened.
bool is_outdated(const Opened& opened);

/// Reads the volume and counts its samples. `progress` may throw to stop. Throws as run::load().
Opened open(const run::Source& source, const io::Progress& progress);

/// The level to begin with: the synthetic volume's own, else the first that the histogram suggests.
/// Throws std::invalid_argument for constant data, in which there is nothing to feel.
double first_isovalue(const Opened& opened);

/// Whether it is a file whose name says that it has no header (.raw, .bin, .dat, also packed), and
/// its layout was not given.
bool lacks_layout(const run::Source& source);

/// The layout that a file's name tells ("head_256x256x113_uint16.raw", "-be": big-endian), else a
/// cube that fits its `bytes`, else 256^3 samples of a byte.
io::RawLayout guessed_layout(const std::filesystem::path& path, std::uint64_t bytes);

/// Bytes that the samples and what is skipped before them take.
double bytes_of(const io::RawLayout& layout);

/// Slice `z` in grey: its least sample black, its greatest white. Nothing for a packed file, one
/// that ends before the slice does, or a slice of more than 256 MB.
std::optional<io::Thumbnail> raw_slice(const std::filesystem::path& path,
                                       const io::RawLayout& layout, int z);

}  // namespace palpate::viewer
