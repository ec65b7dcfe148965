// Sends zero force to a device when a signal ends the program.
#pragma once

#include <cstddef>

#include "palpate/device.hpp"

namespace palpate::devices {

/// While one exists, a signal that ends or suspends the program first calls device.stop(). The
/// device's own thread then has 100 ms to send the zero, or up to 1 s while the device reports that
/// the zero is still on its way (Device::is_stopping()). Then the signal has its usual effect: the
/// same exit status, the same core file. These signals are the crashes (SIGSEGV, SIGBUS, SIGILL,
/// SIGFPE, SIGTRAP, SIGSYS, SIGABRT, also from an uncaught exception), whatever handled them
/// before, and handles them again when the last LastResort has ended. They are also all others
/// whose default action ends or suspends a program (SIGTERM, SIGALRM, SIGUSR1, SIGXCPU, SIGTSTP,
/// real-time signals, ...), unless the application handles or ignores them. Its own handler then
/// has to end the session. After a suspension the device stays without force.
///
/// It has no effect for SIGKILL, SIGSTOP and loss of power. Nor does it help if the thread that
/// communicates with the device crashes, for example in a vendor's driver, because no other thread
/// can send the zero. docs/devices describes the behaviour of each device in these cases. One for
/// each device, up to `most` at once; more throw std::logic_error.
class LastResort {
  public:
    static constexpr std::size_t most = 8;

    /// How a handler waits some milliseconds before it checks again whether the zero was sent;
    /// neither allocates nor locks. Null: it sleeps. The newest one applies to all.
    using Pause = void (*)(int milliseconds) noexcept;

    explicit LastResort(Device& device, Pause pause = nullptr);
    ~LastResort();
    LastResort(const LastResort&) = delete;
    LastResort& operator=(const LastResort&) = delete;

  private:
    std::size_t place_ = 0;
};

}  // namespace palpate::devices
