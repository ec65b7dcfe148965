// The thread of an Inverse3: asks the service, hands the answer to the servo, and connects again
// when the connection breaks.
#include "devices/haply/inverse3.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace palpate::devices::haply {
namespace {

using namespace std::chrono_literals;

constexpr auto shortest_pause = 250us;  // between two questions: 4 kHz at most
constexpr auto longest_pause = 5ms;     // the force goes out at least this often
constexpr auto idle_pause = 100ms;      // while no device is attached
constexpr auto send_limit = 50ms;
constexpr auto connect_limit = 250ms;
constexpr auto first_wait = 100ms;
constexpr auto longest_wait = 2s;
constexpr auto longest_age = std::chrono::duration_cast<Clock::duration>(
    std::chrono::duration<double>(Device::longest_force));

constexpr double maximum_force = 10;   // [N] Inverse3
constexpr double stiffness = 1;        // [N/mm]
const Vec3 box_low(-300, -299, -118);  // [mm, service axes] reachable, after public drivers
const Vec3 box_high(286, 163, 378);

std::string place_of(const Address& address) {
    return address.host + ":" + std::to_string(address.port);
}

std::string service_at(const Address& address) {
    return "the Inverse Service at " + place_of(address);
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
    if (!talk.socket.connect(address, deadline)) {
        return "nothing to talk to at " + place_of(address) + " (" + talk.socket.error() +
               "): install Haply's Inverse Service (haply-inverse-service) and start it: systemctl "
               "start haply-inverse-service";
    }
    for (;;) {
        const Received received = talk.socket.receive(deadline);
        if (received.what == Received::What::closed) {
            return service + " closed the connection (" + talk.socket.error() + ")";
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

Inverse3::Inverse3(Settings settings, Address address, Talk talk)
    : settings_(std::move(settings)),
      address_(std::move(address)),
      service_(service_at(address_)),
      wait_(first_wait) {
    tell_identity(talk.state);
    thread_ = std::thread([this, first = std::move(talk)]() mutable { run(std::move(first)); });
}

Inverse3::~Inverse3() {
    link_.stop();
    quit_.store(true);
    thread_.join();
}

DeviceInfo Inverse3::info() const {
    DeviceInfo info;
    info.name = "haply";
    info.limits.maximum_force = maximum_force;
    info.limits.rate = settings_.rate;
    info.stiffness = stiffness;
    const Vec3 one = settings_.axes * box_low, other = settings_.axes * box_high;
    info.workspace_low = one.cwiseMin(other);
    info.workspace_high = one.cwiseMax(other);
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

void Inverse3::run(Talk talk) {
    prepare_device_thread();
    for (;;) {
        std::string why;
        try {
            why = converse(talk);
            if (quit_) say_goodbye(talk);
        } catch (const std::exception& error) {
            why = error.what();
        }
        gate_.note(false, monotonic_ns());
        link_.report(DeviceStatus::lost);
        if (quit_) return;
        tell("lost " + service_ + " (" + why + "); trying to connect again");
        talk = {};
        auto next = reconnect();
        if (!next) return;
        talk = std::move(*next);
    }
}

std::optional<Talk> Inverse3::reconnect() {
    for (;;) {
        const auto until = Clock::now() + wait_;
        while (!quit_ && Clock::now() < until) std::this_thread::sleep_for(10ms);
        if (quit_) return std::nullopt;
        wait_ = std::min<Clock::duration>(2 * wait_, longest_wait);
        Talk talk;
        try {
            if (start_talk(talk, address_, settings_.device, Clock::now() + connect_limit)
                    .empty()) {
                return talk;
            }
        } catch (const std::exception&) {  // no memory, no file descriptors: perhaps later
        }
    }
}

/// Until the connection ends: then it says why.
std::string Inverse3::converse(Talk& talk) {
    Questions questions;
    if (!talk.state.device_id.empty()) tell_identity(talk.state);
    while (!quit_) {
        const bool idle = talk.state.device_id.empty();
        auto now = Clock::now();
        const auto due = [&] {
            if (idle) return questions.last() + idle_pause;
            return questions.last() + (questions.missing() > 0 ? longest_pause : shortest_pause);
        };
        if (now >= due()) {
            if (!ask(talk, questions)) return talk.socket.error();
            continue;
        }
        // Waiting for the socket is no finer than a millisecond.
        if (questions.missing() == 0 && due() - now < 1ms) {
            std::this_thread::sleep_until(due());
            continue;
        }
        const Received received =
            talk.socket.receive(std::min<Clock::time_point>(due(), now + longest_pause));
        now = Clock::now();
        if (received.what == Received::What::closed) return talk.socket.error();
        if (received.what == Received::What::message) take(talk, received, questions.answered());
        if (questions.behind(now) > std::chrono::duration<double>(settings_.timeout)) {
            return "it does not keep up with answering";
        }
        if (received.what == Received::What::nothing && questions.behind(now) > longest_age) {
            tell(service_ + " does not answer");
        }
    }
    return {};
}

/// Sends the force; the answer is the next state.
bool Inverse3::ask(Talk& talk, Questions& questions) {
    const auto now = Clock::now();
    questions.asked(now);
    if (talk.state.device_id.empty()) return talk.socket.send(snapshot_command(), now + send_limit);
    ForceCommand command(talk.state.device_id, settings_.force_key);
    const Vec3 newtons = settings_.axes.transpose() * force(now);
    return talk.socket.send(command.with(newtons), now + send_limit);
}

/// The link's, if the gate lets it through and the newest position is not stale.
Vec3 Inverse3::force(Clock::time_point now) {
    if (now - measured_at_ > longest_age) gate_.note(false, monotonic_ns());
    return gate_.pass(link_.wrench().force, maximum_force, monotonic_ns());
}

void Inverse3::take(Talk& talk, const Received& received, Clock::time_point asked) {
    ServiceState& state = talk.state;
    News news = News::refused;
    if (received.binary) {
        state.error = "a binary message";
    } else {
        news = take_message(state, received.message);
    }
    switch (news) {
        case News::refused:
            gate_.note(false, monotonic_ns());
            link_.report(DeviceStatus::fault);
            tell(service_ + " sent " + state.error);
            break;
        case News::none:
            if (!state.error.empty()) {
                tell(problem_of(state));
            } else if (Clock::now() - measured_at_ > longest_age) {
                tell(state.device_id.empty() ? no_device(talk, address_)
                                             : service_ + " says nothing of " + state.device_id);
            }
            break;
        case News::gone:
            gate_.note(false, monotonic_ns());
            link_.report(DeviceStatus::lost);
            tell(no_device(talk, address_));
            break;
        case News::state:
            wait_ = first_wait;
            report_state(state, asked);
            tell(Clock::now() - asked > longest_age ? service_ + " answers too late"
                                                    : problem_of(state));
            break;
    }
}

void Inverse3::report_state(ServiceState& state, Clock::time_point asked) {
    if (settings_.assume_calibrated) state.calibrated = true;
    DeviceReading reading;
    if (state.position) reading.position = 1000 * (settings_.axes * *state.position);
    reading.orientation = settings_.axes * state.grip.orientation * settings_.axes.transpose();
    reading.buttons = state.grip.buttons;
    const auto age = Clock::now() - asked;
    reading.age = std::chrono::duration<double>(age).count();
    reading.status = status_of(state);
    link_.report(reading);

    measured_at_ = asked;
    gate_.note(reading.status == DeviceStatus::ready && age <= longest_age, monotonic_ns());
    if (told_grip_ != !state.grip.list.empty()) tell_identity(state);
}

void Inverse3::say_goodbye(Talk& talk) {
    if (talk.state.device_id.empty()) return;
    ForceCommand command(talk.state.device_id, settings_.force_key);
    if (talk.socket.send(command.with(Vec3::Zero()), Clock::now() + send_limit)) {
        talk.socket.close(Clock::now() + 100ms);
    }
}

}  // namespace palpate::devices::haply
