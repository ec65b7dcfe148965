// Sends zero force to a device when the program crashes.
#pragma once

#include <cstddef>

#include "palpate/device.hpp"

namespace palpate::devices {

/// While one exists, a crash of the program (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, and with it
/// an exception that nobody catches) calls device.stop(), leaves the device's own thread 25 ms to
/// send the zero, and then lets the crash go on as it would have: the same signal, the same core
/// file. What ends a program without asking (SIGKILL, loss of power) is left to the device, and so
/// is a crash of the very thread that talks to it, in a vendor's driver say, for nobody is left to
/// send the zero: see docs/devices for what each does then. One for each device, up to `most` at
/// once; more throw std::logic_error.
class LastResort {
  public:
    static constexpr std::size_t most = 8;

    explicit LastResort(Device& device);
    ~LastResort();
    LastResort(const LastResort&) = delete;
    LastResort& operator=(const LastResort&) = delete;

  private:
    std::size_t place_ = 0;
};

}  // namespace palpate::devices
