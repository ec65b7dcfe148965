// Frames that can be read one by one: the volumes of a 4-D file, the files of a numbered series,
// or whatever a function makes. See docs/sequences.md.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "palpate/io/volume_file.hpp"

namespace palpate::io {

/// Which frames there are, when, and how to get one. A value; nothing of it is in memory yet.
struct Sequence {
    std::vector<double> times;  ///< [s] of the frames, rising
    double period = 0;          ///< [s] from the first frame to when it comes again, if it loops
    Geometry geometry;          ///< of every frame
    SampleType type = SampleType::uint8;
    /// Reads or makes a frame; what it throws goes on to who reads. Called from one thread at a
    /// time.
    std::function<Volume(int frame, const Progress& progress)> reader;
    /// What a person calls a frame; empty: "frame 3".
    std::function<std::string(int frame)> frame_name;

    int count() const { return static_cast<int>(times.size()); }
    std::uint64_t frame_bytes() const;
};

/// A sequence, its first frame, and what there is to say about how both were found.
struct SequenceFile {
    Sequence sequence;
    Volume first;
    std::string format;
    std::vector<std::string> notes;  ///< one sentence each
};

struct SequenceOptions {
    /// As for one volume. In a series they hold for each file, `time_step` too; the volumes of one
    /// 4-D file are its frames whatever `time_step` is. `progress` is for the first frame.
    ReadOptions read;
    /// [s] from one frame to the next, instead of what the file gives or lacks; 0: the file's.
    double interval = 0;
};

/// What is taken where neither file nor caller say how much time lies between two frames [s].
inline constexpr double assumed_frame_interval = 0.1;

/// A 4-D file, a volume (a sequence of one frame), or a series: a file name with one %d or %03d in
/// place of a number. %d is any number of digits, %03d a number as printf writes it; the files that
/// match are the frames, by number. The least step between two numbers is one interval, so that
/// where files are missing time goes on (and a note says so). Reads the first frame. Throws
/// InputError, std::invalid_argument for an interval that is none.
SequenceFile open_sequence(const std::filesystem::path& path, const SequenceOptions& options = {});

/// Frames that `make` makes, `interval` [s] apart from time 0. Makes the first one to see its grid
/// and type. Throws std::invalid_argument for a count below 1 or an interval that is none.
Sequence made_sequence(int count, double interval,
                       std::function<Volume(int frame, const Progress& progress)> make);

/// A frame, on the grid and of the type that the sequence promises. Throws what its reader throws,
/// and InputError that names the frame and what differs.
Volume read_frame(const Sequence& sequence, int frame, const Progress& progress = {});

/// Throws std::invalid_argument, saying what is wrong, unless there is a frame and a reader, times
/// are finite and rising, and the period ends after the last frame.
void check(const Sequence& sequence);

/// Whether a path stands for a series: its file name has a number's place, and no file is called
/// just that.
bool names_a_series(const std::filesystem::path& path);

}  // namespace palpate::io
