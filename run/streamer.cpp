// Where the hands are, and what came into memory round them.
#include "palpate/run/streamer.hpp"

#include <algorithm>
#include <chrono>

namespace palpate::run {
namespace {

/// Between two looks at hands and loader.
constexpr std::chrono::milliseconds interval{5};
/// Of the hand's velocity [s].
constexpr double smoothing = 0.05;

}  // namespace

Streamer::Streamer(const LoadedVolume& loaded)
    : loader_(loaded.streamed->store, loaded.volume, loaded.streamed->loader) {
    newest_.samples = loader_.empty();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Streamer::~Streamer() {
    thread_.request_stop();
    thread_.join();
}

std::unique_ptr<Servo> Streamer::attach(Session session, const StartServo& start) {
    const std::scoped_lock lock(mutex_);
    if (newest_.version > 0) apply(session, newest_);
    std::vector<Command> begin;
    if (newest_.version > 0) begin.push_back(history());
    std::unique_ptr<Servo> servo = start(std::move(session), begin);
    hands_.push_back({.servo = servo.get(), .version = newest_.version});
    return servo;
}

void Streamer::detach(const Servo& servo) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(hands_, [&](const Hand& hand) { return hand.servo == &servo; });
}

std::shared_ptr<const Samples> Streamer::samples() const {
    const std::scoped_lock lock(mutex_);
    return newest_.samples;
}

/// What a recording that begins now needs: all that is in memory.
command::Samples Streamer::history() const {
    BricksOf all;
    for (const auto& [at, level] : present_) all.bricks.push_back({{at[0], at[1], at[2]}, level});
    return {nullptr, newest_.version, std::make_shared<const Recipe>(std::move(all))};
}

void Streamer::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::this_thread::sleep_for(interval);
        const std::scoped_lock lock(mutex_);
        try {
            look();
            take();
            send();
        } catch (const std::exception&) {  // no memory: tried again in a moment
        }
    }
}

/// Tells the loader where the hands are.
void Streamer::look() {
    std::vector<stream::Interest> interests;
    for (Hand& hand : hands_) {
        const auto now = hand.servo->snapshot();
        if (!now) continue;
        const Tick& tick = now->session.tick;
        const double passed = tick.time - hand.time;
        if (hand.tick >= 0 && passed > 0) {
            const Vec3 velocity = (tick.proxy.hip - hand.at) / passed;
            hand.velocity += std::min(1.0, passed / smoothing) * (velocity - hand.velocity);
        }
        hand.tick = now->number;
        hand.time = tick.time;
        hand.at = tick.proxy.hip;
        interests.push_back({tick.proxy.scp, tick.proxy.hip, hand.velocity});
    }
    if (!interests.empty()) loader_.look(interests);
}

/// Makes a version of what came into memory and went.
void Streamer::take() {
    auto loaded = loader_.take();
    if (!loaded) return;
    BricksOf recipe{newest_.version, {}};
    for (const stream::BrickEvent& event : loaded->events) {
        recipe.bricks.push_back({event.brick, event.level});
        const std::array<int, 3> at{event.brick[0], event.brick[1], event.brick[2]};
        if (event.level < 0) {
            present_.erase(at);
        } else {
            present_[at] = event.level;
        }
    }
    newest_ = {std::move(loaded->samples), newest_.version + 1,
               std::make_shared<const Recipe>(std::move(recipe))};
    versions_.push_back(newest_);
}

/// Every version to every servo, in order, because a recording needs each step.
void Streamer::send() {
    for (Hand& hand : hands_) {
        for (const command::Samples& version : versions_) {
            if (version.version <= hand.version) continue;
            if (!hand.servo->send(version)) break;
            hand.version = version.version;
        }
    }
    std::erase_if(versions_, [&](const command::Samples& version) {
        return std::ranges::all_of(
            hands_, [&](const Hand& hand) { return hand.version >= version.version; });
    });
}

}  // namespace palpate::run
