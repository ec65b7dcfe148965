// A step of an Inverse3: asks the service, hands the answer to the servo, and connects again when
// the connection breaks.
#include "devices/haply/inverse3.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace palpate::devices::haply {
namespace {

using namespace std::chrono_literals;

constexpr auto shortest_pause = 250us;                    // between two questions: 4 kHz at most
constexpr std::chrono::microseconds longest_pause = 5ms;  // the force goes out at least this often
constexpr std::chrono::microseconds idle_pause = 100ms;   // while no device is attached
constexpr auto send_limit = 50ms;
constexpr auto close_limit = 100ms;
constexpr auto connect_limit = 250ms;
constexpr auto first_wait = 100ms;
constexpr auto longest_wait = 2s;
constexpr auto longest_sleep = 10ms;
constexpr auto longest_age = std::chrono::duration_cast<Clock::duration>(
    std::chrono::duration<double>(Device::longest_force));

// A change of the mapping shows within `between_full`; one this soon after what was pinned has
// arrived is our own.
constexpr auto between_full = 8ms;
constexpr auto settling = longest_age;
constexpr auto longest_pinning = 2s;          // then the service is said to ignore it
constexpr auto shortest_break = longest_age;  // that every servo notices
constexpr auto longest_unechoed = 100ms;
constexpr double felt = 0.1;           // [N] a force that a service cannot round to zero
const Vec3 box_low(-300, -299, -118);  // [mm, service axes] reachable, after public drivers
const Vec3 box_high(286, 163, 378);

std::string place_of(const Address& address) {
    return address.host + ":" + std::to_string(address.port);
}

std::string service_at(const Address& address) {
    return "the Inverse Service at " + place_of(address);
}

/// It stays the device that was found, also after another connection: the limits are its limits.
Settings settled(Settings settings, const ServiceState& found) {
    settings.device = found.device_id;
    return settings;
}

template <std::size_t size>
std::array<char, size> clipped(std::string_view text) {
    std::array<char, size> characters{};
    std::ranges::copy(text.substr(0, size - 1), characters.begin());
    return characters;
}

}  // namespace

std::string start_talk(Talk& talk, const Address& address, const std::string& device,
                       Clock::time_point deadline) {
    talk.state = {};
    talk.state.wanted = device;
    const std::string service = service_at(address);
    if (!talk.channel->connect(address, deadline)) {
        return "nothing to talk to at " + place_of(address) + " (" + talk.channel->error() +
               "): install Haply's Inverse Service (haply-inverse-service) and start it: systemctl "
               "start haply-inverse-service";
    }
    for (;;) {
        const Received received = talk.channel->receive(deadline);
        if (received.what == Received::What::closed) {
            return service + " closed the connection (" + talk.channel->error() + ")";
        }
        if (received.what == Received::What::nothing) {
            return service + " does not say what is attached: is it of version 3.1 or newer?";
        }
        if (!received.binary && take_message(talk.state, received.message) != News::refused)
            return {};
    }
}

std::string no_device(const Talk& talk, const Address& address) {
    const std::string service = service_at(address) + " has no ";
    if (talk.state.wanted.empty() || talk.state.attached.empty()) {
        return service + "Inverse3 attached: plug it in and switch it on";
    }
    return service + "device " + talk.state.wanted + "; attached: " + talk.state.attached;
}

void Questions::asked(Clock::time_point now) {
    if (missing() == 0) behind_since_ = now;
    times_[asked_++ % times_.size()] = now;
    last_ = now;
}

Clock::time_point Questions::answered() {
    return missing() == 0 ? last_ : times_[answered_++ % times_.size()];
}

Clock::duration Questions::behind(Clock::time_point now) const {
    if (missing() == 0) return {};
    return missing() < times_.size() ? now - behind_since_ : Clock::duration::max();
}

Inverse3::Inverse3(Settings settings, Address address, Talk talk, const Timing& timing)
    : LinkedDevice(timing, 0),
      settings_(settled(std::move(settings), talk.state)),
      address_(std::move(address)),
      service_(service_at(address_)),
      is_minverse_(talk.state.list == "minverse"),
      talk_(std::move(talk)),
      claim_(settings_.device + " at " + place_of(address_), opening_hand()),
      wait_(first_wait) {
    tell_identity(talk_.state);
    // The release whose documentation says "vector" tells preset and mount, too.
    const bool is_new = !talk_.state.mapping.preset.empty();
    force_key_ = settings_.force_key.value_or(is_new ? ForceKey::vector : ForceKey::values);
}

const Model& Inverse3::model() const {
    return is_minverse_ ? model_named("Minverse") : model_named("Inverse3");
}

Inverse3::~Inverse3() {
    end_thread();
    try {
        say_goodbye();
    } catch (const std::exception&) {  // no memory: the service ends the force by itself
    }
}

DeviceInfo Inverse3::info() const {
    DeviceInfo info;
    info.name = "haply";
    info.limits = limits_of(model(), settings_.rate, exchange_delay(1e-3));
    info.stiffness = model().stiffness;
    const Vec3 one = settings_.axes * box_low, other = settings_.axes * box_high;
    info.workspace_low = one.cwiseMin(other);
    info.workspace_high = one.cwiseMax(other);
    if (is_minverse_) {
        const Vec3 middle = (one + other) / 2;
        const Vec3 half = Vec3(model().width, model().height, model().depth) / 2;
        info.workspace_low = middle - half;
        info.workspace_high = middle + half;
    }
    if (const auto identity = identity_.get()) {
        info.model = identity->model.data();
        info.has_orientation = identity->has_grip;
    }
    info.buttons = 3;  // the grip's, which may be taken up at any time
    return info;
}

std::string Inverse3::problem() const {
    const auto problem = problem_.get();
    return problem ? std::string(problem->text.data()) : std::string{};
}

void Inverse3::tell(std::string_view problem) {
    if (problem == told_) return;
    told_ = problem;
    problem_.put({clipped<sizeof(Problem::text)>(problem)});
}

void Inverse3::tell_identity(const ServiceState& state) {
    told_grip_ = !state.grip.list.empty();
    identity_.put({clipped<sizeof(Identity::model)>(state.model), told_grip_});
}

void Inverse3::step() {
    if (!connected_) return reconnect();
    try {
        if (const auto why = converse()) lose(*why);
    } catch (const std::exception& error) {
        lose(error.what());
    }
}

void Inverse3::lose(std::string_view why) noexcept {
    gate_.note(false, timing_.now());
    link_.report(DeviceStatus::lost, timing_.now());
    talk_.channel->drop();
    connected_ = false;
    next_attempt_ = now() + wait_;
    try {
        tell("lost " + service_ + " (" + std::string(why) + "); trying to connect again");
    } catch (const std::exception&) {  // no memory for words
    }
}

void Inverse3::reconnect() {
    if (now() < next_attempt_) {
        return timing_.sleep_until(ns_of(std::min(next_attempt_, now() + longest_sleep)));
    }
    wait_ = std::min<Clock::duration>(2 * wait_, longest_wait);
    try {
        connected_ = start_talk(talk_, address_, settings_.device, now() + connect_limit).empty();
    } catch (const std::exception&) {  // no memory, no file descriptors: perhaps later
        talk_.channel->drop();
    }
    next_attempt_ = now() + wait_;
    questions_ = {};
    has_pinned_ = false;
    is_watched_ = false;
    mapping_.reset();
    if (connected_ && !talk_.state.device_id.empty()) tell_identity(talk_.state);
}

/// A question where one is due, otherwise a wait for the answer. Says why when the connection ends.
std::optional<std::string> Inverse3::converse() {
    const bool idle = talk_.state.device_id.empty();
    auto pause = questions_.missing() > 0 ? longest_pause : shortest_pause;
    if (idle) pause = idle_pause;
    const Clock::time_point begun = now(), due = questions_.last() + pause;
    if (begun >= due) {
        if (!ask(begun)) return talk_.channel->error();
        return std::nullopt;
    }
    // Waiting for the socket is no finer than a millisecond.
    if (questions_.missing() == 0 && due - begun < 1ms) {
        timing_.sleep_until(ns_of(due));
        return std::nullopt;
    }
    const Received received =
        talk_.channel->receive(std::min<Clock::time_point>(due, begun + longest_pause));
    const Clock::time_point after = now();
    if (received.what == Received::What::closed) return talk_.channel->error();
    if (received.what == Received::What::message) take(received, questions_.answered(), after);
    if (questions_.behind(after) > std::chrono::duration<double>(settings_.timeout)) {
        return "it does not keep up with answering";
    }
    if (received.what == Received::What::nothing && questions_.behind(after) > longest_age) {
        tell(service_ + " does not answer");
    }
    return std::nullopt;
}

/// Sends the force; the answer is the next state.
bool Inverse3::ask(Clock::time_point now) {
    questions_.asked(now);
    const std::string& id = talk_.state.device_id;
    if (id.empty()) return talk_.channel->send(snapshot_command(), now + send_limit);
    const bool pins = !std::exchange(has_pinned_, true) && settings_.preset != "keep";
    if (pins) pinned_at_ = now;
    const bool wants_all = now >= next_full_;
    if (wants_all) next_full_ = now + between_full;
    ForceCommand command(id, force_key_,
                         {.list = talk_.state.list,
                          .wants_all = wants_all,
                          .preset = pins ? std::string_view(settings_.preset) : ""});
    const Vec3 newtons = settings_.axes.transpose() * force(now);
    asked_force_ = newtons.norm();
    return talk_.channel->send(command.with(newtons), now + send_limit);
}

/// The link's, if the gate lets it through and the newest position is not stale.
Vec3 Inverse3::force(Clock::time_point now) {
    if (now - measured_at_ > longest_age) gate_.note(false, ns_of(now));
    return gate_.pass(link_.wrench(ns_of(now)).force, model().force, ns_of(now));
}

void Inverse3::take(const Received& received, Clock::time_point asked, Clock::time_point now) {
    ServiceState& state = talk_.state;
    News news = News::refused;
    if (received.binary) {
        state.error = "a binary message";
    } else {
        news = take_message(state, received.message);
    }
    switch (news) {
        case News::refused:
            gate_.note(false, ns_of(now));
            link_.report(DeviceStatus::fault, ns_of(now));
            tell(service_ + " sent " + state.error);
            break;
        case News::none:
            if (!state.error.empty()) {
                // A service that refuses commands with the wrong key sends nothing else. The first
                // answer may complain about the preset.
                const bool is_refused = !mapping_ && asked != pinned_at_;
                if (is_refused && !settings_.force_key && keys_tried_ == 1) {
                    try_other_key(now);
                    has_pinned_ = false;  // that command was refused, too
                }
                tell(problem_of(state));
            } else if (now - measured_at_ > longest_age) {
                tell(state.device_id.empty() ? no_device(talk_, address_)
                                             : service_ + " says nothing of " + state.device_id);
            }
            break;
        case News::gone:
            gate_.note(false, ns_of(now));
            link_.report(DeviceStatus::lost, ns_of(now));
            tell(no_device(talk_, address_));
            break;
        case News::state:
            wait_ = first_wait;
            report_state(asked, now);
            tell(now - asked > longest_age ? service_ + " answers too late" : what_is_wrong(now));
            break;
    }
}

/// Settings that the service does not report count as unchanged.
bool Inverse3::is_as_pinned() const {
    const Mapping& told = talk_.state.mapping;
    const auto is = [](const std::string& part, std::string_view wanted) {
        return part.empty() || part == wanted;
    };
    return settings_.preset == "keep" ||
           (is(told.preset, settings_.preset) && is(told.basis, "XYZ"));
}

/// Another program may set a mount, a preset or a basis while we press, and that turns the force,
/// too. Until what we have pinned ourselves has arrived, and for a moment after it, any change is
/// accepted, without force.
DeviceStatus Inverse3::status_of_mapping(Clock::time_point now) {
    const Mapping& told = talk_.state.mapping;
    if (!changed_.empty()) return DeviceStatus::fault;
    const std::string_view difference = mapping_ ? told.difference(*mapping_) : "all";
    if (is_watched_ && !difference.empty() && now - mapping_since_ >= settling) {
        changed_ = difference;
        return DeviceStatus::fault;
    }
    is_watched_ = is_watched_ || is_as_pinned();
    if (!difference.empty()) {
        mapping_ = told;
        mapping_since_ = now;
        gate_.note(false, ns_of(now));
    }
    if (is_watched_) return DeviceStatus::ready;
    return now - pinned_at_ < longest_pinning ? DeviceStatus::starting : DeviceStatus::fault;
}

/// A service that expects the force under the other key ignores it, or complains. Each key is
/// tried once.
void Inverse3::check_echo(Clock::time_point now) {
    const ServiceState& state = talk_.state;
    if (is_echoed_ || settings_.force_key) return;
    const bool complains = !state.error.empty();
    const bool is_powered = state.powered.value_or(true);
    if (!is_powered || asked_force_ < felt || (!state.rendered && !complains)) {
        unechoed_since_ = now;
        return;
    }
    is_echoed_ = state.rendered && !state.rendered->isZero(0);
    if (is_echoed_ || keys_tried_ > 2) return;
    if (!complains && now - unechoed_since_ < longest_unechoed) return;
    try_other_key(now);
}

/// By now the servo presses with all its force, which must not arrive in one step: the break makes
/// it start again.
void Inverse3::try_other_key(Clock::time_point now) {
    force_key_ = force_key_ == ForceKey::values ? ForceKey::vector : ForceKey::values;
    ++keys_tried_;
    unechoed_since_ = now;
    ready_again_ = now + shortest_break;
}

std::string Inverse3::what_is_wrong(Clock::time_point now) const {
    const ServiceState& state = talk_.state;
    if (!changed_.empty()) {
        return "another program has changed the " + std::string(changed_) + " of " + state.model +
               ", which maps the force, too: end that program, then start again";
    }
    const Mapping& told = state.mapping;
    if (!is_watched_ && now - pinned_at_ >= longest_pinning) {
        return "the service does not take preset " + settings_.preset +
               " with basis XYZ, but has " + told.preset +
               (told.preset.empty() ? "basis " : " with basis ") + told.basis +
               ": is there such a preset, or does another program hold it? preset=keep takes what "
               "there is";
    }
    if (std::string problem = problem_of(state); !problem.empty()) return problem;
    if (keys_tried_ > 2 && !is_echoed_) {
        return service_ + " renders no force of ours: see the option force_key";
    }
    return {};
}

void Inverse3::report_state(Clock::time_point asked, Clock::time_point now) {
    ServiceState& state = talk_.state;
    if (settings_.assume_calibrated) state.calibrated = true;
    DeviceReading reading;
    if (state.position) reading.position = 1000 * (settings_.axes * *state.position);
    reading.orientation = settings_.axes * state.grip.orientation * settings_.axes.transpose();
    reading.buttons = state.grip.buttons;
    const auto age = now - asked;
    reading.age = std::chrono::duration<double>(age).count();
    check_echo(now);
    reading.status = status_of_mapping(now);
    if (reading.status == DeviceStatus::ready) reading.status = status_of(state);
    const bool breaks = reading.status == DeviceStatus::ready && now < ready_again_;
    if (breaks) reading.status = DeviceStatus::starting;
    link_.report(reading, ns_of(now));

    measured_at_ = asked;
    gate_.note(reading.status == DeviceStatus::ready && age <= longest_age, ns_of(now));
    if (told_grip_ != !state.grip.list.empty()) tell_identity(state);
}

void Inverse3::say_goodbye() {
    if (!connected_ || talk_.state.device_id.empty()) return;
    ForceCommand command(talk_.state.device_id, force_key_, {.list = talk_.state.list});
    if (talk_.channel->send(command.with(Vec3::Zero()), now() + send_limit)) {
        talk_.channel->close(now() + close_limit);
    }
}

}  // namespace palpate::devices::haply
