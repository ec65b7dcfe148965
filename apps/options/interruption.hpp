// Signals that ask the program to end. Long work asks whether one has come.
#pragma once

namespace palpate::app {

/// Thrown where a signal such as that of Ctrl-C was seen: open files are dropped by unwinding (exit
/// status 128 + the signal's number).
struct Interrupted {};
/// A signal handler that counts SIGINT, SIGTERM, SIGHUP and SIGQUIT.
void count_interruption(int signal);
/// The last one that was counted.
int last_interruption();
/// How often one has come.
int interruptions();
inline bool interrupted() {
    return interruptions() > 0;
}
/// Throws Interrupted if so. It may be the OnProgress of long work, whatever part is done.
void stop_if_interrupted(double fraction = 0);

}  // namespace palpate::app
