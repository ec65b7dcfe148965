// A store of samples that are read by the box: big plain files, OME-Zarr, N5, HDF5, on disk or
// behind HTTP, at several levels of detail. Nothing is held but what is asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/samples.hpp"

namespace palpate::stream {

/// One level of detail: a grid over the same part of space as the others.
struct Level {
    Geometry geometry;  ///< physical space (LPS, mm), like that of a volume
    Index3 chunk;       ///< samples of a stored piece along each axis: cheapest to read as a whole
};

/// Bounds of the samples [data units].
struct Range {
    double minimum = 0;
    double maximum = 0;
};

struct StoreInfo {
    std::string address;  ///< as it was opened
    std::string format;   ///< "OME-Zarr 0.5", "NRRD", "raw", ...
    SampleType type = SampleType::uint8;
    std::vector<Level> levels;               ///< at least one, finest first
    double fill = 0;                         ///< [data units] of pieces that are not stored
    std::optional<Range> range;              ///< of the finest level, where the store says it
    std::vector<std::string> channels = {};  ///< names; empty: one, without a name
    int times = 1;
    double frame_interval = 0;            ///< [s] between two times; 0: the store does not say
    std::vector<std::string> notes = {};  ///< one sentence each, for people
    int channel = 0, time = 0;            ///< that were chosen
};

/// What was asked of disk or network so far.
struct Traffic {
    std::uint64_t requests = 0;
    std::uint64_t bytes = 0;  ///< as they came, compressed
    std::uint64_t retries = 0;
    std::uint64_t cached = 0;  ///< pieces found in the disk cache
};

struct StoreOptions {
    std::optional<io::RawLayout> raw;  ///< of a file without a header
    std::optional<Vec3> spacing;       ///< [mm] instead of what the store gives or lacks
    std::string orientation = {};      ///< the same, as io::direction_from() takes it
    int channel = 0;
    int time = 0;
    std::filesystem::path cache_folder = {};  ///< disk cache of remote stores; empty: none
    std::uint64_t cache_bytes = 0;            ///< most that the disk cache holds
    int requests = 32;                        ///< most requests at a time to one host
    double timeout_s = 10;                    ///< of one request
    int attempts = 5;                         ///< of one request, with growing pauses
    /// A chunk for which a server answers 403 counts as not stored: S3 says so to those who may not
    /// list the bucket.
    bool forbidden_is_missing = false;
    /// [bytes] Most that chunks take while they are unpacked; one that takes more is an error.
    /// 0: a quarter of this machine's memory.
    std::uint64_t unpacking = 0;
};

/// Safe to use from several threads at a time.
class Store {
  public:
    virtual ~Store() = default;
    virtual const StoreInfo& info() const = 0;
    /// Reads a box of samples, both corners in it, all inside the level's grid, into `out`
    /// (size_of(type) bytes a sample, x fastest). All of them are finite. Blocks. Throws
    /// io::InputError if a piece is damaged or, after all attempts, cannot be had; Cancelled as
    /// soon as `stop` is requested.
    virtual void read(int level, const SampleBox& box, std::span<std::byte> out,
                      std::stop_token stop) const = 0;
    virtual Traffic traffic() const = 0;
};

using io::Cancelled;  ///< What read() throws when it was asked to stop.

/// Throws std::invalid_argument for a level that the store does not have.
const Level& level_of(const Store& store, int level);

/// All samples of a level. Blocks; this thread calls `progress`, which may throw to stop, all the
/// time. Throws as level_of() and Store::read(), and io::InputError for a level that is larger than
/// this machine's memory.
Volume read_level(const Store& store, int level, const io::Progress& progress = {});

/// True if an address names something that open_store() reads by the box: a web address, a folder
/// or file of a chunked format, or a plain file whose samples lie in it uncompressed. Reads at
/// most a file's header.
bool is_store(const std::string& address, const StoreOptions& options = {});

/// True if it is one of these and no plain file: one that is read by the box without being asked
/// for.
bool is_chunked(const std::string& address);

/// Opens a file, a folder, or an http://, https:// or s3:// address. Reads headers only. This
/// thread calls `progress`, which may throw to stop, all the time. Throws io::InputError: what is
/// wrong and what to do, one line.
std::shared_ptr<const Store> open_store(const std::string& address,
                                        const StoreOptions& options = {},
                                        const io::Progress& progress = {});

}  // namespace palpate::stream
