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

/// Throws io::OutputError in the cases in which convert_to_zarr() would, before there is anything
/// to write: `out` exists, or its folder does not exist or cannot be written.
void check_zarr_place(const std::filesystem::path& out);

/// Writes a level of `from` and coarser ones below it, each the mean of 2 samples along the axes
/// with the smaller spacing, until one chunk holds the whole. Works in OUT.partial, whose result
/// becomes OUT when all is written and on the disk. Each chunk is read back and compared when it is
/// written. The next run with the same content of the source and the same options continues an
/// interrupted run. It keeps complete chunks, which it recognises by their checksum. (Zarr 2 has
/// none for blosc and for chunks without compression. There, a chunk is complete if it unpacks and
/// is not all zeros.) Any other run begins anew. OUT must not exist. If OUT.partial exists, it must
/// be of such a run. Throws io::OutputError, std::invalid_argument for options, and passes on
/// exceptions of the store.
Converted convert_to_zarr(const Store& from, int level, const std::filesystem::path& out,
                          const ConvertOptions& options);

/// Writes a level as one file. A .raw, or an .nrrd without compression, is written in bounded
/// memory. The other io::written_extensions() need the volume in memory. Throws as
/// io::write_volume() does, and passes on exceptions of the store.
void write_plain(const Store& from, int level, const std::filesystem::path& out,
                 const io::WriteOptions& options);

}  // namespace palpate::stream

template <>
inline constexpr auto palpate::names_of<palpate::stream::Compression> =
    palpate::enum_names("compression", "none", "gzip", "zstd", "blosc");
