// Frames from the loader to the servos, and where to go from the caller to both.
#include "palpate/run/player.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/system/stepping_thread.hpp"

namespace palpate::run {
namespace {

using namespace std::chrono_literals;

/// Between two looks at the servo.
constexpr auto between_looks = 5ms;
/// [s] A live source that gives no frame for so long is reported.
constexpr double longest_silence = 2;

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

Player::Player(io::Sequence sequence, const io::LoaderSettings& settings, Pace pace)
    : sequence_(std::move(sequence)), settings_(settings), time_(sequence_.times.front()) {
    load();
    begin(pace);
}

Player::Player(std::shared_ptr<const io::LiveFrames> live, Pace pace) : live_(std::move(live)) {
    settings_.loop = false;
    begin(pace);
}

Player::~Player() = default;

void Player::begin(Pace pace) {
    if (pace == Pace::by_steps) return;
    thread_ = io::stepping_thread(between_looks, [this](io::SteadyTime now) { step(now); });
}

std::unique_ptr<Servo> Player::attach(Session session, const StartServo& start) {
    const std::scoped_lock lock(mutex_);
    if (sent_.samples) apply(session, sent_);
    apply(session, command::Moment{time_});
    apply(session, command::Speed{speed_});
    std::unique_ptr<Servo> servo = start(std::move(session), history());
    listeners_.push_back({servo.get(), sent_.version});
    return servo;
}

void Player::detach(const Servo& servo) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(listeners_, [&](const Listener& l) { return l.servo == &servo; });
}

void Player::record(const Servo& servo, const BeginRecording& begin) {
    const std::scoped_lock lock(mutex_);
    const bool lacks = std::ranges::any_of(listeners_, [&](const Listener& listener) {
        return listener.servo == &servo && listener.version != sent_.version;
    });
    if (lacks) throw std::runtime_error(takes_no_commands);
    begin(history());
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
    if (loader_) loader_->retry();  // frames that could not be read may be there by now
    target_ = std::clamp(time, sequence_.times.front(), sequence_.times.back());
    if (settings_.loop && time > *target_) target_ = within(time);
}

void Player::step(int frames) {
    require_sequence();
    const std::scoped_lock lock(mutex_);
    set_speed(0);
    const double now = within(target_.value_or(time_));
    const std::vector<double>& times = sequence_.times;
    // Between two frames a step on goes to the next one, a step back to the one before.
    const auto before =
        std::upper_bound(times.begin(), times.end(), now + 1e-9) - times.begin() - 1;
    const bool on_frame = before >= 0 && std::abs(now - times[std::size_t(before)]) <= 1e-9;
    const auto count = static_cast<std::ptrdiff_t>(times.size());
    std::ptrdiff_t to = before + frames + (frames < 0 && !on_frame ? 1 : 0);
    to = settings_.loop ? (to % count + count) % count
                        : std::clamp<std::ptrdiff_t>(to, 0, count - 1);
    target_ = times[std::size_t(to)];
}

void Player::set_loop(bool on) {
    require_sequence();
    const std::scoped_lock lock(mutex_);
    if (on == settings_.loop) return;
    target_ = within(target_.value_or(time_));
    settings_.loop = on;
    loader_.reset();  // frees its frames first
    load();
}

/// Without memory or a thread there is no loader yet: the next step tries again.
void Player::load() {
    if (!live_ && !loader_) loader_ = std::make_unique<io::FrameLoader>(sequence_, settings_);
}

/// A time with laps as one of the sequence.
double Player::within(double time) const {
    if (live_) return time;
    const double begin = sequence_.times.front();
    if (!settings_.loop || !(sequence_.period > 0)) return time;
    const double into = std::fmod(time - begin, sequence_.period);
    return begin + (into < 0 ? into + sequence_.period : into);
}

PlayState Player::state() const {
    const std::scoped_lock lock(mutex_);
    PlayState state;
    state.speed = speed_;
    if (live_) {
        show_live(state);
    } else {
        show_sequence(state);
    }
    return state;
}

bool Player::is_settled() const {
    const std::scoped_lock lock(mutex_);
    if (live_) return true;
    return loader_ && loader_->status().settled && loader_->newest() == sent_.samples;
}

void Player::show_live(PlayState& state) const {
    state.live = true;
    state.loop = false;
    state.time = time_;
    const io::LiveStatus status = live_->status();
    state.problem = status.problem;
    if (state.problem.empty() && status.ended) state.problem = "the live source has ended";
    if (state.problem.empty() && status.age > longest_silence) {
        state.problem = "the live source is silent: no frame for more than 2 s";
    }
    if (!sent_.samples) return;
    for (const Frame& frame : sent_.samples->frames()) state.frames.push_back(frame.time);
    state.begin = state.loaded_from = state.frames.front();
    state.end = state.loaded_to = state.frames.back();
}

void Player::show_sequence(PlayState& state) const {
    state.frames = sequence_.times;
    state.begin = sequence_.times.front();
    state.end = settings_.loop ? state.begin + sequence_.period : sequence_.times.back();
    state.time = within(target_.value_or(time_));
    state.loop = settings_.loop;
    if (loader_) state.problem = loader_->problem();
    if (const Samples* samples = sent_.samples.get()) {
        const bool all = samples->frames().size() >= sequence_.times.size();
        state.loaded_from = all ? state.begin : within(samples->frames().front().time);
        state.loaded_to = all ? state.end : within(samples->frames().back().time);
    }
}

void Player::apply_position(Field& field) const {
    const std::scoped_lock lock(mutex_);
    if (sent_.samples) field.use(sent_.samples);
    field.set_time(time_);
}

/// Commands that a recording needs before its first tick.
std::vector<Command> Player::history() const {
    std::vector<Command> history;
    if (sent_.samples) history.push_back(command::Samples{nullptr, sent_.version, sent_.recipe});
    history.push_back(command::Moment{time_});
    history.push_back(command::Speed{speed_});
    return history;
}

void Player::set_speed(double speed) {
    if (!send_to_all(command::Speed{speed})) {
        throw std::invalid_argument("too many commands at once: this one was left out");
    }
    speed_ = speed;
}

void Player::step(io::SteadyTime /*now*/) {
    const std::scoped_lock lock(mutex_);
    try {
        update();
    } catch (const std::exception&) {  // no memory: tried again in a moment
    }
}

std::shared_ptr<const Samples> Player::newest() const {
    return live_ ? live_->newest() : loader_->newest();
}

bool Player::send_to_all(const Command& command) {
    bool all = true;
    for (const Listener& listener : listeners_) all &= listener.servo->send(command);
    return all;
}

/// The newest frames to every servo that does not have them; false if one takes no commands now.
bool Player::send_frames() {
    for (Listener& listener : listeners_) {
        if (listener.version == sent_.version) continue;
        if (!listener.servo->send(sent_)) return false;
        listener.version = sent_.version;
    }
    return true;
}

void Player::update() {
    load();
    const auto first = std::ranges::find_if(
        listeners_, [](const Listener& listener) { return !listener.servo->has_ended(); });
    if (first != listeners_.end()) {
        if (const auto now = first->servo->snapshot()) time_ = now->session.moment;
    }
    if (loader_) loader_->look(target_.value_or(time_), speed_);
    const std::shared_ptr<const Samples> newest = this->newest();
    if (!newest || listeners_.empty()) return;
    // While a live source is paused, new frames would push the moment ahead of the old ones.
    if (live_ && speed_ == 0 && sent_.samples) return;
    if (newest != sent_.samples) {
        // Frames of a live source are not in a recording and cannot be made again.
        sent_ = {newest, sent_.version + 1, live_ ? nullptr : recipe_of(*newest)};
    }
    if (!send_frames()) return;
    if (target_ && (covers(*newest, *target_) || loader_->status().settled)) {
        if (!send_to_all(command::Moment{*target_})) return;
        time_ = *target_;
        target_.reset();
    }
}

}  // namespace palpate::run
