// How functions of the C interface end: every exception becomes a status and a line of text that
// the calling thread can ask for.
#pragma once

#include <stdexcept>
#include <string>

#include "palpate-c/palpate.h"
#include "palpate/run/run.hpp"

namespace palpate::c {

using run::WrongState;

/// There was no tick yet.
class NothingYet : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};
/// A progress callback asked to stop.
class Cancelled : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// This thread is in a callback: those of an own device, or a progress function.
inline thread_local bool calls_back = false;

/// Calls a caller's progress function; throws Cancelled with this text when it returns 0.
OnProgress progress_by(int32_t (*progress)(double fraction, void* context), void* context,
                       const char* cancelled);
/// Calls what palpate_set_progress() set for this thread; nothing in a callback, which could be
/// that function itself.
OnProgress progress_of_thread();

/// Forgets this thread's last error.
void forget_error() noexcept;
/// Keeps the text of the exception that is being handled as this thread's last error, and returns
/// its status. Only in a catch block.
palpate_status status_of_exception() noexcept;

/// Runs `work`, and returns how it ended.
template <class Work>
palpate_status guarded(Work&& work) noexcept {
    try {
        work();
        forget_error();  // also that of a call in a callback
        return PALPATE_OK;
    } catch (...) {
        return status_of_exception();
    }
}

/// Throws std::invalid_argument for a null pointer, by the name that the header gives it.
template <class T>
T& given(T* pointer, const char* name) {
    if (!pointer) throw std::invalid_argument(std::string(name) + " is null");
    return *pointer;
}

}  // namespace palpate::c
