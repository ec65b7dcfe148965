// A step of the device `spacenav`: read events, move the hand, report its pose. A puck at rest
// sends nothing, so only a closed socket is a sign of trouble.
#include "devices/spacenav/mouse.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "palpate/devices/error.hpp"

namespace palpate::devices::spacenav {
namespace {

constexpr std::int64_t longest_step = 20'000'000;  // [ns] no jump after the machine has stalled
constexpr std::int64_t between_attempts = 250'000'000;  // [ns] to connect again
constexpr std::size_t most_at_once = 4096;              // [bytes]

const char* const install =
    "install spacenavd (apt install spacenavd), plug in the 3D mouse and start the daemon "
    "(systemctl start spacenavd), or tell where its socket is: socket=PATH";

}  // namespace

std::string connect_to_any(Socket& socket, const std::vector<std::string>& paths) {
    std::string tried;
    for (const std::string& path : paths) {
        const std::string why = socket.connect(path);
        if (why.empty()) return path;
        tried += (tried.empty() ? "" : "; ") + path + ": " + why;
    }
    throw DeviceError("no spacenavd listens (" + tried + "): " + install);
}

Mouse::Mouse(Socket socket, const std::string& path, std::vector<std::string> paths,
             const Feel& feel, double rate, const Timing& timing)
    : LinkedDevice(timing, period),
      paths_(std::move(paths)),
      feel_(feel),
      socket_(std::move(socket)),
      stepped_(timing.now()) {
    info_.name = "spacenav";
    info_.model = "3D mouse, spacenavd at " + path;
    info_.limits.rate = rate;
    info_.workspace_low = Vec3::Constant(-reach);
    info_.workspace_high = Vec3::Constant(reach);
    info_.renders_force = false;
    info_.has_orientation = true;
    info_.buttons = 32;  // the protocol does not say how many there are
    ask_for_protocol_1();
    report(stepped_);
}

Mouse::~Mouse() {
    end_thread();
}

std::string Mouse::problem() const {
    if (connected_ && unplugged_) return "the 3D mouse was unplugged: plug it in again";
    if (connected_) return {};
    return "spacenavd has closed the connection; trying to connect again: is it running (systemctl "
           "status spacenavd)?";
}

void Mouse::step() {
    take_events();
    const std::int64_t now = timing_.now();
    const std::int64_t passed = std::min(now - std::exchange(stepped_, now), longest_step);
    if (socket_.is_open()) {
        advance(hand_, 1e-9 * static_cast<double>(passed), feel_);
        return report(now);
    }
    if (connected_) {
        release_all(hand_);
        hand_.is_unplugged = false;
        events_ = {};
        connected_.store(false);
    }
    link_.report(DeviceStatus::lost, now);
    if (now < next_attempt_) return;
    next_attempt_ = now + between_attempts;
    connected_.store(reconnect());
}

void Mouse::take_events() {
    std::array<unsigned char, most_at_once> bytes;
    const auto got = socket_.read(bytes);
    if (!got) return;
    events_.take(std::span(bytes).first(*got));
    while (const auto event = events_.next()) apply(hand_, *event, feel_);
}

bool Mouse::reconnect() {
    for (const std::string& path : paths_) {
        if (!socket_.connect(path).empty()) continue;
        ask_for_protocol_1();
        return true;
    }
    return false;
}

void Mouse::ask_for_protocol_1() {
    std::array<unsigned char, sizeof protocol_1> bytes;
    std::memcpy(bytes.data(), &protocol_1, sizeof protocol_1);
    socket_.write(bytes);
}

void Mouse::report(std::int64_t now) noexcept {
    unplugged_.store(hand_.is_unplugged);
    if (hand_.is_unplugged) return link_.report(DeviceStatus::lost, now);
    DeviceReading reading;
    reading.position = hand_.position;
    reading.orientation = hand_.orientation;
    reading.buttons = hand_.buttons;
    reading.status = DeviceStatus::ready;
    link_.report(reading, now);
}

}  // namespace palpate::devices::spacenav
