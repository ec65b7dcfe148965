// Report 1 has x, y and z, or all six axes in newer mice. Report 2 has the angles, and 3 the
// buttons.
#include "devices/spacenav/report.hpp"

#include <algorithm>

namespace palpate::devices::spacenav {

std::vector<Event> ReportReader::take(std::uint8_t number, std::span<const unsigned char> bytes) {
    const bool is_half = bytes.size() == 6, is_whole = bytes.size() == 12;
    if (number == 1 && (is_half || is_whole)) {
        take_axes(0, bytes);
        return {motion_event()};
    }
    if (number == 2 && is_half) {
        take_axes(3, bytes);
        return {motion_event()};
    }
    if (number != 3 || bytes.empty()) return {};
    std::uint32_t held = 0;
    for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 4); ++i) {
        held |= std::uint32_t{bytes[i]} << (8 * i);
    }
    std::vector<Event> events;
    for (std::int32_t button = 0; button < 32; ++button) {
        const std::uint32_t bit = std::uint32_t{1} << button;
        if ((held & bit) == (buttons_ & bit)) continue;
        events.push_back({(held & bit) != 0 ? press : release, button});
    }
    buttons_ = held;
    return events;
}

void ReportReader::take_axes(std::size_t first, std::span<const unsigned char> bytes) {
    for (std::size_t i = 0; 2 * i < bytes.size(); ++i) {
        axes_[first + i] = static_cast<std::int16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
    }
}

/// The mouse has y towards the person and z down. The daemon has y up and z away.
Event ReportReader::motion_event() const {
    const auto& [x, y, z, rx, ry, rz] = axes_;
    return {motion, x, -z, -y, rx, -rz, -ry, 0};
}

}  // namespace palpate::devices::spacenav
