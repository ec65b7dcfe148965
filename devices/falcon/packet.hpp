// The Falcon's packets: 16 printable bytes each way. Each packet to the device is answered by one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpate::devices::falcon {

constexpr std::size_t packet_size = 16;
using Packet = std::array<unsigned char, packet_size>;

enum Light : unsigned { red = 2, green = 4, blue = 8 };

struct ToDevice {
    std::array<int, 3> motors{};  ///< -32768 to 32767
    unsigned lights = 0;          ///< bits of Light
    bool homes = false;           ///< ask for what homing has found

    bool operator==(const ToDevice&) const = default;
};
struct FromDevice {
    std::array<int, 3> encoders{};
    unsigned buttons = 0;  ///< bits 0 to 3
    unsigned homed = 0;    ///< bit for each motor; only with ToDevice::homes

    bool operator==(const FromDevice&) const = default;
};
constexpr unsigned all_homed = 7;

Packet packed(const ToDevice& message);
Packet packed(const FromDevice& message);

/// Finds the answers in a stream of bytes, whatever is before, between or in place of them.
class Answers {
  public:
    /// The newest whole answer in these bytes and what was left of those before. None: none was
    /// completed.
    std::optional<FromDevice> take(std::span<const unsigned char> bytes);

  private:
    std::array<unsigned char, packet_size> begun_{};
    std::size_t count_ = 0;
};

}  // namespace palpate::devices::falcon
