// Edits the samples of one or several runs: a brush that follows each proxy, single edits, undo and
// redo. The servos use an edit within two ticks.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
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

/// Any thread may call any function. state() does not wait for an edit. Only apply() waits for
/// samples of a store: an edit without all of its samples begins again when they have loaded, and
/// other edits may come before it meanwhile. Functions that edit wait for edits under way. If
/// `progress` is given, another thread does the work, and `progress` is called regularly meanwhile.
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
    /// losing an edit. Edits wait until `start` returns. Its exceptions are passed on.
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
    /// The brush of every attached servo. Nothing: no brush. Throws as check().
    void set_brush(const std::optional<HandBrush>& brush);
    /// Makes an edit, one step for undo(). Throws std::invalid_argument as check(Edit) does and for
    /// one that takes more memory than there is, std::runtime_error for a servo that takes no
    /// commands, and io::InputError for samples that cannot be read. Passes on exceptions of
    /// `progress`.
    void apply(const Edit& edit, const OnProgress& progress = {});
    /// False if there is nothing to undo, or redo. A brush that touches then pauses until it has
    /// left the surface or set_brush() is called. Otherwise it would undo the undo.
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
        bool lacks = false;     // it took no command when the newest version was sent
        std::shared_ptr<const ToolBody> body = {};  // of the tool, for the last sweep
    };
    /// The samples that an edit reads, by the low corner of the box.
    using Fetched = std::map<std::array<int, 3>, std::vector<std::byte>>;
    static constexpr std::size_t first_forgetting = 1024;
    struct Version {
        std::weak_ptr<const Samples> samples;  // expired once undo cannot come back to them
        command::Samples recipe;               // without samples, with the number
    };

    VolumeEditor(std::shared_ptr<const Samples> samples, Streamer* streamer, std::uint64_t memory,
                 Pace pace, std::size_t most_versions);
    void forget_versions();
    using Lock = std::unique_lock<std::mutex>;
    Lock locked(const std::stop_token& stop);
    template <class Work>
    void with_samples(Lock& lock, const std::stop_token& stop, const OnProgress& tell, Work&& work);
    void fetch(const std::shared_ptr<const Samples>& samples, const Edit& edit, Fetched& fetched,
               const std::stop_token& stop, const OnProgress& tell) const;
    void read(const SampleBox& box, std::span<std::byte> out);
    void run(const std::stop_token& stop);
    void brush(Hand& hand, std::chrono::steady_clock::time_point now);
    bool brush_from(const Touch& from, const Touch& to, Hand& hand, double isovalue);
    Edit edit_of(const Brush& brush, const Touch& from, const Touch& to, Hand& hand);
    void edit(const Edit& edit, EditStep step, const OnProgress& progress = {});
    bool go_to(SampleBox changed);
    void send(const command::Samples& command);
    std::uint64_t version_of(const std::shared_ptr<const Samples>& samples) const;
    std::vector<Command> history() const;
    void set_problem(const std::string& problem);
    void publish();

    mutable std::mutex mutex_;        // for as long as an edit takes, not while it is read for
    mutable std::mutex state_mutex_;  // of state_; a moment
    EditState state_;
    Streamer* const streamer_;        // null: all samples are in memory
    const std::uint64_t memory_;      // [bytes] of a volume that is read as it is felt
    std::uint64_t edited_bytes_ = 0;  // of that, in the bricks that are edited now
    std::stop_source reading_;
    Fetched* fetched_ = nullptr;  // by the call that has the lock and edits
    Editor editor_;
    std::vector<Hand> hands_;
    std::optional<HandBrush> brush_;
    std::condition_variable_any brush_taken_up_;
    bool new_step_ = true;  // the next change by a brush begins a step for undo
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
