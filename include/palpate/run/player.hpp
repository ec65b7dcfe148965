// Plays a sequence for one or several runs: sends their servos the frames around the play position
// as they are loaded, and seeks.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "palpate/io/frame_loader.hpp"
#include "palpate/io/live_frames.hpp"
#include "palpate/run/volume_editor.hpp"
#include "palpate/servo.hpp"

namespace palpate::run {

/// The state of a sequence, for a user interface. Times in s, those of the sequence.
struct PlayState {
    std::vector<double> frames;  ///< time of each
    double begin = 0, end = 0;   ///< in a loop, `end` is the time when the first comes again
    double time = 0;             ///< within begin and end
    double speed = 0;            ///< 0: paused
    bool loop = true;
    double loaded_from = 0, loaded_to = 0;  ///< the part in memory
    std::string problem;                    ///< why frames are missing
    bool live = false;  ///< a live source: `frames` are its last ones, and seek() throws
};

/// Any thread may call any function.
class Player {
  public:
    /// Throws std::invalid_argument as io::FrameLoader.
    Player(io::Sequence sequence, const io::LoaderSettings& settings, Pace pace = Pace::own_thread);
    /// The same for a live source: it can be paused and played, nothing else.
    explicit Player(std::shared_ptr<const io::LiveFrames> live, Pace pace = Pace::own_thread);
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// Follows the first servo that has not ended, and sends frames that were loaded. Its thread
    /// calls this every 5 ms.
    void step(std::chrono::steady_clock::time_point now);
    /// Starts a servo at the play position and keeps it up to date until detach(). Exceptions of
    /// `start` are passed on.
    std::unique_ptr<Servo> attach(Session session, const StartServo& start);
    void detach(const Servo& servo);
    /// As VolumeEditor::record().
    void record(const Servo& servo, const BeginRecording& begin);
    /// `speed` in seconds of the sequence per second, backwards if negative; 0 pauses. This and
    /// seek() try again to read frames that could not be read. Throws std::invalid_argument beyond
    /// 1000, and for a servo that takes no more commands.
    void play(double speed);
    /// Goes to a time of the sequence as soon as its frames are in memory. This, step() and
    /// set_loop() throw std::invalid_argument for a live source.
    void seek(double time);
    /// Moves by so many frames, backwards if negative, and pauses.
    void step(int frames);
    /// Whether the first frame follows the last. Reads the frames in memory again.
    void set_loop(bool on);

    PlayState state() const;
    /// Whether the frames that are needed now are in memory, or cannot be read; true for a live
    /// source.
    bool is_settled() const;
    /// Sets a field to the frames in memory and the play position.
    void apply_position(Field& field) const;

  private:
    /// An attached servo, and the version of the frames that it has got.
    struct Listener {
        Servo* servo;
        std::uint64_t version = 0;
    };

    void begin(Pace pace);
    void load();
    void update();
    bool send_frames();
    bool send_to_all(const Command& command);
    void show_sequence(PlayState& state) const;
    void show_live(PlayState& state) const;
    std::vector<Command> history() const;
    void set_speed(double speed);
    double within(double time) const;
    void require_sequence() const;
    std::shared_ptr<const Samples> newest() const;

    mutable std::mutex mutex_;
    const io::Sequence sequence_;
    io::LoaderSettings settings_;
    std::unique_ptr<io::FrameLoader> loader_;     // of a sequence
    std::shared_ptr<const io::LiveFrames> live_;  // of a live source
    std::vector<Listener> listeners_;
    double speed_ = 0;
    double time_ = 0;               // of the servo followed when last seen; laps included
    std::optional<double> target_;  // where to go once its frames are in memory
    command::Samples sent_;
    std::jthread thread_;  // last: it uses all of the above
};

}  // namespace palpate::run
