// Turns events of spacenavd into the motion of a hand.
#include "devices/spacenav/puck.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpate::devices::spacenav {
namespace {

constexpr double degree = 0.017453292519943295;

std::string_view trimmed(std::string_view text) {
    const char* const blank = " \t\r\n";
    const auto begin = text.find_first_not_of(blank);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

}  // namespace

void EventReader::take(std::span<const unsigned char> bytes) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ = 0;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<Event> EventReader::next() {
    std::uint32_t answer = 0;
    if (!was_answered_ && bytes_.size() - used_ >= sizeof answer) {
        std::memcpy(&answer, bytes_.data() + used_, sizeof answer);
        was_answered_ = answer >> 8 == protocol_1 >> 8;
        if (was_answered_) used_ += sizeof answer;
    }
    Event event;
    if (bytes_.size() - used_ < sizeof event) return std::nullopt;
    std::memcpy(event.data(), bytes_.data() + used_, sizeof event);
    used_ += sizeof event;
    return event;
}

void apply(Hand& hand, const Event& event, const Feel& feel) {
    if (event[0] == device) {
        release_all(hand);
        hand.is_unplugged = event[1] != 0;
        return;
    }
    if (event[0] == press || event[0] == release) {
        hand.is_unplugged = false;
        const auto button = static_cast<std::uint32_t>(event[1]);
        if (button >= 32) return;
        const std::uint32_t bit = std::uint32_t{1} << button;
        hand.buttons = event[0] == press ? hand.buttons | bit : hand.buttons & ~bit;
        return;
    }
    if (event[0] != motion) return;
    // The daemon's x points to the right and y up, like ours, but z away from the person; its
    // angles turn as they do in libspnav's own example, which shows them on a right-handed screen.
    const auto part = [&](std::size_t i) {
        return std::clamp(event[i] / feel.deflection, -1., 1.);
    };
    hand.slide = Vec3(part(1), part(2), -part(3));
    hand.twist = Vec3(part(4), part(5), -part(6));
    if (!hand.slide.isZero(0) || !hand.twist.isZero(0)) hand.is_unplugged = false;
}

void advance(Hand& hand, double time, const Feel& feel) {
    hand.position += feel.speed * time * hand.slide;
    hand.position = hand.position.cwiseMax(-reach).cwiseMin(reach);
    const double angle = degree * feel.turn * time * hand.twist.norm();
    if (!(angle > 0)) return;
    const Eigen::Quaterniond turned(
        Eigen::AngleAxisd(angle, hand.twist.normalized()).toRotationMatrix() * hand.orientation);
    hand.orientation = turned.normalized().toRotationMatrix();
}

void release_all(Hand& hand) {
    hand.slide.setZero();
    hand.twist.setZero();
    hand.buttons = 0;
}

std::vector<std::string> socket_paths(const std::string& environment,
                                      std::string_view configuration) {
    std::vector<std::string> paths;
    const auto add = [&](const std::string& path) {
        if (!path.empty() && std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
    };
    add(environment);
    while (!configuration.empty()) {
        const auto end = configuration.find('\n');
        const std::string_view line = trimmed(configuration.substr(0, end));
        configuration.remove_prefix(end == std::string_view::npos ? configuration.size() : end + 1);
        const auto equals = line.find('=');
        if (equals == std::string_view::npos || trimmed(line.substr(0, equals)) != "socket") {
            continue;
        }
        add(std::string(trimmed(line.substr(equals + 1))));
        break;
    }
    add("/var/run/spnav.sock");
    return paths;
}

}  // namespace palpate::devices::spacenav
