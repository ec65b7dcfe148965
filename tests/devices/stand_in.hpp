// Shared by the stand-ins for vendors' libraries, and by the tests that set and read their states.
#pragma once

#include <functional>
#include <mutex>

/// A function of the vendor's interface.
#define MOCK_EXPORT extern "C" __attribute__((visibility("default")))

namespace palpate::support {

/// The only one of its library, whose interface is one of globals. Lock `mutex` for all of `state`,
/// which can be copied.
template <class State>
struct StandIn {
    std::mutex mutex;
    State state;

    /// Runs a function that the test wants during a call, without the lock. Time may pass there.
    template <class... Arguments>
    void meanwhile(std::function<void(Arguments...)> State::*what, Arguments... arguments) {
        std::function<void(Arguments...)> happens;
        {
            const std::lock_guard lock(mutex);
            happens = state.*what;
        }
        if (happens) happens(arguments...);
    }
};

}  // namespace palpate::support
