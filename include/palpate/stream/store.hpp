// A store of samples that are read box by box: big plain files, OME-Zarr, N5, HDF5, TIFF, on disk
// or over HTTP, at several levels of detail. A store keeps no samples in memory.
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
    std::optional<Range> range;              ///< of the finest level, if the store gives it
    std::vector<std::string> channels = {};  ///< names; empty: one, without a name
    int times = 1;
    double frame_interval = 0;            ///< [s] between two times; 0: not in the store
    std::vector<std::string> notes = {};  ///< one sentence each, for people
    int channel = 0, time = 0;            ///< that were chosen
};

/// The requests to disk or network so far.
struct Traffic {
    std::uint64_t requests = 0;
    std::uint64_t bytes = 0;  ///< as received, compressed
    std::uint64_t retries = 0;
    std::uint64_t cached = 0;  ///< pieces found in the disk cache
};

struct StoreOptions {
    std::optional<io::RawLayout> raw;  ///< of a file without a header
    std::optional<Vec3> spacing;       ///< [mm] replaces the spacing of the store
    std::string orientation = {};      ///< the same, as io::direction_from() takes it
    int channel = 0;
    int time = 0;
    std::filesystem::path cache_folder = {};  ///< disk cache of remote stores; empty: none
    std::uint64_t cache_bytes = 0;            ///< most that the disk cache holds
    int requests = 32;                        ///< most requests at a time to one host
    double timeout_s = 10;                    ///< of one request
    int attempts = 5;                         ///< of one request, with growing pauses
    /// A chunk for which a server answers 403 counts as not stored. S3 gives this answer to readers
    /// who may not list the bucket.
    bool forbidden_is_missing = false;
    /// [bytes] Memory limit for unpacking chunks. A chunk that needs more is an error. 0: a quarter
    /// of this machine's memory.
    std::uint64_t unpacking = 0;
};

/// Safe to use from several threads at a time.
class Store {
  public:
    virtual ~Store() = default;
    virtual const StoreInfo& info() const = 0;
    /// Reads a box of samples, both corners included, all inside the level's grid, into `out`
    /// (size_of(type) bytes per sample, x fastest). All of them are finite. Blocks. Throws
    /// io::InputError if a piece is damaged or cannot be read after all attempts, Cancelled as soon
    /// as `stop` is requested.
    virtual void read(int level, const SampleBox& box, std::span<std::byte> out,
                      std::stop_token stop) const = 0;
    virtual Traffic traffic() const = 0;
};

using io::Cancelled;  ///< read() throws this when it is stopped.

/// Throws std::invalid_argument for a level that the store does not have.
const Level& level_of(const Store& store, int level);

/// All samples of a level. Blocks. This thread calls `progress` repeatedly, which may throw to
/// stop. Throws as level_of() and Store::read(), and io::InputError for a level that is larger than
/// this machine's memory.
Volume read_level(const Store& store, int level, const io::Progress& progress = {});

/// True if open_store() can read this address box by box: a web address, a folder or file of a
/// chunked format, or a plain file with uncompressed samples. Reads at most a file's header.
bool is_store(const std::string& address, const StoreOptions& options = {});

/// True if it is one of these but not a plain file, so that it is always read box by box.
bool is_chunked(const std::string& address);

/// Opens a file, a folder, or an http://, https:// or s3:// address. Reads headers only. This
/// thread calls `progress` repeatedly, which may throw to stop. Throws io::InputError, with the
/// fault and the remedy in one line.
std::shared_ptr<const Store> open_store(const std::string& address,
                                        const StoreOptions& options = {},
                                        const io::Progress& progress = {});

}  // namespace palpate::stream
