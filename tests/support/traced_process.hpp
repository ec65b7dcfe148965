// Runs a piece of code in a process of its own and interferes with its system calls: ends it before
// one of them, or lets one fail. So a test meets every moment between two steps, without a clock.
// Linux on x86-64.
#pragma once

#include <functional>

namespace palpate::support {

/// One of the calls that change files, before it is made.
struct FileCall {
    long number;      ///< SYS_renameat2, SYS_openat, ...
    bool renames;     ///< one of the family of rename()
    bool takes_room;  ///< writes, or makes a file or folder
};

/// What happens to a call.
enum class Fate { made, killed, fails_without_room, fails };

/// Runs work() in a child process and asks about each of its calls that change files; `killed` ends
/// the process with SIGKILL, `fails` is EIO. Returns 0 if work() ended, 1 if it threw
/// io::OutputError, 2 if it threw something else, 1000 + N if signal N ended it.
int run_traced(const std::function<void()>& work, const std::function<Fate(const FileCall&)>& fate);

/// The same without a look at its calls, begun and not waited for. Returns the process.
int start_process(const std::function<void()>& work);
/// What became of it, as run_traced() says.
int end_of(int process);

/// From now on this process cannot exchange two names, as on some file systems (EINVAL).
void deny_exchange();
/// Nor give a file a mode, as where there are none (ENOSYS); nor can its children.
void deny_modes();

}  // namespace palpate::support
