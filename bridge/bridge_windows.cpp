// The bridge needs sockets and events of Linux: on Windows it is refused before anything begins.
#include <stdexcept>

#include "bridge/bridge.hpp"

namespace palpate::bridge {

struct Bridge::Peer {};

Settings settings_from(const std::string&, bool) {
    throw std::invalid_argument(
        "OpenIGTLink is not spoken on Windows yet: run without it, or on Linux");
}

bool is_local(const Settings&) {
    return true;
}

Bridge::Bridge(const Settings& settings, Pace) {
    settings_ = settings_from(settings.host, settings.client);  // throws
}

Bridge::~Bridge() = default;

void Bridge::step(std::chrono::steady_clock::time_point) {}

void Bridge::show(const Snapshot&, bool) {}

std::vector<Request> Bridge::requests() {
    return {};
}

void Bridge::send(int, std::string_view, const std::string&) {}

void Bridge::send_surface(int, const SurfaceMesh&) {}

std::vector<std::string> Bridge::notes() {
    return {};
}

}  // namespace palpate::bridge
