// How the system tells that the program crashes, is ended or is suspended. For last_resort.cpp: a
// handler can reach globals only.
#pragma once

namespace palpate::devices {

/// Tells all guarded devices to stop. True if there is a zero to wait for, also one that another
/// handler has asked for. Safe in a signal handler.
bool stop_guarded() noexcept;
/// Waits until the devices that were told to stop have sent their zeros. Safe in a signal handler.
void wait_for_zeros() noexcept;

/// Calls the functions above before each end of the program from now on. Again for each device.
void handle_ends();
/// Gives the ends back to what handled them before.
void forget_ends();
/// Signals to the program go to other threads than the calling one, but for its own crashes.
void leave_ends_to_others() noexcept;
/// Sleeps in a handler.
void sleep_in_handler(int milliseconds) noexcept;

}  // namespace palpate::devices
