// An open Falcon behind libftdi: loads its firmware and exchanges packets. Every call is bounded:
// it ends after a number of reads that bring nothing, each of which takes a latency time.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/falcon/ftdi.hpp"
#include "devices/falcon/packet.hpp"

namespace palpate::devices::falcon {

// On USB.
constexpr int vendor_id = 0x0403;   // ours: of FTDI, in udev rules
constexpr int product_id = 0xcb48;  // ours

/// libftdi reports an error: the device is gone, or the bus is.
class PortError : public DeviceError {
  public:
    using DeviceError::DeviceError;
};

class Port {
  public:
    /// Opens the Falcon with this index, ready for packets. Throws PortError.
    Port(const Ftdi& ftdi, unsigned int index);
    ~Port();
    Port(const Port&) = delete;
    Port& operator=(const Port&) = delete;

    /// Sends a packet and waits for its answer for `most_waits` ms at most. None: there was none.
    /// Throws PortError.
    std::optional<FromDevice> exchange(const ToDevice& message, int most_waits);

    /// Starts the loader of a device that was just switched on, and gives it the firmware. It has
    /// to send back every byte. Empty, or what went wrong. Takes some 2 s. Throws PortError.
    std::string load(std::span<const unsigned char> firmware);

  private:
    void check(int result, const char* step) const;
    void use_packets();
    void write(std::span<const unsigned char> bytes);
    /// As many as have arrived, `size` at most, after `most_waits` empty reads.
    std::vector<unsigned char> read(std::size_t size, int most_waits);
    bool starts_loader();

    void forget_late_answer();

    const Ftdi& ftdi_;
    void* context_;
    Answers answers_;
    bool is_answered_ = true;  // the last packet
};

}  // namespace palpate::devices::falcon
