// The first steps of every helper program: it ties its life to its caller's.
// Header only, so that each program can use it without the others' libraries.
#pragma once

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <fstream>
#include <thread>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PALPATE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PALPATE_SANITIZED 1
#endif
#endif

namespace palpate::io {

/// Writes no core file, and is the first to be killed when memory runs out, before the process that
/// drives the device.
inline void step_back() {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    std::ofstream("/proc/self/oom_score_adj") << 1000;
}

/// Ends with the thread that started it, whose process is `caller` (from the request).
inline void go_with_caller(pid_t caller) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != caller) raise(SIGTERM);  // it died before that line
    step_back();
}

/// Ends when the other end of a socket is closed, whichever thread has started it and whatever a
/// library does then.
inline void go_with_socket(int descriptor) {
    std::thread([descriptor] {
        pollfd end{descriptor, 0, 0};
        while (end.revents == 0) poll(&end, 1, -1);
        _exit(1);
    }).detach();
    step_back();
}

}  // namespace palpate::io
