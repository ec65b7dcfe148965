// Prepares signals and standard streams before a program does anything else.
#pragma once

namespace palpate::app {

/// Calls `on_signal` where the user or the system ends the program, so that a session lets go of
/// its forces on the way out. What cannot be written is an error of the write, no signal.
void handle_ends(void (*on_signal)(int));

/// A standard stream that is closed would give its number, and then its text, to the next file that
/// is opened. In its place: one that cannot be written, so that this is an error and no damage.
void occupy_closed_streams();

/// Whether standard output is a pipe whose reader has ended, as in `palpate ... | head`.
bool reader_has_gone();

}  // namespace palpate::app
