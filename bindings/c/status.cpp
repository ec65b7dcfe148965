// The last error of each thread. Its text has room of its own, so that running out of memory can be
// told, too.
#include "bindings/c/status.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "palpate/devices/error.hpp"
#include "palpate/io/error.hpp"

namespace palpate::c {
namespace {

thread_local std::array<char, 1024> last_error{};

palpate_status keep(palpate_status status, const char* text) noexcept {
    std::string shown;
    try {
        shown = io::one_line(io::without_secrets(text));  // at most 900 bytes
        text = shown.c_str();
    } catch (const std::bad_alloc&) {
        text = "not enough memory for the message";
    }
    const std::size_t length = std::min(std::strlen(text), last_error.size() - 1);
    std::memcpy(last_error.data(), text, length);
    last_error[length] = '\0';
    return status;
}

/// Progress function of palpate_set_progress().
thread_local OnProgress thread_progress;

struct InCallback {
    bool before = std::exchange(calls_back, true);
    InCallback() = default;
    InCallback(const InCallback&) = delete;
    InCallback& operator=(const InCallback&) = delete;
    ~InCallback() { calls_back = before; }
};

}  // namespace

OnProgress progress_by(int32_t (*progress)(double fraction, void* context), void* context,
                       const char* cancelled) {
    return [=](double fraction) {
        const InCallback in_callback;
        bool goes_on = false;
        try {
            goes_on = progress(fraction, context) != 0;
        } catch (const std::exception& error) {  // of a caller in C++
            throw Cancelled(std::string("the progress function threw an exception: ") +
                            error.what());
        }
        if (!goes_on) throw Cancelled(cancelled);
    };
}

OnProgress progress_of_thread() {
    return calls_back ? OnProgress() : thread_progress;
}

void forget_error() noexcept {
    last_error[0] = '\0';
}

palpate_status status_of_exception() noexcept {
    try {
        throw;
    } catch (const run::QueueFull& e) {
        return keep(PALPATE_QUEUE_FULL, e.what());
    } catch (const io::InputError& e) {
        return keep(PALPATE_INPUT, e.what());
    } catch (const io::OutputError& e) {
        return keep(PALPATE_OUTPUT, e.what());
    } catch (const devices::DeviceError& e) {
        return keep(PALPATE_NO_DEVICE, e.what());
    } catch (const WrongState& e) {
        return keep(PALPATE_WRONG_STATE, e.what());
    } catch (const NothingYet& e) {
        return keep(PALPATE_NOTHING_YET, e.what());
    } catch (const Cancelled& e) {
        return keep(PALPATE_CANCELLED, e.what());
    } catch (const std::bad_alloc&) {
        return keep(PALPATE_NO_MEMORY, "not enough memory");
    } catch (const std::system_error& e) {
        return keep(PALPATE_SYSTEM, e.what());
    } catch (const std::length_error& e) {
        return keep(PALPATE_INVALID, e.what());
    } catch (const std::invalid_argument& e) {
        return keep(PALPATE_INVALID, e.what());
    } catch (const std::exception& e) {
        return keep(PALPATE_INTERNAL, e.what());
    } catch (...) {
        return keep(PALPATE_INTERNAL, "an exception of an unknown kind");
    }
}

extern "C" PALPATE_API const char* palpate_last_error(void) {
    return last_error.data();
}

extern "C" PALPATE_API void palpate_set_progress(int32_t (*progress)(double fraction,
                                                                     void* context),
                                                 void* context) {
    thread_progress =
        progress ? progress_by(progress, context, "the call was cancelled") : OnProgress();
}

extern "C" PALPATE_API const char* palpate_version(void) {
    return PALPATE_VERSION;
}

}  // namespace palpate::c
