// Recordings of live sessions: a trace with a head that says everything about the session, the
// device's own readings beside each tick, and the commands between them. Rendered again, a
// recording gives the same ticks bit for bit (`palpate replay --validate`), so a bug report is a
// recording. Format: docs/recordings.md.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/servo.hpp"

namespace palpate::io {

/// Which volume it was.
struct VolumeIdentity {
    /// How to open it again: "volume" is its name as it was given, the rest are options of the
    /// command line without their dashes.
    std::map<std::string, std::string> options;
    Index3 size = Index3::Zero();
    SampleType type = SampleType::uint8;
    std::uint32_t crc32 = 0;  ///< of the samples in memory
};
VolumeIdentity identify(const Volume& volume, std::map<std::string, std::string> options);

/// What a session was at its start.
struct RecordingHead {
    std::string version;  ///< of the program that recorded
    std::string begun;    ///< date and time, ISO 8601
    VolumeIdentity volume;
    Solid solid = Solid::above;
    Interpolation interpolation = Interpolation::linear;
    double background = 0;
    double isovalue = 0;
    std::string device;         ///< name and model
    double rate = 1000;         ///< [Hz]
    std::string method;         ///< of the proxy, by name
    RendererSettings settings;  ///< but for `method`, and a penetrability function
    SessionSettings session;
};

class RecordingText;

/// Writes a recording while the session runs. The file has its own name from the start and is
/// brought to the disk twice a second, so that whatever ends the program, all but the last second
/// is there. An existing file is never touched.
class RecordingWriter {
  public:
    /// Creates the file and writes the head. Throws OutputError: the file exists, or cannot be
    /// written.
    RecordingWriter(const std::filesystem::path& path, const RecordingHead& head,
                    Pace pace = Pace::own_thread);
    /// finish(), but silent.
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    /// Writes what is in the queue. Its thread calls this ten times a second, and a second one
    /// brings the file to the disk; with Pace::by_steps there is neither.
    void step();
    /// Commands before all that is in the queue, and before the servo uses it.
    void begin_with(std::vector<Command> commands);
    /// The queue into which the servo puts its ticks. It has room for eight seconds.
    Queue<SessionEvent>& queue() { return queue_; }
    /// Why nothing is written any more (a full disk). Empty while all is well. What was written
    /// stays. Any thread.
    std::string problem() const;
    /// Ticks on the disk or on their way to it.
    std::int64_t ticks() const;
    /// Writes what is left and the last line, which tells a whole recording from one cut off, with
    /// the number of events that were lost on their way here. After the servo has stopped. Throws
    /// OutputError for what problem() says.
    void finish(std::int64_t lost);

  private:
    void end_threads();
    void drain();
    void flush();
    void close();

    std::filesystem::path path_;
    int descriptor_ = -1;
    Queue<SessionEvent> queue_;
    std::unique_ptr<RecordingText> text_;
    std::int64_t written_ = 0;  // bytes that are whole lines on the disk
    bool seekable_ = false;
    mutable std::mutex mutex_;  // of what follows. The servo never comes near
    std::string problem_;
    std::vector<Command> first_;
    std::jthread thread_, syncer_;
};

/// What a recording says of itself, without reading all of it. Throws as the constructor of
/// RecordingReader does because of the head.
RecordingHead read_recording_head(const std::filesystem::path& path);

/// Reads a recording event by event. A last line that is not whole is left out. Ticks and commands
/// that were removed, added, moved or changed since the recording was made are an InputError.
class RecordingReader {
  public:
    /// Throws InputError: no recording, a later format, a head that is not valid.
    explicit RecordingReader(const std::filesystem::path& path);
    /// The same from text that errors call `name`.
    RecordingReader(std::string text, const std::string& name);
    ~RecordingReader();

    const RecordingHead& head() const { return head_; }
    /// The next event. Nothing at the end. Throws InputError for a line that is not valid.
    std::optional<SessionEvent> next();
    /// The line of the file that next() gave last, from 1.
    std::size_t line() const;
    /// How much of the file was read, 0 to 1.
    double progress() const;
    /// After the last event: the recording was finished, not cut off.
    bool complete() const;
    /// Ticks are numbered and carry a checksum of all events up to them. Without (format 1), only
    /// ticks missing from a complete recording are noticed.
    bool has_checksums() const;
    /// After the last event: events that the recording lost while it was made.
    std::int64_t lost() const;

  private:
    struct Rows;
    RecordingHead head_;
    std::unique_ptr<Rows> rows_;
};

}  // namespace palpate::io
