// Sends zero force to a device when the program crashes.
#pragma once

#include "palpate/device.hpp"

namespace palpate::devices {

/// While one exists, a crash of the program (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, and with it
/// an exception that nobody catches) calls device.stop(), leaves the device's own thread 25 ms to
/// send the zero, and then lets the crash go on as it would have: the same signal, the same core
/// file. What ends a program without asking (SIGKILL, loss of power) is left to the device, and so
/// is a crash of the very thread that talks to it, in a vendor's driver say, for nobody is left to
/// send the zero: see docs/devices for what each does then. One at a time; a second one throws
/// std::logic_error.
class LastResort {
  public:
    explicit LastResort(Device& device);
    ~LastResort();
    LastResort(const LastResort&) = delete;
    LastResort& operator=(const LastResort&) = delete;
};

}  // namespace palpate::devices
