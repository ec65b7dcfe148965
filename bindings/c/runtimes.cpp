// Signals of garbage collectors. Linux.
#include "bindings/c/runtimes.hpp"

#include <pthread.h>

#include <csignal>

namespace palpate::c {

void let_runtimes_stop_this_thread() noexcept {
    sigset_t theirs;
    ::sigemptyset(&theirs);
    ::sigaddset(&theirs, SIGPWR);
    ::sigaddset(&theirs, SIGXCPU);
    for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) ::sigaddset(&theirs, signal);
    ::pthread_sigmask(SIG_UNBLOCK, &theirs, nullptr);
}

}  // namespace palpate::c
