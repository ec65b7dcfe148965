// Runs a servo in virtual time, tick by tick on the thread of the test.
#pragma once

#include "palpate/servo.hpp"
#include "support/virtual_time.hpp"

namespace palpate::support {

/// Settings of a servo for this.
inline ServoSettings stepped(ServoSettings settings = {}) {
    settings.clock = &virtual_now;
    return settings;
}

/// A tick when it is due. False once the session has ended.
inline bool tick(Servo& servo) {
    pass_until(servo.due());
    return servo.step();
}
inline void run(Servo& servo, int ticks) {
    for (int i = 0; i < ticks; ++i) tick(servo);
}

/// Ticks until the condition holds; false if it did not in so many of them.
template <class Condition>
bool ticks_until(Servo& servo, Condition&& condition, int most = 10'000) {
    for (int i = 0; i < most && !condition(); ++i) tick(servo);
    return condition();
}

}  // namespace palpate::support
