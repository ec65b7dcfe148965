// Frames that can be read one by one: the volumes of a 4-D file, the files of a numbered series,
// or whatever a function makes. See docs/sequences.md.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "palpate/io/volume_file.hpp"

namespace palpate::io {

/// The times of the frames, and a function that reads one. Holds no frame in memory.
struct Sequence {
    std::vector<double> times;  ///< [s] of the frames, rising
    double period = 0;          ///< [s] after which the first frame follows again, if it loops
    Geometry geometry;          ///< of every frame
    SampleType type = SampleType::uint8;
    /// Reads or makes a frame; its exceptions reach the caller of read_frame(). Called from one
    /// thread at a time.
    std::function<Volume(int frame, const Progress& progress)> reader;
    /// The name of a frame in messages; empty: "frame 3".
    std::function<std::string(int frame)> frame_name;

    int count() const { return static_cast<int>(times.size()); }
    std::uint64_t frame_bytes() const;
};

/// A sequence, its first frame, and notes on how they were read.
struct SequenceFile {
    Sequence sequence;
    Volume first;
    std::string format;
    std::vector<std::string> notes;  ///< one sentence each
    ValueInfo values = {};
};

struct SequenceOptions {
    /// As for one volume. In a series they apply to each file, `time_step` too; the volumes of one
    /// 4-D file are its frames whatever `time_step` is. `progress` is for the first frame.
    ReadOptions read;
    /// [s] from one frame to the next. Replaces that of the file. 0: the file's.
    double interval = 0;
};

/// Time between two frames if neither the file nor the caller gives it [s].
inline constexpr double assumed_frame_interval = 0.1;

/// A 4-D file, a volume (a sequence of one frame), or a series, which is a file name with one %d or
/// %03d in place of a number. %d is any number of digits, and %03d a number as printf writes it.
/// The files that match are the frames, in the order of their numbers. The least step between two
/// numbers is one interval, so that a missing file leaves a gap in time (and a note says so). Reads
/// the first frame. Throws InputError, std::invalid_argument for an invalid interval.
SequenceFile open_sequence(const std::filesystem::path& path, const SequenceOptions& options = {});

/// True if reading `source` reads the file `path`: itself, a slice, a frame or a part of a store.
/// Data files that a header names count, too.
bool is_read_from(const std::filesystem::path& path, const std::filesystem::path& source);

/// Frames made by `make`, `interval` [s] apart from time 0. Makes the first one to learn its grid
/// and type. Throws std::invalid_argument for a count below 1 or an interval that is not valid.
Sequence made_sequence(int count, double interval,
                       std::function<Volume(int frame, const Progress& progress)> make);

/// Frames of which the first has been read: `first.time_steps` of them, `interval` [s] apart; 0: as
/// `first` says, and if it does not, a note tells. Throws std::invalid_argument for an impossible
/// interval.
SequenceFile sequence_of(VolumeFile first, double interval,
                         std::function<Volume(int frame, const Progress& progress)> reader,
                         std::function<std::string(int frame)> frame_name);

/// A frame, on the grid and of the type that the sequence promises. Passes on exceptions of its
/// reader, and throws InputError with the frame and the difference.
Volume read_frame(const Sequence& sequence, int frame, const Progress& progress = {});

/// Throws std::invalid_argument, with the reason, unless there is a frame and a reader, times are
/// finite and rising, and the period ends after the last frame.
void check(const Sequence& sequence);

/// Whether a path names a series: its file name has a place for a number, and no file has exactly
/// this name.
bool names_a_series(const std::filesystem::path& path);

}  // namespace palpate::io
