// Writes a level of a store as multiscale OME-Zarr or as a plain file, in bounded memory.
#pragma once

#include <filesystem>

#include "palpate/names.hpp"
#include "palpate/stream/store.hpp"

namespace palpate::stream {

enum class Compression { none, gzip, zstd, blosc };

struct ConvertOptions {
    int zarr_version = 3;  ///< 3: OME-Zarr 0.5; 2: OME-Zarr 0.4
    int chunk = 64;        ///< samples of a chunk along each axis, 8 to 512
    Compression compression = Compression::zstd;
    int threads = 2;        ///< each holds a few chunks
    bool resumable = true;  ///< false: an interrupted run leaves nothing to continue
    io::Progress progress;  ///< if it throws, the work stops and can be continued later
};

struct Converted {
    int levels = 0;
    std::uint64_t chunks = 0;  ///< of all levels
    std::uint64_t kept = 0;    ///< of these, from an earlier run that was interrupted
    std::uint64_t empty = 0;   ///< of these, not stored because all their samples are 0
    Range range = {};          ///< of the finest level [data units]
    std::string note = {};     ///< if an interrupted run was removed, or the source was touched
};

/// A volume as a store of one level.
std::shared_ptr<const Store> store_of(Volume volume, std::string name);

/// Throws io::OutputError where convert_to_zarr() would, before there is anything to write: `out`
/// is there, or its folder is not or cannot be written.
void check_zarr_place(const std::filesystem::path& out);

/// Writes a level of `from` and coarser ones below it, each the mean of 2 samples along the axes
/// with the smaller spacing, until one chunk holds the whole. Works in OUT.partial, whose result
/// becomes OUT when all is written and on the disk. Each chunk is read back and compared when it is
/// written. A run that was interrupted is continued by the next one with the same content of the
/// source and the same options: what is complete, seen by its checksum or by unpacking it, is kept.
/// Other work begins anew. OUT must not exist, and OUT.partial must be of such a run, if it does.
/// Throws io::OutputError, std::invalid_argument for options, and what the store throws.
Converted convert_to_zarr(const Store& from, int level, const std::filesystem::path& out,
                          const ConvertOptions& options);

/// Writes a level as one file. A .raw, or an .nrrd without compression, in bounded memory; every
/// other of io::written_extensions() through a volume in memory, as io::write_volume(). Throws as
/// that, and what the store throws.
void write_plain(const Store& from, int level, const std::filesystem::path& out,
                 const io::WriteOptions& options);

}  // namespace palpate::stream

template <>
inline constexpr auto palpate::names_of<palpate::stream::Compression> =
    palpate::enum_names("compression", "none", "gzip", "zstd", "blosc");
