// Recordings of live sessions, of one hand or several: a trace with a head that describes the
// session, the device's readings in each tick, and the commands between ticks. Rendered again, a
// recording gives the same ticks bit for bit (`palpate replay --validate`), so it is the best bug
// report. Format: docs/recordings.md.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/progress.hpp"
#include "palpate/servo.hpp"

namespace palpate::io {

/// The volume of a recording.
struct VolumeIdentity {
    /// How to open it again: "volume" is its name as it was given. The others are options of the
    /// command line without their dashes.
    std::map<std::string, std::string> options;
    Index3 size = Index3::Zero();
    SampleType type = SampleType::uint8;
    std::uint32_t crc32 = 0;  ///< of the samples in memory
};
/// Exceptions of `progress` are passed on.
VolumeIdentity identify(const Volume& volume, std::map<std::string, std::string> options,
                        const OnProgress& progress = {});

/// A session of one hand at its start.
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

/// Writes a recording while the session runs. The file has its final name from the start and is
/// flushed to disk twice a second, so that at most the last second is lost, however the program
/// ends. An existing file is never changed. Hands are numbered from 1, and each may have its own
/// thread.
class RecordingWriter {
  public:
    /// Creates the file and writes the head. Throws OutputError: the file exists, or cannot be
    /// written.
    RecordingWriter(const std::filesystem::path& path, const RecordingHead& head,
                    Pace pace = Pace::own_thread)
        : RecordingWriter(path, std::span(&head, 1), pace) {}
    /// The same for several hands that feel one volume, at least one.
    RecordingWriter(const std::filesystem::path& path, std::span<const RecordingHead> heads,
                    Pace pace = Pace::own_thread);
    /// finish(), but silent.
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    /// Writes the content of the queues. The writer's thread calls this ten times a second, and
    /// another thread flushes the file to disk. With Pace::by_steps there are no threads.
    void step();
    /// Adds commands before the content of the hand's queue. Call it before the servo uses the
    /// queue.
    void begin_with(std::vector<Command> commands, int hand = 1);
    /// Sets the moment of the hand's time 0 [ns, of a clock that all hands share]. If every hand
    /// has one, the recording stores how far apart they began.
    void set_begin(std::int64_t ns, int hand = 1);
    /// The queue into which the hand's servo puts its ticks. It has room for eight seconds.
    Queue<SessionEvent>& queue(int hand = 1) { return of(hand).queue; }
    /// The reason why nothing is written any more (for example a full disk), or empty. Everything
    /// written before remains. Any thread.
    std::string problem() const;
    /// Ticks of the hand that were written or are being written.
    std::int64_t ticks(int hand = 1) const;
    /// Call it once for each hand, after its servo has stopped: it writes the rest of its events.
    /// `lost`: number of events that were lost before they reached the writer. For the last hand it
    /// writes the last line, which marks a complete recording. Throws OutputError with problem().
    /// `progress` is called while the reader of a pipe is waited for. If it throws, the rest is
    /// given up, the pipe is closed, and the exception is passed on. Without it, the reader has
    /// half a second.
    void finish(std::int64_t lost, int hand = 1, const OnProgress& progress = {});

  private:
    struct Hand {
        explicit Hand(std::size_t room) : queue(room) {}
        Queue<SessionEvent> queue;
        std::vector<Command> first;
        std::optional<std::int64_t> begin;  // [ns]
    };

    Hand& of(int hand) { return *hands_[static_cast<std::size_t>(hand - 1)]; }
    std::unique_lock<std::mutex> locked_file(const OnProgress& wait);
    void end_threads();
    void keep_on_disk() const;
    std::vector<double> begins();
    void drain(int hand, const OnProgress& wait = {});
    void flush(const OnProgress& wait = {});
    int pass_on(std::string_view& rest, const OnProgress& wait);
    void close();

    std::filesystem::path path_;
    std::vector<std::unique_ptr<Hand>> hands_;
    std::mutex file_mutex_;  // of what follows, for as long as the disk takes
    int descriptor_ = -1;
    std::unique_ptr<RecordingText> text_;
    std::int64_t written_ = 0;  // bytes that are whole lines on the disk
    bool seekable_ = false;
    std::size_t ended_ = 0;  // hands
    std::int64_t lost_ = 0;
    std::exception_ptr given_up_;        // by finish(): the exception of its `progress`
    std::atomic<bool> gives_up_{false};  // the reader of a pipe. Any thread
    mutable std::mutex
        mutex_;  // of problem_, Hand::first and Hand::begin. The servo never takes it
    std::string problem_;
    std::jthread thread_, syncer_;
};

/// The head of a recording (of its first hand), without reading the rest. Throws as the constructor
/// of RecordingReader does for the head.
RecordingHead read_recording_head(const std::filesystem::path& path);

/// Reads one hand of a recording event by event, like the recording of a single session. An
/// incomplete last line is ignored. Throws InputError if ticks or commands of any hand were
/// removed, added, moved or changed since the recording was made.
class RecordingReader {
  public:
    /// Throws InputError: no recording, a later format, a head that is not valid, no such hand.
    explicit RecordingReader(const std::filesystem::path& path, int hand = 1);
    /// The same from text that errors call `name`.
    RecordingReader(std::string text, const std::string& name, int hand = 1);
    ~RecordingReader();

    /// How many there are.
    int hands() const { return hands_; }
    const RecordingHead& head() const { return head_; }
    /// The next event. Nothing at the end. Throws InputError for a line that is not valid.
    std::optional<SessionEvent> next();
    /// The line of the last event from next() in the file, from 1.
    std::size_t line() const;
    /// How much of the file was read, 0 to 1.
    double progress() const;
    /// After the last event: the recording was finished, not cut off.
    bool complete() const;
    /// After the last event: how long after time 0 of the first hand that of this one was [s].
    /// Nothing if the recording does not contain it.
    std::optional<double> begin() const;
    /// True if ticks are numbered and have a checksum of all events up to them. Otherwise (format
    /// 1), only ticks that are missing from a complete recording are noticed.
    bool has_checksums() const;
    /// After the last event: the number of events, of all hands, that were lost while the recording
    /// was made.
    std::int64_t lost() const;

  private:
    struct Rows;
    RecordingHead head_;
    int hands_ = 1;
    std::unique_ptr<Rows> rows_;
};

}  // namespace palpate::io
