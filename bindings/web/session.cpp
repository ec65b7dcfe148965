// The session of a page. Its settings and commands are JSON with the names of recordings, so that
// one table declares them.
#include "bindings/web/session.hpp"

#include <emscripten.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "devices/haply/haply.hpp"
#include "devices/simulated/simulated.hpp"
#include "io/recording/samples_json.hpp"
#include "palpate/names.hpp"
#include "palpate/settings.hpp"

namespace palpate::web {
namespace {

using io::Json;

// The clock of the page and of its readings [ms].
EM_JS(double, page_clock, (), { return performance.now(); });

std::int64_t clock_ns() noexcept {
    return static_cast<std::int64_t>(1e6 * page_clock());
}

/// Touches that lie farther apart are not joined by a stroke.
constexpr double longest_stroke = 10;  // times the brush's radius

Field field_from(const std::shared_ptr<const Samples>& samples, const Json& setup) {
    const auto background =
        setup.contains("background")
            ? std::optional(io::number_from_json(setup["background"], "background"))
            : std::nullopt;
    return Field(samples, named<Solid>(setup.value("solid", "above")), background,
                 interpolation_from(setup.value("field", "cubic")));
}

RendererSettings settings_from(const Json& setup) {
    RendererSettings settings;
    if (setup.contains("settings")) io::from_json(setup["settings"], settings);
    return settings;
}

double isovalue_from(const Json& setup) {
    return io::number_from_json(io::member(setup, "isovalue"), "isovalue");
}

DeviceTransform transform_from(const Field& field, const Json& setup, const DeviceInfo& device) {
    if (setup.value("fit", false)) return fit_workspace(field.geometry(), device);
    return settings_from(setup).transform;
}

Session session_from(const Field& field, const Json& setup, const DeviceInfo& device) {
    RendererSettings settings = settings_from(setup);
    settings.transform = transform_from(field, setup, device);
    Session session{make_renderer(field, isovalue_from(setup), settings), {}};
    if (setup.contains("session")) io::from_json(setup["session"], session.settings);
    return session;
}

DeviceInfo info_from(const Json& setup) {
    DeviceInfo info;
    info.name = setup.value("device", "page");
    info.limits = settings_from(setup).device;
    return info;
}

/// A page cannot wait: what has not arrived comes in a later tick.
void do_not_wait(std::int64_t) noexcept {}

PageDevice device_from(const Field& field, const Json& setup, Channel channel) {
    const devices::DeviceChoice choice = devices::parse_device(setup.value("device", "page"));
    const devices::DeviceScene scene{
        field, isovalue_from(setup), setup.value("rate", 1000.0),
        [&](const DeviceInfo& device) { return transform_from(field, setup, device); }};
    if (channel) {
        return PageDevice(devices::haply::open(choice, scene, {std::move(channel), {}},
                                               {.now = &clock_ns, .sleep_until = &do_not_wait}));
    }
    if (choice.name == "simulated") return PageDevice(devices::open_simulated(choice, scene));
    return PageDevice(info_from(setup));
}

Json json_of(const LatencySummary& times) {
    return {{"p50", times.p50}, {"p99", times.p99}, {"p999", times.p999}, {"max", times.max}};
}

}  // namespace

WebSession::WebSession(std::shared_ptr<const Samples> samples, const std::string& setup,
                       Channel channel)
    : setup_(Json::parse(setup)),
      editor_(std::move(samples)),
      field_(field_from(editor_.samples(), setup_)),
      device_(device_from(field_, setup_, std::move(channel))),
      start_(session_from(field_, setup_, device_.info())),
      asked_(start_),
      servo_(std::make_unique<Servo>(
          start_, device_,
          ServoSettings{
              .rate = setup_.value("rate", 1000.0), .real_time = false, .clock = &clock_ns})) {
    versions_.emplace_back(editor_.samples(), command::Samples{});
    if (device_.info().name == "spacenav") puck_.emplace();
}

void WebSession::read(double x, double y, double z, unsigned buttons, double measured) {
    device_.newest.status = DeviceStatus::ready;
    device_.measured = measured;
    if (puck_) return;
    device_.newest.position = {x, y, z};
    device_.newest.buttons = buttons;
}

void WebSession::puck(int number, const std::string& bytes) {
    if (!puck_) throw std::logic_error("the device of this session is no 3D mouse");
    const std::span report(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    for (const auto& event : puck_->reports.take(static_cast<std::uint8_t>(number), report)) {
        devices::spacenav::apply(puck_->hand, event, {});
    }
}

/// To the time of this tick.
void WebSession::move_puck() {
    if (!puck_) return;
    constexpr double longest = 0.02;  // [s] no jump after the page has stalled
    const double passed = device_.now - std::exchange(puck_->moved_at, device_.now);
    advance(puck_->hand, std::clamp(passed, 0., longest), {});
    device_.newest.position = puck_->hand.position;
    device_.newest.orientation = puck_->hand.orientation;
    device_.newest.buttons = puck_->hand.buttons;
}

void WebSession::lose() {
    device_.newest.status = DeviceStatus::lost;
}

bool WebSession::step() {
    device_.exchange();
    device_.now = 1e-9 * static_cast<double>(clock_ns());
    move_puck();
    const bool goes_on = servo_->step();
    drain();
    return goes_on;
}

bool WebSession::step_at(double time) {
    device_.now = time;
    move_puck();
    const bool goes_on = servo_->step(static_cast<std::int64_t>(std::llround(1e9 * time)));
    drain();
    return goes_on;
}

double WebSession::due() const {
    return 1e-9 * static_cast<double>(servo_->due());
}

void WebSession::stop() {
    servo_->stop();
}

void WebSession::send(const std::string& command) {
    const Command sent = io::command_from_json(Json::parse(command), bodies_);
    if (std::holds_alternative<command::Samples>(sent)) {
        throw std::invalid_argument("samples change by edit()");
    }
    push(sent);
}

void WebSession::push(const Command& command) {
    if (!servo_->send(command)) throw std::runtime_error("too many commands wait");
    if (!std::holds_alternative<command::Samples>(command)) apply(asked_, command);
}

std::string WebSession::settings() const {
    Json list = Json::array();
    for_each_live_number(asked_.renderer.settings,
                         [&](const std::string& name, const auto& one, double value, const auto&) {
                             list.push_back({{"name", name},
                                             {"unit", one.unit},
                                             {"about", one.about},
                                             {"least", io::number_to_json(one.range.least)},
                                             {"most", io::number_to_json(one.range.most)},
                                             {"value", io::number_to_json(value)}});
                         });
    return list.dump();
}

void WebSession::set(const std::string& name, double value) {
    RendererSettings changed = asked_.renderer.settings;
    push(change(changed, name, value));
}

void WebSession::edit(const std::string& edit, bool same_step) {
    const Json made{{"version", 1U}, {"of", 0U}, {"edit", Json::parse(edit)}};
    const auto recipe = io::samples_command_from_json(made, bodies_).recipe;
    if (!recipe) throw std::invalid_argument("an edit is a stroke, a sweep or a fill");
    make(std::get<EditOf>(*recipe).edit, same_step);
}

bool WebSession::drill(double radius, bool same_step) {
    const std::optional<Snapshot> now = servo_->snapshot();
    if (!now || now->session.tick.proxy.mode != Mode::constrained) {
        carved_to_.reset();
        return false;
    }
    const Vec3 to = now->session.tick.proxy.scp;
    const bool joined = carved_to_ && (to - *carved_to_).norm() < longest_stroke * radius;
    const Brush brush =
        brush_for(BrushKind::carve, field_, now->session.tick.proxy.isovalue, radius);
    const bool changed = make(edit::Stroke{brush, joined ? *carved_to_ : to, to}, same_step);
    carved_to_ = to;
    return changed;
}

bool WebSession::make(const Edit& edit, bool same_step) {
    const std::uint64_t from = version_of_samples();
    if (editor_.apply(edit, same_step ? EditStep::same : EditStep::own).empty()) return false;
    const command::Samples made{editor_.samples(), ++last_version_,
                                std::make_shared<const Recipe>(EditOf{from, edit})};
    versions_.emplace_back(editor_.samples(), command::Samples{nullptr, made.version, made.recipe});
    push(made);
    return true;
}

bool WebSession::undo() {
    return go_to(editor_.undo());
}

bool WebSession::redo() {
    return go_to(editor_.redo());
}

bool WebSession::go_to(const SampleBox& changed) {
    carved_to_.reset();
    if (changed.empty()) return false;
    push(command::Samples{editor_.samples(), version_of_samples()});
    return true;
}

std::uint64_t WebSession::version_of_samples() const {
    const std::shared_ptr<const Samples> samples = editor_.samples();
    // By owner: the memory of a version that has expired may be used again by this one.
    const auto same = [&](const auto& known) {
        return !known.first.owner_before(samples) && !samples.owner_before(known.first);
    };
    const auto found = std::find_if(versions_.rbegin(), versions_.rend(), same);
    return found == versions_.rend() ? 0 : found->second.version;
}

const SnapshotNumbers& WebSession::snapshot() {
    const std::optional<Snapshot> now = servo_->snapshot();
    if (!now) return numbers_;
    const SessionTick& session = now->session;
    const Tick& tick = session.tick;
    auto* out = numbers_.data();
    const auto put = [&out](double number) { *out++ = number; };
    const auto put_all = [&](const Vec3& v) { std::for_each(v.data(), v.data() + 3, put); };
    put(static_cast<double>(now->number));
    put(tick.time);
    put_all(tick.proxy.hip);
    put_all(tick.proxy.scp);
    put_all(tick.force);
    put_all(now->normal);
    put(tick.proxy.mode == Mode::constrained);
    put(tick.proxy.density);
    put(tick.proxy.isovalue);
    put(tick.force_flags);
    put(tick.layers.touched);
    put(tick.layers.inside);
    put(static_cast<double>(session.version));
    put(static_cast<double>(now->missed));
    put(now->stiffness);
    put(static_cast<double>(session.device.status));
    return numbers_;
}

std::string WebSession::report() const {
    const ServoReport now = servo_->report();
    const DeviceInfo device = device_.info();
    return Json{{"device", device.model.empty() ? device.name : device.model},
                {"problem", device_.problem()},
                {"ticks", now.ticks},
                {"missed", now.missed},
                {"overruns", now.overruns},
                {"unrecorded", now.unrecorded},
                {"period", json_of(now.period)},
                {"lateness", json_of(now.lateness)},
                {"work", json_of(now.work)}}
        .dump();
}

void WebSession::record(const std::string& begun) {
    if (text_) throw std::logic_error("a recording is under way");
    io::RecordingHead head;
    head.version = PALPATE_VERSION;
    head.begun = begun;
    head.volume = io::identify(field_.volume(), {{"volume", setup_.value("volume", "browser")}});
    head.solid = field_.solid();
    head.interpolation = field_.interpolation();
    head.background = field_.background();
    head.isovalue = start_.renderer.proxy.isovalue;
    head.device = device_.info().name + " (browser)";
    head.rate = setup_.value("rate", 1000.0);
    head.method = "exact";
    head.settings = start_.renderer.settings;
    head.session = start_.settings;
    text_.emplace(head);
    unrecorded_before_ = servo_->report().unrecorded;
    for (std::size_t i = 1; i < versions_.size(); ++i) text_->append(versions_[i].second);
    const std::uint64_t version = version_of_samples();
    if (versions_.back().second.version != version) {
        text_->append(command::Samples{nullptr, version});
    }
    if (!servo_->record(events_)) {
        text_.reset();
        throw std::runtime_error("too many commands wait");
    }
}

std::string WebSession::recording() {
    if (!text_) throw std::logic_error("nothing is recorded");
    servo_->stop_recording();
    drain();
    text_->end(servo_->report().unrecorded - unrecorded_before_);
    std::string lines = std::move(text_->lines);
    text_.reset();
    return lines;
}

void WebSession::drain() {
    while (const auto event = events_.pop()) {
        if (text_) std::visit([this](const auto& one) { text_->append(one); }, *event);
    }
}

}  // namespace palpate::web
