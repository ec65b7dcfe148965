// Follows the hands of one or several runs that feel a store, and sends their servos the bricks
// round them as they come into memory. It works in a thread of its own.
#pragma once

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
    /// Of a volume with a store. Throws std::invalid_argument as stream::BrickLoader.
    explicit Streamer(const LoadedVolume& loaded);
    ~Streamer();
    Streamer(const Streamer&) = delete;
    Streamer& operator=(const Streamer&) = delete;

    /// Starts a servo with what is in memory and keeps it up to date until detach(). What `start`
    /// throws is passed on.
    std::unique_ptr<Servo> attach(Session session, const StartServo& start);
    void detach(const Servo& servo);
    /// What the servos feel now.
    std::shared_ptr<const Samples> samples() const;
    stream::BrickLoaderStatus status() const { return loader_.status(); }

  private:
    /// An attached servo, what it has got, and where its hand was.
    struct Hand {
        Servo* servo;
        std::uint64_t version = 0;
        std::int64_t tick = -1;
        double time = 0;               // [s]
        Vec3 at = Vec3::Zero();        // [mm, physical]
        Vec3 velocity = Vec3::Zero();  // [mm/s], low-pass filtered
    };

    void run(const std::stop_token& stop);
    void look();
    void take();
    void send();
    command::Samples history() const;

    stream::BrickLoader loader_;
    mutable std::mutex mutex_;
    std::vector<Hand> hands_;
    std::vector<command::Samples> versions_;  // those that a servo may not have got yet, in order
    command::Samples newest_;
    std::map<std::array<int, 3>, int> present_;  // level of each brick in memory
    std::jthread thread_;                        // last: it uses all of the above
};

}  // namespace palpate::run
