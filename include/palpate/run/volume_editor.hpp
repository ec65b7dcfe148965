// Edits the samples of one or several runs: a brush that follows each proxy, single edits, undo and
// redo. The servos use an edit within two ticks.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "palpate/edit.hpp"
#include "palpate/run/brush.hpp"
#include "palpate/servo.hpp"

namespace palpate::run {

/// The edited samples at one moment.
struct EditState {
    std::shared_ptr<const Samples> samples;
    std::uint64_t version = 0;  ///< the same as in snapshots
    std::size_t undo_steps = 0, redo_steps = 0;
    bool changed = false;      ///< since the start, or since they were saved
    std::string problem = {};  ///< why the brush has no effect although it touches. Usually empty
};

/// Starts a servo with this session, which has the newest data. `history` is what a recording needs
/// before its first tick: every version that it may meet by its recipe, without samples, and the
/// one felt.
using StartServo =
    std::function<std::unique_ptr<Servo>(Session session, const std::vector<Command>& history)>;
inline constexpr const char* takes_no_commands = "the session takes no commands";
/// Begins a recording of a servo that has received everything up to the end of this history, and
/// receives nothing else meanwhile.
using BeginRecording = std::function<void(const std::vector<Command>& history)>;

class Streamer;

/// Any thread may call any function. Only apply() waits until its edit is computed and the samples
/// that it needs have been read. The other functions do not wait for edits. If the samples change
/// while an edit is computed, it is computed again. If `progress` is given, another thread does the
/// work, and `progress` is called regularly meanwhile.
class VolumeEditor {
  public:
    /// Enough for a brush that works for seven minutes (30 MB).
    static constexpr std::size_t usual_versions = 100'000;

    /// `most_versions`: number of versions whose recipes are kept.
    explicit VolumeEditor(std::shared_ptr<const Samples> samples, Pace pace = Pace::own_thread,
                          std::size_t most_versions = usual_versions);
    /// Edits a streamed volume: an edit waits for the samples that it changes. Edits take at most a
    /// quarter of `memory` [bytes], and undo() an eighth. `streamer`
    /// outlives this and sends the versions; `samples` are those without any brick.
    VolumeEditor(std::shared_ptr<const Samples> samples, Streamer& streamer, std::uint64_t memory,
                 Pace pace = Pace::own_thread);
    ~VolumeEditor();
    VolumeEditor(const VolumeEditor&) = delete;
    VolumeEditor& operator=(const VolumeEditor&) = delete;

    /// Applies the brush where the proxy touches. The editor's thread calls this every 4 ms while
    /// there is a brush.
    void step(std::chrono::steady_clock::time_point now);
    /// Starts a servo with the present samples and keeps it up to date until detach(), without
    /// losing an edit. All other functions wait until `start` returns. Its exceptions are passed
    /// on.
    std::unique_ptr<Servo> attach(Session session, const StartServo& start);
    /// No effect for a servo that is not attached.
    void detach(const Servo& servo);
    /// For an attached servo. Throws std::runtime_error, and does not begin, if it takes no
    /// commands.
    void record(const Servo& servo, const BeginRecording& begin);
    /// After a command with which the hand of this servo may touch although it did not move. `tool`
    /// is its tool from now on (null: a point). The brush pauses until the tool has left the
    /// surface. The brush of a servo that was just attached pauses too. No effect for a servo that
    /// is not attached.
    void rest_brush(const Servo& servo, const std::shared_ptr<const Tool>& tool);
    /// The brush of every attached servo. Nothing: no brush. A stroke that is being computed is
    /// dropped. Throws as check().
    void set_brush(const std::optional<HandBrush>& brush);
    /// Makes an edit, one step for undo(). Servos that take no commands at the moment get it later.
    /// Throws std::invalid_argument as check(Edit) does and for one that takes more memory than
    /// there is, and io::InputError for samples that cannot be read. Passes on exceptions of
    /// `progress`.
    void apply(const Edit& edit, const OnProgress& progress = {});
    /// False if there is nothing to undo, or redo. A brush that touches then pauses until it has
    /// left the surface or set_brush() is called. Otherwise it would undo the undo. An edit that is
    /// being computed comes afterwards.
    bool undo(const OnProgress& progress = {});
    bool redo(const OnProgress& progress = {});

    /// False after so many edits that some are no longer known. StartServo then gets only the
    /// others.
    bool knows_history() const;
    EditState state() const;
    /// These samples were written to a file.
    void set_saved(const std::shared_ptr<const Samples>& samples);

  private:
    /// The proxy when it was last seen in contact.
    struct Touch {
        Pose at;          ///< of the tool; of a point its place
        double time = 0;  ///< [s] of the session
        std::int64_t tick = -1;
    };
    /// An attached servo and its brush.
    struct Hand {
        Servo* servo;
        Field field;  // for its solid side and background
        std::shared_ptr<const Tool> tool;
        std::optional<Touch> touch = {};
        bool resting = false;   // until it was in the air: it may touch without having moved
        std::int64_t from = 0;  // the first tick that surely follows the command of rest_brush()
        std::deque<command::Samples> waiting = {};  // for a servo that takes no commands now
        std::shared_ptr<const ToolBody> body = {};  // of the tool, for the last sweep
    };
    /// The samples that an edit reads, by the low corner of the box.
    using Fetched = std::map<std::array<int, 3>, std::vector<std::byte>>;
    /// Memory that is freed when the lock has been released, because that may take long.
    struct Later {
        Editor::Versions versions;
        Fetched fetched;
    };
    /// An edit of the version `from`.
    struct Computed {
        std::uint64_t from;
        Edited edited;
    };
    static constexpr std::size_t first_forgetting = 1024;
    struct Version {
        std::weak_ptr<const Samples> samples;  // expired once undo cannot come back to them
        command::Samples recipe;               // without samples, with the number
    };

    VolumeEditor(std::shared_ptr<const Samples> samples, Streamer* streamer, std::uint64_t memory,
                 Pace pace, std::size_t most_versions);
    void forget_versions();
    using Lock = std::unique_lock<std::mutex>;
    static Lock locked(std::mutex& mutex, const std::stop_token& stop);
    Computed computed(Lock& lock, const Edit& edit, Later& later, const std::stop_token& stop,
                      const OnProgress& tell);
    Edited compute(const std::shared_ptr<const Samples>& before, const Edit& edit, Fetched& fetched,
                   const std::stop_token& stop, const OnProgress& tell) const;
    bool use(Computed computed, const Edit& edit, EditStep step, Later& later);
    void interrupt_brush();
    void run(const std::stop_token& stop);
    void brush(Lock& lock, std::size_t hand, Later& later,
               std::chrono::steady_clock::time_point now, const std::stop_token& stop);
    bool brush_to(Lock& lock, std::size_t hand, const Touch& to, double isovalue, Later& later,
                  const std::stop_token& stop);
    Edit edit_of(Lock& lock, const Brush& brush, const Pose& from, const Pose& to, std::size_t hand,
                 const std::stop_token& stop);
    bool go_to(SampleBox changed);
    void send(const command::Samples& command);
    bool send_waiting();
    std::uint64_t version_of(const std::shared_ptr<const Samples>& samples) const;
    std::vector<Command> history() const;
    void set_problem(const std::string& problem);
    void publish();

    mutable std::mutex mutex_;        // never while an edit is computed
    std::mutex turn_;                 // of an edit that begins again. Taken before mutex_
    mutable std::mutex state_mutex_;  // of state_; a moment
    EditState state_;
    Streamer* const streamer_;    // null: all samples are in memory
    const std::uint64_t memory_;  // [bytes] of a volume that is read as it is felt
    std::stop_source brushing_;   // of the stroke that is being computed
    Editor editor_;
    std::vector<Hand> hands_;
    std::optional<HandBrush> brush_;
    std::condition_variable_any has_work_;  // a brush, or versions for servos that took none
    bool new_step_ = true;                  // the next change by a brush begins a step for undo
    std::chrono::steady_clock::time_point last_change_;  // by a brush
    std::string problem_;
    std::vector<Version> versions_;  // in order. The first has number 0
    std::uint64_t last_version_ = 0;
    const std::size_t most_versions_;
    std::size_t forget_at_;  // so many versions
    bool knows_history_ = true;
    std::jthread thread_;  // last: it uses all of the above
};

}  // namespace palpate::run
