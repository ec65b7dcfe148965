// The thread of the device `spacenav`, 1000 times a second: read events, move the hand, report its
// pose. A puck at rest sends nothing, so only a closed socket is a sign of trouble.
#include "devices/spacenav/mouse.hpp"

#include <algorithm>
#include <utility>

#include "palpate/devices/error.hpp"

namespace palpate::devices::spacenav {
namespace {

constexpr std::int64_t period = 1'000'000;         // [ns]
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
             const Feel& feel, double rate)
    : paths_(std::move(paths)), feel_(feel) {
    info_.name = "spacenav";
    info_.model = "3D mouse, spacenavd at " + path;
    info_.limits.rate = rate;
    info_.workspace_low = Vec3::Constant(-reach);
    info_.workspace_high = Vec3::Constant(reach);
    info_.renders_force = false;
    info_.has_orientation = true;
    info_.buttons = 32;  // the protocol does not say how many there are
    report();
    thread_ = std::thread([this, first = std::move(socket)]() mutable { run(std::move(first)); });
}

Mouse::~Mouse() {
    quit_.store(true);
    thread_.join();
}

std::string Mouse::problem() const {
    if (connected_) return {};
    return "spacenavd has closed the connection; trying to connect again: is it running (systemctl "
           "status spacenavd)?";
}

void Mouse::run(Socket socket) {
    EventReader events;
    std::int64_t last = monotonic_ns(), next_attempt = 0;
    while (!quit_) {
        if (socket.wait_until(monotonic_ns() + period)) take_events(socket, events);
        const std::int64_t now = monotonic_ns();
        const std::int64_t passed = std::min(now - last, longest_step);
        last = now;
        if (socket.is_open()) {
            advance(hand_, 1e-9 * static_cast<double>(passed), feel_);
            report();
            continue;
        }
        if (connected_) {
            let_go(hand_);
            events = {};
            connected_.store(false);
        }
        link_.report(DeviceStatus::lost);
        if (now < next_attempt) continue;
        next_attempt = now + between_attempts;
        connected_.store(reconnect(socket));
    }
}

void Mouse::take_events(Socket& socket, EventReader& events) {
    std::array<unsigned char, most_at_once> bytes;
    const auto got = socket.read(bytes);
    if (!got) return;
    events.take(std::span(bytes).first(*got));
    while (const auto event = events.next()) apply(hand_, *event, feel_);
}

bool Mouse::reconnect(Socket& socket) const {
    for (const std::string& path : paths_) {
        if (socket.connect(path).empty()) return true;
    }
    return false;
}

void Mouse::report() noexcept {
    DeviceReading reading;
    reading.position = hand_.position;
    reading.orientation = hand_.orientation;
    reading.buttons = hand_.buttons;
    reading.status = DeviceStatus::ready;
    link_.report(reading);
}

}  // namespace palpate::devices::spacenav
