// Follows the hands of one or several runs that touch a store, and sends their servos the bricks
// around the hands when these are in memory, with the edits.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "palpate/run/source.hpp"
#include "palpate/run/volume_editor.hpp"
#include "palpate/servo.hpp"

namespace palpate::run {

/// Any thread may call any function.
class Streamer {
  public:
    /// Streams a volume with a store. Throws std::invalid_argument as stream::BrickLoader.
    explicit Streamer(const LoadedVolume& loaded, Pace pace = Pace::own_thread);
    ~Streamer();
    Streamer(const Streamer&) = delete;
    Streamer& operator=(const Streamer&) = delete;

    /// Follows the hands and sends the bricks that have arrived. Its thread calls this every 5 ms.
    void step(std::chrono::steady_clock::time_point now);
    /// Starts a servo with the bricks in memory and keeps it up to date until detach(). `edits`:
    /// the edits that a recording needs before its first tick (StartServo). Exceptions of `start`
    /// are passed on.
    std::unique_ptr<Servo> attach(Session session, const StartServo& start,
                                  std::vector<Command> edits = {});
    void detach(const Servo& servo);
    /// As VolumeEditor::record().
    void record(const Servo& servo, const BeginRecording& begin, std::vector<Command> edits);
    /// The number for the next edit. Versions of bricks and of edits are numbered together.
    std::uint64_t next_version() const;
    /// Applies these edits from now on. `edits.samples` has no bricks in memory. A servo that takes
    /// no commands at the moment gets them later.
    void use(const command::Samples& edits);
    /// Samples before all edits, see stream::BrickLoader.
    void read(const SampleBox& box, std::span<std::byte> out, std::stop_token stop) {
        loader_.read(box, out, std::move(stop));
    }
    void leave_room(std::uint64_t bytes) { loader_.leave_room(bytes); }
    /// The samples that the servos use now.
    std::shared_ptr<const Samples> samples() const;
    stream::BrickLoaderStatus status() const { return loader_.status(); }

  private:
    /// An attached servo, the number of versions that it has got, and the motion of its hand.
    struct Hand {
        Servo* servo;
        std::uint64_t got = 0;
        stream::HandMotion motion = {};
    };

    void look(std::chrono::steady_clock::time_point now);
    void take();
    void send();
    void publish(std::uint64_t version, std::shared_ptr<const Recipe> recipe);
    std::vector<Command> history(std::vector<Command> edits) const;

    stream::BrickLoader loader_;
    mutable std::mutex mutex_;
    std::vector<Hand> hands_;
    std::deque<command::Samples> versions_;  // those that a servo may not have got yet
    std::uint64_t first_ = 0;                // how many versions there were before those
    command::Samples newest_;
    std::uint64_t last_ = 0;                // greatest number of a version so far
    std::uint64_t bricks_version_ = 0;      // number of the last that brought bricks
    std::shared_ptr<const Samples> edits_;  // no bricks in memory
    ResidentBricks bricks_;
    std::map<std::array<int, 3>, int> present_;  // level of each brick in memory
    std::jthread thread_;                        // last: it uses all of the above
};

}  // namespace palpate::run
