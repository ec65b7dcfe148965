// The source of the data (a file, a sequence, a synthetic volume, or frames that another program
// sends), and its loading.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "palpate/io/live_frames.hpp"
#include "palpate/io/sequence.hpp"
#include "palpate/stream/edits.hpp"
#include "palpate/stream/loader.hpp"

namespace palpate::run {

/// A file, a folder of slices, or a numbered series (heart_%03d.nrrd).
struct FileSource {
    std::string path;
    std::optional<io::RawLayout> raw;  ///< of a file without a header
    std::optional<Vec3> spacing;       ///< [mm] replaces the spacing of the file
    std::string series;                ///< DICOM series: UID or number. Empty: the only one
    std::string orientation = {};      ///< instead of the file's: io::direction_from()
};
/// A volume that scenes::make_volume() makes.
struct SyntheticSource {
    std::string scene;  ///< "torus" or "torus:64x64x64"
    std::optional<SampleType> type;
};
/// Frames that another program writes to this file (docs/changing_data.md).
struct LiveSource {
    std::string path;
};

/// A store that is read in parts, because it is too large for memory or on another machine
/// (docs/streaming.md).
struct StoreSource {
    std::string address;
    stream::StoreOptions options;  ///< its `time` is Source::frame
    stream::BrickLoaderSettings loader;
    /// A sequence of all its times, each read whole at the loader's level when it is due.
    bool all_times = false;
    /// The address comes from a file, in which passwords and queries are left out (to_names()).
    bool lacks_secrets = false;
};

struct Source {
    std::variant<FileSource, SyntheticSource, LiveSource, StoreSource> from;
    std::optional<int> frame;              ///< only this frame of a sequence, from 0
    std::optional<double> frame_interval;  ///< [s] replaces that of the file
    int smooth = 0;                        ///< passes of the binomial kernel, see smoothed()
    int dequantize = 0;      ///< before that: rounds, see filters::dequantized(). 0: none
    bool prefilter = false;  ///< after all that, see sharpened()
    /// [bytes] Limit for the samples of a file that is read whole. 0: the memory of this machine.
    std::uint64_t most_bytes = 0;
};

/// As a user writes it: "head.nrrd", "synthetic:torus", "live:frames.shm".
std::string name_of(const Source& source);
/// The file, folder or numbered series of a source. Empty for sources of other kinds.
std::filesystem::path place_of(const Source& source);
/// The inverse. Everything else has its default.
Source source_named(const std::string& name);

/// The names and values under which recordings and session files keep a source. "volume" is its
/// name. The others are "dims", "type", "spacing", "orientation", "skip", "byte-order", "series",
/// "time-step", "level", "channel", "memory" [bytes, of the process], "coarse-first", "all-times",
/// "forbidden-is-missing", "frame-interval", "smooth", "dequantize" and "prefilter". Missing
/// options are left out, and so is a cache, which is local. Web addresses are without password
/// and query (io::address_to_keep()). If they had one, "secrets" says "left out".
std::map<std::string, std::string> to_names(const Source& source);
/// The inverse. Unknown names are ignored, and numbers that cannot be read count as missing. Throws
/// std::invalid_argument for an impossible layout, and for values that this kind of source does not
/// have.
Source source_from(const std::map<std::string, std::string>& names);

/// A store and the settings of its loader.
struct StreamedVolume {
    std::shared_ptr<const stream::Store> store;
    stream::BrickLoaderSettings loader;
    stream::Opened opened = {};  ///< an absolute address. Its content if it is on this machine
};

/// A volume and the facts about it.
struct LoadedVolume {
    /// The volume. For a sequence its first frame, for a live source the frame that it began with,
    /// for a store its overview.
    Volume volume;
    Source source;
    std::string name;
    std::string format = {};
    std::vector<std::string> notes = {};              ///< for people, a sentence each
    io::ValueInfo values = {};                        ///< from the header
    std::optional<double> isovalue = {};              ///< a good one, of a synthetic volume
    io::Sequence sequence = {};                       ///< empty unless there are several frames
    std::shared_ptr<const io::LiveFrames> live = {};  ///< null unless it is a live source
    int time_steps = 1;                           ///< number of frames, whether requested or not
    std::optional<StreamedVolume> streamed = {};  ///< of a store
};

/// The samples with which a field of a loaded volume begins. For a store, none are in memory yet.
std::shared_ptr<const Samples> start_samples(const LoadedVolume& loaded);

/// Reads or makes the volume. `progress` may throw to stop. Throws std::invalid_argument for an
/// impossible source, io::InputError for one that cannot be read.
LoadedVolume load(const Source& source, const io::Progress& progress = {});

}  // namespace palpate::run
