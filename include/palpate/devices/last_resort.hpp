// Sends zero force to a device when a signal ends the program.
#pragma once

#include <cstddef>

#include "palpate/device.hpp"

namespace palpate::devices {

/// While one exists, a signal that ends or suspends the program calls device.stop(), leaves the
/// device's own thread 100 ms to send the zero, or up to 1 s where the device can tell that it has
/// not (Device::is_stopping()), and then does what it would have done: the same exit status, the
/// same core file. These are the crashes (SIGSEGV, SIGBUS, SIGILL, SIGFPE,
/// SIGTRAP, SIGSYS, SIGABRT and with it an exception that nobody catches), whatever handled them
/// before, and all others whose default action ends or suspends a program (SIGTERM, SIGALRM,
/// SIGUSR1, SIGXCPU, SIGTSTP, real-time signals, ...), unless the application handles or ignores
/// them: a handler of its own has to end the session. After a suspension the device stays without
/// force.
///
/// SIGKILL, SIGSTOP and loss of power are left to the device, and so is a crash of the very thread
/// that talks to it, in a vendor's driver for example, because no other thread can send the zero:
/// docs/devices says what each device does then. One for each device, up to `most` at once; more
/// throw std::logic_error.
class LastResort {
  public:
    static constexpr std::size_t most = 8;

    /// How a handler lets some milliseconds pass before it looks again whether the zero was sent;
    /// neither allocates nor locks. Null: it sleeps. The newest one holds for all.
    using Pause = void (*)(int milliseconds) noexcept;

    explicit LastResort(Device& device, Pause pause = nullptr);
    ~LastResort();
    LastResort(const LastResort&) = delete;
    LastResort& operator=(const LastResort&) = delete;

  private:
    std::size_t place_ = 0;
};

}  // namespace palpate::devices
