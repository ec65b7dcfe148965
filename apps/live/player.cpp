// From the loader to the servo, and from people to both.
#include "apps/live/player.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace palpate::app {
namespace {

using namespace std::chrono_literals;

constexpr auto between_looks = 5ms;
/// [s] A live source that gives no frame for so long is told of.
constexpr double silent = 2;

bool covers(const Samples& samples, double time) {
    return samples.within(time) == time;
}

std::shared_ptr<const Recipe> recipe_of(const Samples& samples) {
    FramesOf frames;
    for (const Frame& frame : samples.frames()) {
        frames.numbers.push_back(frame.number);
        frames.times.push_back(frame.time);
    }
    frames.period = samples.period();
    return std::make_shared<const Recipe>(std::move(frames));
}

}  // namespace

Player::Player(io::Sequence sequence, const io::LoaderSettings& settings)
    : sequence_(std::move(sequence)),
      settings_(settings),
      loader_(std::make_unique<io::FrameLoader>(sequence_, settings_)),
      time_(sequence_.times.front()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Player::Player(std::shared_ptr<const io::LiveFrames> live) : live_(std::move(live)) {
    settings_.loop = false;
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Player::~Player() {
    thread_.request_stop();
    thread_.join();
}

void Player::attach(Servo* servo) {
    const std::scoped_lock lock(mutex_);
    servo_ = servo;
}

void Player::play(double speed) {
    if (!(std::abs(speed) <= 1000)) {
        throw std::invalid_argument("a sequence is played at most 1000 times as fast");
    }
    const std::scoped_lock lock(mutex_);
    set_speed(speed);
    if (loader_ && speed != 0) loader_->retry();
}

void Player::require_sequence() const {
    if (live_) {
        throw std::invalid_argument(
            "a live source goes its own way: it can be paused and played, no more");
    }
}

void Player::seek(double time) {
    require_sequence();
    if (!std::isfinite(time)) throw std::invalid_argument("the time is not finite");
    const std::scoped_lock lock(mutex_);
    loader_->retry();  // what could not be read may be there by now
    wanted_ = std::clamp(time, sequence_.times.front(), sequence_.times.back());
    if (settings_.loop && time > *wanted_) wanted_ = within(time);
}

void Player::step(int frames) {
    require_sequence();
    const std::scoped_lock lock(mutex_);
    set_speed(0);
    const double now = within(wanted_.value_or(time_));
    const std::vector<double>& times = sequence_.times;
    // Between two frames a step on is to the next, a step back to the one before.
    const auto before =
        std::upper_bound(times.begin(), times.end(), now + 1e-9) - times.begin() - 1;
    const bool on_frame = before >= 0 && std::abs(now - times[std::size_t(before)]) <= 1e-9;
    const auto count = static_cast<std::ptrdiff_t>(times.size());
    std::ptrdiff_t to = before + frames + (frames < 0 && !on_frame ? 1 : 0);
    to = settings_.loop ? (to % count + count) % count
                        : std::clamp<std::ptrdiff_t>(to, 0, count - 1);
    wanted_ = times[std::size_t(to)];
}

void Player::set_loop(bool on) {
    require_sequence();
    const std::scoped_lock lock(mutex_);
    if (on == settings_.loop) return;
    wanted_ = within(wanted_.value_or(time_));
    settings_.loop = on;
    loader_.reset();  // first let go of its frames
    loader_ = std::make_unique<io::FrameLoader>(sequence_, settings_);
}

/// A time with laps as one of the sequence.
double Player::within(double time) const {
    if (live_) return time;
    const double begin = sequence_.times.front();
    if (!settings_.loop || !(sequence_.period > 0)) return time;
    const double into = std::fmod(time - begin, sequence_.period);
    return begin + (into < 0 ? into + sequence_.period : into);
}

PlayView Player::view() const {
    const std::scoped_lock lock(mutex_);
    PlayView view;
    if (live_) {
        view.live = true;
        view.loop = false;
        view.speed = speed_;
        view.time = time_;
        const io::LiveStatus status = live_->status();
        view.problem = status.problem;
        if (view.problem.empty() && status.ended) view.problem = "the live source has ended";
        if (view.problem.empty() && status.age > silent) {
            view.problem = "the live source is silent: no frame came for more than 2 s";
        }
        if (!sent_.samples) return view;
        for (const Frame& frame : sent_.samples->frames()) view.frames.push_back(frame.time);
        view.begin = view.loaded_from = view.frames.front();
        view.end = view.loaded_to = view.frames.back();
        return view;
    }
    view.frames = sequence_.times;
    view.begin = sequence_.times.front();
    view.end = settings_.loop ? view.begin + sequence_.period : sequence_.times.back();
    view.time = within(wanted_.value_or(time_));
    view.speed = speed_;
    view.loop = settings_.loop;
    view.problem = loader_->problem();
    if (const Samples* samples = sent_.samples.get()) {
        const bool all = samples->frames().size() >= sequence_.times.size();
        view.loaded_from = all ? view.begin : within(samples->frames().front().time);
        view.loaded_to = all ? view.end : within(samples->frames().back().time);
    }
    return view;
}

void Player::bring(Session& session) const {
    const std::scoped_lock lock(mutex_);
    if (sent_.samples) apply(session, sent_);
    apply(session, command::Moment{time_});
    apply(session, command::Speed{speed_});
}

std::vector<Command> Player::history() const {
    const std::scoped_lock lock(mutex_);
    std::vector<Command> history;
    if (sent_.samples) history.push_back(command::Samples{nullptr, sent_.version, sent_.recipe});
    history.push_back(command::Moment{time_});
    history.push_back(command::Speed{speed_});
    return history;
}

void Player::set_speed(double speed) {
    if (servo_ && !servo_->send(command::Speed{speed})) {
        throw std::invalid_argument("too many commands at once: this one was left out");
    }
    speed_ = speed;
}

void Player::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::this_thread::sleep_for(between_looks);
        const std::scoped_lock lock(mutex_);
        try {
            attend();
        } catch (const std::exception&) {  // no memory: again in a moment
        }
    }
}

std::shared_ptr<const Samples> Player::newest() const {
    return live_ ? live_->newest() : loader_->newest();
}

void Player::attend() {
    if (servo_) {
        if (const auto now = servo_->snapshot()) time_ = now->session.moment;
    }
    if (loader_) loader_->look(wanted_.value_or(time_), speed_);
    const std::shared_ptr<const Samples> newest = this->newest();
    if (!newest || !servo_) return;
    // Held: the frames that come meanwhile would push the moment ahead of them.
    if (live_ && speed_ == 0 && sent_.samples) return;
    if (newest != sent_.samples) {
        // What comes from outside cannot be made again.
        const command::Samples next{newest, sent_.version + 1,
                                    live_ ? nullptr : recipe_of(*newest)};
        if (!servo_->send(next)) return;  // again in a moment
        sent_ = next;
    }
    if (wanted_ && (covers(*newest, *wanted_) || loader_->status().settled)) {
        if (!servo_->send(command::Moment{*wanted_})) return;
        time_ = *wanted_;
        wanted_.reset();
    }
}

}  // namespace palpate::app
