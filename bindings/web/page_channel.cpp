// Functions of a socket and of the system that the devices need, as far as a page has them.
#include "bindings/web/page_channel.hpp"

#include "devices/link.hpp"
#include "palpate/io/trajectory.hpp"

namespace palpate::web {

using devices::haply::Address;
using devices::haply::Clock;
using devices::haply::Received;

bool PageChannel::connect(const Address&, Clock::time_point) {
    if (line_.call<bool>("connect")) return true;
    error_ = line_["error"].as<std::string>();
    return false;
}

bool PageChannel::send(std::string_view message, Clock::time_point) {
    if (line_.call<bool>("send", std::string(message))) return true;
    error_ = line_["error"].as<std::string>();
    return false;
}

Received PageChannel::receive(Clock::time_point) {
    const emscripten::val next = line_.call<emscripten::val>("next");
    if (next.isNull()) {
        if (line_["isOpen"].as<bool>()) return {Received::What::nothing, false, {}};
        error_ = line_["error"].as<std::string>();
        return {Received::What::closed, false, {}};
    }
    if (!next.isString()) return {Received::What::message, true, {}};
    message_ = next.as<std::string>();
    return {Received::What::message, false, message_};
}

void PageChannel::close(Clock::time_point) {
    line_.call<void>("close");
}

void PageChannel::drop() noexcept {
    line_.call<void>("close");
}

}  // namespace palpate::web

// Devices of a page have no thread of their own: the loop steps them.
namespace palpate::devices {

void prepare_device_thread() noexcept {}

void sleep_until(std::int64_t) noexcept {}

}  // namespace palpate::devices

namespace palpate::devices::haply {

/// The browser looks names up itself.
Address look_up(const std::string& host, std::uint16_t port) {
    return {host, port, {host}};
}

}  // namespace palpate::devices::haply

namespace palpate::io {

/// Reads the file of the simulated hand's option `file`.
Trajectory read_trajectory(const std::filesystem::path& path) {
    throw InputError(path.string() + ": a page has no files; choose one of the hand's motions");
}

}  // namespace palpate::io
