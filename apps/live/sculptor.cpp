// The brush in the hand, and who edits beside it.
#include "apps/live/sculptor.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::app {
namespace {

using namespace std::chrono_literals;

/// Between two touches of the brush: fast enough to feel smooth, and a version each is no burden.
constexpr auto between_dabs = 4ms;
/// [s] A brush that found nothing to do for so long begins a new step for undo.
constexpr double rest = 0.5;
/// [s] Longer than this the brush does not work at a stretch, whatever held the thread up.
constexpr double longest_dab = 0.1;
/// How often a full queue of commands is tried again, a millisecond apart.
constexpr int patience = 200;

}  // namespace

HandBrush usual_brush(const Geometry& geometry) {
    HandBrush brush;
    brush.radius = 3 * geometry.spacing.maxCoeff();
    return brush;
}

void check(const HandBrush& brush) {
    if (!(brush.radius > 0) || !std::isfinite(brush.radius)) {
        throw std::invalid_argument("the brush's radius [mm] must be finite and above 0");
    }
    if (!(brush.hardness >= 0 && brush.hardness <= 1)) {
        throw std::invalid_argument("the brush's hardness must be 0 to 1");
    }
    if (!(brush.rate > 0)) {
        throw std::invalid_argument("the brush's rate [1/s] must be above 0 (inf: at once)");
    }
    if (brush.value && !std::isfinite(*brush.value)) {
        throw std::invalid_argument("the brush's value must be finite");
    }
    if (brush.kind == BrushKind::paint && !brush.value) {
        throw std::invalid_argument("a brush that paints needs a value");
    }
}

std::optional<edit::Stroke> stroke_of(const HandBrush& hand, const Field& field, double isovalue,
                                      const Vec3& from, const Vec3& to, double dt) {
    if (!std::isfinite(isovalue) || !(dt > 0)) return std::nullopt;
    edit::Stroke stroke{brush_for(hand.kind, field, isovalue, hand.radius), from, to};
    stroke.brush.hardness = hand.hardness;
    stroke.brush.strength = -std::expm1(-hand.rate * dt);
    if (hand.value) stroke.brush.value = *hand.value;
    if (!(stroke.brush.strength > 0)) return std::nullopt;
    return stroke;
}

Sculptor::Sculptor(const Field& field)
    : field_(field), editor_(field.shared_samples()), versions_{{field.shared_samples(), {}}} {
    show();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Sculptor::~Sculptor() {
    thread_.request_stop();
    thread_.join();
}

void Sculptor::attach(Servo* servo) {
    const std::scoped_lock lock(mutex_);
    servo_ = servo;
    stroke_.reset();
    fresh_ = true;
}

void Sculptor::set_field(const Field& field) {
    const std::scoped_lock lock(mutex_);
    field_ = field;
}

void Sculptor::set_brush(const std::optional<HandBrush>& brush) {
    if (brush) check(*brush);
    const std::scoped_lock lock(mutex_);
    if (brush.has_value() != brush_.has_value()) {
        stroke_.reset();
        fresh_ = true;
        resting_ = false;
    }
    brush_ = brush;
    problem_.clear();
    show();
}

void Sculptor::apply(const Edit& asked) {
    const std::scoped_lock lock(mutex_);
    edit(asked, EditStep::own);
    fresh_ = true;
}

bool Sculptor::undo() {
    const std::scoped_lock lock(mutex_);
    return go_to(editor_.undo());
}

bool Sculptor::redo() {
    const std::scoped_lock lock(mutex_);
    return go_to(editor_.redo());
}

/// Tells of the version that the editor went back or forth to.
bool Sculptor::go_to(SampleBox changed) {
    fresh_ = true;
    resting_ = true;
    if (changed.empty()) return false;
    send({editor_.samples(), version_of(editor_.samples())});
    return true;
}

std::uint64_t Sculptor::version_of(const std::shared_ptr<const Samples>& samples) const {
    for (std::size_t i = versions_.size(); i-- > 0;) {
        // By owner: a version that is gone may have left its place in memory to this one.
        const auto& known = versions_[i].samples;
        if (!known.owner_before(samples) && !samples.owner_before(known)) return i;
    }
    return 0;  // not reached: the editor holds what it made
}

void Sculptor::edit(const Edit& asked, EditStep step) {
    const std::uint64_t from = version_of(editor_.samples());
    if (editor_.apply(asked, step).empty()) return;
    command::Samples told{editor_.samples(), versions_.size(),
                          std::make_shared<const Recipe>(EditOf{from, asked})};
    versions_.push_back({editor_.samples(), {nullptr, told.version, told.recipe}});
    send(told);
}

/// What others see without waiting.
void Sculptor::show() {
    const Work now{editor_.samples(),    version_of(editor_.samples()),
                   editor_.undo_steps(), editor_.redo_steps(),
                   editor_.changed(),    problem_};
    const std::scoped_lock lock(show_mutex_);
    shown_ = now;
}

void Sculptor::send(const command::Samples& command) {
    show();
    for (int i = 0; servo_ && !servo_->send(command); ++i) {
        if (i == patience) throw std::runtime_error("the session takes no commands");
        std::this_thread::sleep_for(1ms);
    }
}

void Sculptor::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::this_thread::sleep_for(between_dabs);
        const std::scoped_lock lock(mutex_);
        try {
            dab();
        } catch (const std::exception& e) {
            brush_.reset();  // a session that takes no commands, or no memory: the hand only feels
            problem_ = std::string("the brush was put down: ") + e.what();
            show();
        }
    }
}

void Sculptor::dab() {
    if (!brush_ || !servo_) return;
    const auto now = servo_->snapshot();
    if (!now || (stroke_ && now->number <= stroke_->tick)) return;
    const SessionTick& session = now->session;
    if (session.tick.proxy.mode == Mode::free) resting_ = false;
    const bool works = !resting_ && session.device.status == DeviceStatus::ready &&
                       !session.frozen && !session.clutched && now->forces_on &&
                       session.tick.proxy.mode == Mode::constrained &&
                       session.tick.proxy.status == UpdateStatus::done;
    if (!works) return stroke_.reset();
    if (stroke_ && dab_from(*stroke_, *now)) last_dab_ = session.tick.time;
    if (session.tick.time - last_dab_ > rest) fresh_ = true;
    stroke_ = Stroke{session.tick.proxy.scp, session.tick.time, now->number};
}

/// True if it changed something.
bool Sculptor::dab_from(const Stroke& from, const Snapshot& now) {
    const Tick& tick = now.session.tick;
    const auto stroke = stroke_of(*brush_, field_, tick.proxy.isovalue, from.at, tick.proxy.scp,
                                  std::min(tick.time - from.time, longest_dab));
    if (!stroke) return false;
    const std::shared_ptr<const Samples> before = editor_.samples();
    try {
        edit(*stroke, fresh_ ? EditStep::own : EditStep::same);
    } catch (const std::invalid_argument& e) {
        // A value on the wrong side of the level that is felt now, say: nothing to do.
        if (problem_ != e.what()) {
            problem_ = e.what();
            show();
        }
        return false;
    }
    if (!problem_.empty()) {
        problem_.clear();
        show();
    }
    const bool changed = editor_.samples() != before;
    if (changed) fresh_ = false;
    return changed;
}

Work Sculptor::work() const {
    const std::scoped_lock lock(show_mutex_);
    return shown_;
}

void Sculptor::set_saved(const std::shared_ptr<const Samples>& samples) {
    const std::scoped_lock lock(mutex_);
    if (editor_.samples() == samples) editor_.set_saved();
    show();
}

std::vector<command::Samples> Sculptor::history() const {
    const std::scoped_lock lock(mutex_);
    std::vector<command::Samples> history;
    for (std::size_t i = 1; i < versions_.size(); ++i) history.push_back(versions_[i].told);
    const std::uint64_t now = version_of(editor_.samples());
    if (!history.empty() && history.back().version != now) history.push_back({nullptr, now});
    return history;
}

}  // namespace palpate::app
