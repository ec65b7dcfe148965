// Tells the loader where the hands are, and passes on the samples that it has loaded.
#include "palpate/run/streamer.hpp"

#include <algorithm>
#include <stdexcept>

#include "io/system/stepping_thread.hpp"

namespace palpate::run {
namespace {

/// Between two looks at hands and loader.
constexpr std::chrono::milliseconds interval{5};

}  // namespace

Streamer::Streamer(const LoadedVolume& loaded, Pace pace)
    : loader_(loaded.streamed->store, loaded.volume, loaded.streamed->loader),
      edits_(loader_.empty()),
      bricks_(*loader_.empty()->resident()) {
    newest_.samples = loader_.empty();
    if (pace == Pace::by_steps) return;
    thread_ = io::stepping_thread(interval, [this](io::SteadyTime now) { step(now); });
}

Streamer::~Streamer() = default;

std::unique_ptr<Servo> Streamer::attach(Session session, const StartServo& start,
                                        std::vector<Command> edits) {
    const std::scoped_lock lock(mutex_);
    if (newest_.samples != loader_.empty()) apply(session, newest_);
    std::unique_ptr<Servo> servo = start(std::move(session), history(std::move(edits)));
    hands_.push_back({.servo = servo.get(), .got = first_ + versions_.size()});
    return servo;
}

void Streamer::detach(const Servo& servo) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(hands_, [&](const Hand& hand) { return hand.servo == &servo; });
}

void Streamer::record(const Servo& servo, const BeginRecording& begin, std::vector<Command> edits) {
    const std::scoped_lock lock(mutex_);
    send();
    const bool lacks = std::ranges::any_of(hands_, [&](const Hand& hand) {
        return hand.servo == &servo && hand.got < first_ + versions_.size();
    });
    if (lacks) throw std::runtime_error(takes_no_commands);
    begin(history(std::move(edits)));
}

std::shared_ptr<const Samples> Streamer::samples() const {
    const std::scoped_lock lock(mutex_);
    return newest_.samples;
}

std::uint64_t Streamer::next_version() const {
    const std::scoped_lock lock(mutex_);
    return last_ + 1;
}

void Streamer::use(const command::Samples& edits) {
    const std::scoped_lock lock(mutex_);
    edits_ = edits.samples;
    publish(edits.version, edits.recipe);
    send();
}

/// Commands for a recording that begins now: the edits, and all that is in memory. The last one has
/// the number of the newest version.
std::vector<Command> Streamer::history(std::vector<Command> edits) const {
    std::vector<Command> all = std::move(edits);
    if (bricks_version_ == 0) return all;
    BricksOf bricks;
    for (const auto& [at, level] : present_) {
        bricks.bricks.push_back({{at[0], at[1], at[2]}, level});
    }
    const command::Samples memory{nullptr, bricks_version_,
                                  std::make_shared<const Recipe>(std::move(bricks))};
    all.insert(newest_.version == bricks_version_ ? all.end() : all.begin(), memory);
    return all;
}

void Streamer::step(io::SteadyTime now) {
    const std::scoped_lock lock(mutex_);
    try {
        look(now);
        take();
        send();
    } catch (const std::exception&) {  // no memory: tried again in a moment
    }
}

/// Tells the loader where the hands are.
void Streamer::look(io::SteadyTime now) {
    std::vector<stream::Interest> interests;
    for (Hand& hand : hands_) {
        const auto felt = hand.servo->snapshot();
        if (!felt || hand.servo->has_ended()) continue;  // memory is for those that go on
        const Tick& tick = felt->session.tick;
        hand.motion.see(tick.time, tick.proxy.hip);
        interests.push_back({tick.proxy.scp, tick.proxy.hip, hand.motion.velocity});
    }
    if (!interests.empty()) loader_.look(interests, now);
}

/// Makes a version of what came into memory and went.
void Streamer::take() {
    auto loaded = loader_.take();
    if (!loaded) return;
    BricksOf recipe{bricks_version_, {}};
    for (const stream::BrickEvent& event : loaded->events) {
        recipe.bricks.push_back({event.brick, event.level});
        const std::array<int, 3> at{event.brick[0], event.brick[1], event.brick[2]};
        if (event.level < 0) {
            present_.erase(at);
        } else {
            present_[at] = event.level;
        }
    }
    bricks_ = *loaded->samples->resident();
    bricks_version_ = last_ + 1;
    publish(bricks_version_, std::make_shared<const Recipe>(std::move(recipe)));
}

/// Puts edits and bricks together.
void Streamer::publish(std::uint64_t version, std::shared_ptr<const Recipe> recipe) {
    last_ = std::max(last_, version);
    newest_ = {std::make_shared<const Samples>(edits_->with(bricks_)), version, std::move(recipe)};
    versions_.push_back(newest_);
}

/// Every version to every servo, in order, because a recording needs each step.
void Streamer::send() {
    const std::uint64_t all = first_ + versions_.size();
    for (Hand& hand : hands_) {
        while (hand.got < all && hand.servo->send(versions_[hand.got - first_])) ++hand.got;
    }
    while (!versions_.empty() &&
           std::ranges::all_of(hands_, [&](const Hand& hand) { return hand.got > first_; })) {
        versions_.pop_front();
        ++first_;
    }
}

}  // namespace palpate::run
