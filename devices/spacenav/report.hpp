// Reports of a 3D mouse itself (HID), as the events that spacenavd would make of them. For a
// program that reads the mouse without the daemon, such as a page by WebHID. No input or output
// here.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "devices/spacenav/puck.hpp"

namespace palpate::devices::spacenav {

/// Axes and buttons come in reports of their own, and only when they change.
class ReportReader {
  public:
    /// `bytes` are those after the report's number. Reports of unknown numbers and odd lengths give
    /// no event.
    std::vector<Event> take(std::uint8_t number, std::span<const unsigned char> bytes);

  private:
    void take_axes(std::size_t first, std::span<const unsigned char> bytes);
    Event motion_event() const;

    std::array<std::int32_t, 6> axes_{};  // x y z rx ry rz of the mouse
    std::uint32_t buttons_ = 0;
};

}  // namespace palpate::devices::spacenav
