// Plays a sequence in a running session: hands the servo the frames round the play position as they
// come into memory, and goes where it is asked to, from a thread of its own.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "palpate/io/frame_loader.hpp"
#include "palpate/io/live_frames.hpp"
#include "palpate/servo.hpp"

namespace palpate::app {

/// How a sequence stands, for who shows it. Times in s, those of the sequence.
struct PlayView {
    std::vector<double> frames;  ///< when each is
    double begin = 0, end = 0;   ///< of a loop, `end` is when the first comes again
    double time = 0;             ///< within begin and end
    double speed = 0;            ///< 0: it stands still
    bool loop = true;
    double loaded_from = 0, loaded_to = 0;  ///< what is in memory
    std::string problem;                    ///< why frames are missing
    bool live = false;  ///< from another program: `frames` are the last ones, nowhere to go
};

/// Any thread may call anything.
class Player {
  public:
    /// Throws std::invalid_argument as io::FrameLoader.
    Player(io::Sequence sequence, const io::LoaderSettings& settings);
    /// The same for what another program pushes: it can be held and let go, no more.
    explicit Player(std::shared_ptr<const io::LiveFrames> live);
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// Whom to watch and to tell; it must stay until the next attach(). Null: nobody.
    void attach(Servo* servo);
    /// At so many seconds a second, backwards if negative; 0 stops. This and seek() try frames
    /// again that could not be read. Throws std::invalid_argument beyond 1000, and
    /// where the servo takes no more commands.
    void play(double speed);
    /// To a time of the sequence, as soon as its frames are in memory. This and what follows throws
    /// std::invalid_argument for a live source.
    void seek(double time);
    /// So many frames on, or back, and stops there.
    void step(int frames);
    /// Whether the first frame follows the last. What is in memory is read anew.
    void set_loop(bool on);

    PlayView view() const;
    /// Brings a session that is about to run to where play is.
    void bring(Session& session) const;
    /// What a recording needs to know before its first tick.
    std::vector<Command> history() const;

  private:
    void run(const std::stop_token& stop);
    void attend();
    void set_speed(double speed);
    double within(double time) const;
    void require_sequence() const;
    std::shared_ptr<const Samples> newest() const;

    mutable std::mutex mutex_;
    const io::Sequence sequence_;
    io::LoaderSettings settings_;
    std::unique_ptr<io::FrameLoader> loader_;     // of a sequence
    std::shared_ptr<const io::LiveFrames> live_;  // of a live source
    Servo* servo_ = nullptr;
    double speed_ = 0;
    double time_ = 0;               // as the session told it last; laps included
    std::optional<double> wanted_;  // where to go once its frames are there
    command::Samples sent_;
    std::jthread thread_;
};

}  // namespace palpate::app
