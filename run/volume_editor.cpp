// Edits, their versions, and the brushes of the attached servos.
#include "palpate/run/volume_editor.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <set>
#include <stdexcept>
#include <utility>

#include "palpate/run/streamer.hpp"
#include "stream/while_telling.hpp"

namespace palpate::run {
namespace {

using namespace std::chrono_literals;

/// Between two steps of the brush: often enough to feel smooth, rarely enough that one version each
/// is no burden.
constexpr auto brush_interval = 4ms;
/// A brush that changed nothing for so long begins a new step for undo.
constexpr auto rest = 500ms;
/// [s] Longest time that one step of the brush makes up for, however late the thread was.
constexpr double longest_step = 0.1;
/// Parts of a store's memory limit: for edits, and for undo.
constexpr std::uint64_t edits_part = 4, history_part = 8;

/// Throws Cancelled once the stop is requested, else puts what is done into `made`.
OnProgress until(const std::stop_token& stop, std::atomic<double>& made) {
    return [&stop, &made](double fraction) {
        if (stop.stop_requested()) throw stream::Cancelled{};
        made = std::max(made.load(), fraction);
    };
}

std::uint64_t bytes_of_edits(const Samples& samples) {
    const Bricks* bricks = samples.bricks();
    return bricks ? bricks->size() * Bricks::per_brick * size_of(samples.type()) : 0;
}

/// Adds a brick to the bytes that the edits of a store take.
void count_brick(std::uint64_t& bytes, const Samples& samples, std::uint64_t memory) {
    bytes += Bricks::per_brick * size_of(samples.type());
    if (bytes > memory / edits_part) {
        throw std::invalid_argument(
            "the edits take more than " + std::to_string(memory / edits_part / 1000000) +
            " MB, a quarter of the memory: allow more memory, or save them and open the result");
    }
}

/// Does the work without the lock.
template <class Lock, class Work>
auto without(Lock& lock, Work&& work) {
    struct Again {
        Lock& lock;
        ~Again() { lock.lock(); }
    };
    lock.unlock();
    const Again again{lock};
    return work();
}

}  // namespace

VolumeEditor::VolumeEditor(std::shared_ptr<const Samples> samples, Pace pace,
                           std::size_t most_versions)
    : VolumeEditor(std::move(samples), nullptr, 0, pace, most_versions) {}

VolumeEditor::VolumeEditor(std::shared_ptr<const Samples> samples, Streamer& streamer,
                           std::uint64_t memory, Pace pace)
    : VolumeEditor(std::move(samples), &streamer, memory, pace, usual_versions) {}

VolumeEditor::VolumeEditor(std::shared_ptr<const Samples> samples, Streamer* streamer,
                           std::uint64_t memory, Pace pace, std::size_t most_versions)
    : streamer_(streamer),
      memory_(memory),
      editor_(streamer ? Editor(samples, memory / history_part) : Editor(samples)),
      versions_{{samples, {}}},
      most_versions_(most_versions),
      forget_at_(std::min(most_versions, first_forgetting)) {
    publish();
    if (pace == Pace::by_steps) return;
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

VolumeEditor::~VolumeEditor() {
    thread_.request_stop();
    {
        const std::scoped_lock lock(mutex_);
        brushing_.request_stop();
    }
    if (thread_.joinable()) thread_.join();
}

std::unique_ptr<Servo> VolumeEditor::attach(Session session, const StartServo& start) {
    const std::scoped_lock lock(mutex_);
    const Field field = session.renderer.field;
    const std::shared_ptr<const Tool> tool = session.renderer.settings.tool;
    std::unique_ptr<Servo> servo;
    if (streamer_) {
        servo = streamer_->attach(std::move(session), start, history());
    } else {
        const std::uint64_t version = version_of(editor_.samples());
        palpate::apply(session, command::Samples{editor_.samples(), version});
        servo = start(std::move(session), history());
    }
    hands_.push_back({.servo = servo.get(), .field = field, .tool = tool, .resting = true});
    new_step_ = true;
    return servo;
}

void VolumeEditor::detach(const Servo& servo) {
    const std::scoped_lock lock(mutex_);
    interrupt_brush();
    std::erase_if(hands_, [&](const Hand& hand) { return hand.servo == &servo; });
    if (streamer_) streamer_->detach(servo);
    new_step_ = true;
}

void VolumeEditor::record(const Servo& servo, const BeginRecording& begin) {
    const std::scoped_lock lock(mutex_);
    if (streamer_) return streamer_->record(servo, begin, history());
    send_waiting();
    const bool lacks = std::ranges::any_of(
        hands_, [&](const Hand& hand) { return hand.servo == &servo && !hand.waiting.empty(); });
    if (lacks) throw std::runtime_error(takes_no_commands);
    begin(history());
}

void VolumeEditor::rest_brush(const Servo& servo, const std::shared_ptr<const Tool>& tool) {
    const std::scoped_lock lock(mutex_);
    interrupt_brush();
    for (Hand& hand : hands_) {
        if (hand.servo != &servo) continue;
        if (hand.tool != tool) hand.body.reset();
        hand.tool = tool;
        hand.touch.reset();
        hand.resting = true;
        hand.from = servo.sure_tick();
    }
}

void VolumeEditor::set_brush(const std::optional<HandBrush>& brush) {
    if (brush) check(*brush);
    const std::scoped_lock lock(mutex_);
    interrupt_brush();
    if (brush.has_value() != brush_.has_value()) {
        for (Hand& hand : hands_) {
            hand.touch.reset();
            hand.resting = false;
        }
        new_step_ = true;
    }
    brush_ = brush;
    has_work_.notify_all();
    set_problem({});
}

/// What the brush computes at the moment is not used any more. With the lock.
void VolumeEditor::interrupt_brush() {
    brushing_.request_stop();
    brushing_ = {};
}

/// An edit that begins again, or the start of a servo, may take seconds.
VolumeEditor::Lock VolumeEditor::locked(std::mutex& mutex, const std::stop_token& stop) {
    if (!stop.stop_possible()) return Lock(mutex);
    Lock lock(mutex, std::try_to_lock);
    while (!lock.owns_lock() && !lock.try_lock()) {
        if (stop.stop_requested()) throw stream::Cancelled{};
        std::this_thread::sleep_for(1ms);
    }
    return lock;
}

void VolumeEditor::apply(const Edit& asked, const OnProgress& progress) {
    stream::while_telling(progress, [&](const std::stop_token& stop, std::atomic<double>& made) {
        Later later;
        Lock lock = locked(mutex_, stop);
        use(computed(lock, asked, later, stop, until(stop, made)), asked, EditStep::own, later);
        new_step_ = true;
    });
}

bool VolumeEditor::undo(const OnProgress& progress) {
    return stream::while_telling(progress, [&](const std::stop_token& stop) {
        const Lock lock = locked(mutex_, stop);
        return go_to(editor_.undo());
    });
}

bool VolumeEditor::redo(const OnProgress& progress) {
    return stream::while_telling(progress, [&](const std::stop_token& stop) {
        const Lock lock = locked(mutex_, stop);
        return go_to(editor_.redo());
    });
}

/// Sends the version that the editor went back or forth to.
bool VolumeEditor::go_to(SampleBox changed) {
    interrupt_brush();
    new_step_ = true;
    for (Hand& hand : hands_) hand.resting = true;
    if (changed.empty()) return false;
    send({editor_.samples(), version_of(editor_.samples())});
    return true;
}

std::uint64_t VolumeEditor::version_of(const std::shared_ptr<const Samples>& samples) const {
    for (std::size_t i = versions_.size(); i-- > 0;) {
        // By owner: the memory of a version that has expired may be used again by this one.
        const auto& known = versions_[i].samples;
        if (!known.owner_before(samples) && !samples.owner_before(known)) {
            return versions_[i].recipe.version;
        }
    }
    return 0;  // not reached: the editor holds what it made
}

/// Computes an edit without the lock. If the samples have changed meanwhile, it is computed again.
/// Edits that have not begun yet then wait for it, because it might never end otherwise. What it
/// has read is kept for the next time. Throws what edited() and `tell` throw.
VolumeEditor::Computed VolumeEditor::computed(Lock& lock, const Edit& asked, Later& later,
                                              const std::stop_token& stop, const OnProgress& tell) {
    const auto take_turn = [&] { return without(lock, [&] { return locked(turn_, stop); }); };
    Lock turn = take_turn();
    turn.unlock();
    while (true) {
        const std::shared_ptr<const Samples> before = editor_.samples();
        Edited made =
            without(lock, [&] { return compute(before, asked, later.fetched, stop, tell); });
        if (stop.stop_requested()) throw stream::Cancelled{};
        if (editor_.samples() == before) return {version_of(before), std::move(made)};
        later.versions.insert(later.versions.end(), {before, std::move(made.samples)});
        if (!turn.owns_lock()) turn = take_turn();
    }
}

/// Without the lock.
Edited VolumeEditor::compute(const std::shared_ptr<const Samples>& before, const Edit& asked,
                             Fetched& fetched, const std::stop_token& stop,
                             const OnProgress& tell) const {
    if (!streamer_) return edited(before, asked, {}, tell);
    std::uint64_t bytes = bytes_of_edits(*before);
    const auto read = [&](const SampleBox& box, std::span<std::byte> out) {
        count_brick(bytes, *before, memory_);
        std::vector<std::byte>& known = fetched[{box.low[0], box.low[1], box.low[2]}];
        if (known.size() != out.size()) {
            streamer_->read(box, out, stop);
            known.assign(out.begin(), out.end());
        }
        std::ranges::copy(known, out.begin());
    };
    return edited(before, asked, read, tell);
}

/// With the lock, since before the samples could have changed again. False if nothing changes.
bool VolumeEditor::use(Computed computed, const Edit& asked, EditStep step, Later& later) {
    if (editor_.take(std::move(computed.edited), step, &later.versions).empty()) return false;
    last_version_ = streamer_ ? streamer_->next_version() : last_version_ + 1;
    command::Samples made{editor_.samples(), last_version_,
                          std::make_shared<const Recipe>(EditOf{computed.from, asked})};
    versions_.push_back({editor_.samples(), {nullptr, made.version, made.recipe}});
    if (versions_.size() > forget_at_) forget_versions();
    send(made);
    return true;
}

/// Forgets versions that neither undo() nor redo() leads to and that no other one was made of; of
/// too many all that cannot be felt any more. Twice as many may come before it is done again.
void VolumeEditor::forget_versions() {
    std::set<std::uint64_t> needed{0};
    for (std::size_t i = versions_.size(); i-- > 1;) {
        const auto& [samples, recipe] = versions_[i];
        if (!samples.expired()) needed.insert(recipe.version);
        if (needed.contains(recipe.version)) {
            needed.insert(std::get<EditOf>(*recipe.recipe).version);
        }
    }
    const bool too_many = needed.size() > most_versions_;
    knows_history_ = knows_history_ && !too_many;
    std::erase_if(versions_, [&](const Version& version) {
        const bool is_known = !too_many || !version.samples.expired();
        return version.recipe.version > 0 && !(is_known && needed.contains(version.recipe.version));
    });
    const std::size_t few = versions_.size() + std::min(most_versions_, first_forgetting);
    forget_at_ = std::min(versions_.size() + few, std::max(most_versions_, few));
}

/// Makes the state visible to threads that do not wait for an edit.
void VolumeEditor::publish() {
    EditState now{editor_.samples(),    version_of(editor_.samples()),
                  editor_.undo_steps(), editor_.redo_steps(),
                  editor_.changed(),    problem_};
    const std::scoped_lock lock(state_mutex_);
    std::swap(state_, now);
}

void VolumeEditor::set_problem(const std::string& problem) {
    if (problem_ == problem) return;
    problem_ = problem;
    publish();
}

/// To every servo. One that takes no commands at the moment gets it later.
void VolumeEditor::send(const command::Samples& command) {
    publish();
    if (streamer_) {
        streamer_->use(command);
        streamer_->leave_room(bytes_of_edits(*command.samples) + editor_.history_bytes());
        return;
    }
    for (Hand& hand : hands_) hand.waiting.push_back(command);
    if (!send_waiting()) has_work_.notify_all();
}

/// False if a servo takes no commands at the moment.
bool VolumeEditor::send_waiting() {
    bool sent = true;
    for (Hand& hand : hands_) {
        if (hand.servo->has_ended()) hand.waiting.clear();
        while (!hand.waiting.empty() && hand.servo->send(hand.waiting.front())) {
            hand.waiting.pop_front();
        }
        sent = sent && hand.waiting.empty();
    }
    return sent;
}

void VolumeEditor::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::this_thread::sleep_for(brush_interval);
        try {
            {
                std::unique_lock lock(mutex_);
                has_work_.wait(lock, stop, [this] { return brush_ || !send_waiting(); });
            }
            step(std::chrono::steady_clock::now());
        } catch (const std::exception&) {  // no memory, not even for words: tried again in a moment
        }
    }
}

void VolumeEditor::step(std::chrono::steady_clock::time_point now) {
    Later later;
    Lock lock(mutex_);
    send_waiting();
    const std::stop_token stop = brushing_.get_token();
    try {
        // The lock is free while a stroke is computed: hands may be added meanwhile. All else that
        // changes them interrupts the brush.
        for (std::size_t i = 0; i < hands_.size(); ++i) brush(lock, i, later, now, stop);
    } catch (const stream::Cancelled&) {  // interrupted, or the editor ends
    } catch (const std::exception& e) {   // no memory, nothing to be read
        if (stop.stop_requested()) return;
        interrupt_brush();
        brush_.reset();
        set_problem(std::string("the brush was put down: ") + e.what());
    }
}

void VolumeEditor::brush(Lock& lock, std::size_t i, Later& later,
                         std::chrono::steady_clock::time_point now, const std::stop_token& stop) {
    Hand& hand = hands_[i];
    if (!brush_) return;
    const auto felt = hand.servo->snapshot();
    if (!felt || felt->number < hand.from) return;
    if (hand.touch && felt->number <= hand.touch->tick) return;
    const SessionTick& session = felt->session;
    if (session.tick.proxy.mode == Mode::free) hand.resting = false;
    const bool works = !hand.resting && session.device.status == DeviceStatus::ready &&
                       !session.frozen && !session.clutched && felt->forces_on &&
                       grasps(session.device) && session.tick.proxy.mode == Mode::constrained &&
                       session.tick.proxy.status == UpdateStatus::done;
    if (!works) return hand.touch.reset();
    const Touch to{
        {session.tick.proxy.scp, session.tick.tool.proxy}, session.tick.time, felt->number};
    if (hand.touch && brush_to(lock, i, to, session.tick.proxy.isovalue, later, stop)) {
        last_change_ = now;
    }
    if (now - last_change_ > rest) new_step_ = true;
    hands_[i].touch = to;  // not if it was interrupted: the next stroke begins where this one did
}

/// Sweeps the brush of a hand to where it touches now. True if it changed something.
bool VolumeEditor::brush_to(Lock& lock, std::size_t i, const Touch& to, double isovalue,
                            Later& later, const std::stop_token& stop) {
    const Touch from = *hands_[i].touch;
    const auto brush =
        brush_at(*brush_, hands_[i].field, isovalue, std::min(to.time - from.time, longest_step));
    if (!brush) return false;
    bool changed = false;
    try {
        const Edit asked = edit_of(lock, *brush, from.at, to.at, i, stop);
        std::atomic<double> made{0};
        Computed stroke = computed(lock, asked, later, stop, until(stop, made));
        changed = use(std::move(stroke), asked, new_step_ ? EditStep::own : EditStep::same, later);
    } catch (const std::invalid_argument& e) {
        if (stop.stop_requested()) throw stream::Cancelled{};
        set_problem(e.what());  // for example a value on the wrong side of the level felt now
        return false;
    }
    set_problem({});
    if (changed) new_step_ = false;
    return changed;
}

/// Throws std::invalid_argument for a tool that has no body. The body is made without the lock.
Edit VolumeEditor::edit_of(Lock& lock, const Brush& brush, const Pose& from, const Pose& to,
                           std::size_t i, const std::stop_token& stop) {
    if (!brush_->as_tool) return edit::Stroke{brush, from.position, to.position};
    const Geometry geometry = hands_[i].field.geometry();
    if (!hands_[i].body || hands_[i].body->reach() != reach_of(brush, geometry)) {
        const auto tool =
            hands_[i].tool ? hands_[i].tool : std::make_shared<const Tool>(point_tool());
        auto body = without(lock, [&] {
            return std::make_shared<const ToolBody>(body_for(brush, geometry, tool));
        });
        if (stop.stop_requested()) throw stream::Cancelled{};
        hands_[i].body = std::move(body);
    }
    return edit::Sweep{brush, hands_[i].body, from, to};
}

EditState VolumeEditor::state() const {
    const std::scoped_lock lock(state_mutex_);
    return state_;
}

void VolumeEditor::set_saved(const std::shared_ptr<const Samples>& samples) {
    std::shared_ptr<const Samples> before;  // freed without the lock
    const std::scoped_lock lock(mutex_);
    if (editor_.samples() == samples) before = editor_.set_saved();
    publish();
}

bool VolumeEditor::knows_history() const {
    const std::scoped_lock lock(mutex_);
    return knows_history_;
}

std::vector<Command> VolumeEditor::history() const {
    std::vector<Command> history;
    for (std::size_t i = 1; i < versions_.size(); ++i) history.emplace_back(versions_[i].recipe);
    const std::uint64_t now = version_of(editor_.samples());
    if (now != versions_.back().recipe.version) {
        history.emplace_back(command::Samples{nullptr, now});
    }
    return history;
}

}  // namespace palpate::run
