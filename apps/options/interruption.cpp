// Counts the signals that ask the program to end.
#include "apps/options/interruption.hpp"

#include <csignal>

namespace palpate::app {
namespace {

volatile std::sig_atomic_t last_signal = 0, signals = 0;

}  // namespace

void count_interruption(int signal) {
    last_signal = signal;
    signals = signals + 1;
}

int last_interruption() {
    return last_signal;
}

int interruptions() {
    return signals;
}

void stop_if_interrupted(double /*fraction*/) {
    if (interrupted()) throw Interrupted{};
}

}  // namespace palpate::app
