// Interferes with the system calls of a child process by ptrace and seccomp; see the header.
#include "support/traced_process.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/fs.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fcntl.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "palpate/io/error.hpp"

namespace palpate::support {
namespace {

constexpr std::array renaming{SYS_rename, SYS_renameat, SYS_renameat2};
constexpr std::array others{SYS_open,     SYS_openat, SYS_mkdir, SYS_mkdirat, SYS_unlink,
                            SYS_unlinkat, SYS_rmdir,  SYS_write, SYS_fsync,   SYS_syncfs};

void filter(std::vector<sock_filter> program) {
    program.insert(program.begin(), BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
    program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
    const sock_fprog all{static_cast<unsigned short>(program.size()), program.data()};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &all, 0, 0) != 0) {
        ::_exit(3);
    }
}

void trace_file_calls() {
    std::vector<sock_filter> program;
    const auto add = [&](long call) {
        program.push_back(
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1));
        program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE));
    };
    for (const long call : renaming) add(call);
    for (const long call : others) add(call);
    filter(program);
}

[[noreturn]] void run(const std::function<void()>& work) {
    try {
        work();
        ::_exit(0);
    } catch (const io::OutputError& e) {
        std::fprintf(stderr, "%s\n", e.what());  // a test may not expect it
        ::_exit(1);
    } catch (...) {
        ::_exit(2);
    }
}

int outcome_of(int status) {
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

#ifdef __x86_64__
FileCall call_of(const user_regs_struct& registers) {
    const auto number = static_cast<long>(registers.orig_rax);
    FileCall call{number, false, false};
    for (const long one : renaming) call.renames = call.renames || number == one;
    call.takes_room = number == SYS_write || number == SYS_mkdir || number == SYS_mkdirat ||
                      (number == SYS_openat && (registers.rdx & O_CREAT) != 0) ||
                      (number == SYS_open && (registers.rsi & O_CREAT) != 0);
    return call;
}

/// A call that is skipped has the number -1 and its result already.
void obey(pid_t thread, pid_t process, const std::function<Fate(const FileCall&)>& fate) {
    user_regs_struct registers{};
    ::ptrace(PTRACE_GETREGS, thread, nullptr, &registers);
    const Fate wanted = fate(call_of(registers));
    if (wanted == Fate::made) return;
    if (wanted == Fate::killed) {
        ::kill(process, SIGKILL);
        return;
    }
    registers.orig_rax = ~0ULL;
    registers.rax =
        static_cast<unsigned long long>(wanted == Fate::fails_without_room ? -ENOSPC : -EIO);
    ::ptrace(PTRACE_SETREGS, thread, nullptr, &registers);
}
#endif

}  // namespace

int start_process(const std::function<void()>& work) {
    std::fflush(nullptr);
    const pid_t process = ::fork();
    if (process == 0) run(work);
    return process;
}

int end_of(int process) {
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return outcome_of(status);
}

void deny_exchange() {
    constexpr auto flags = offsetof(seccomp_data, args) + 4 * sizeof(std::uint64_t);
    filter({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_renameat2, 0, 3),
            BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(flags)),
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, RENAME_EXCHANGE, 0, 1),
            BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EINVAL)});
}

void deny_modes() {
    std::vector<sock_filter> program;
    for (const long call : {SYS_chmod, SYS_fchmod, SYS_fchmodat}) {
        program.push_back(
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1));
        program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS));
    }
    filter(program);
}

int run_traced(const std::function<void()>& work,
               const std::function<Fate(const FileCall&)>& fate) {
#ifdef __x86_64__
    const pid_t child = start_process([&] {
        ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
        ::raise(SIGSTOP);
        trace_file_calls();
        work();
    });
    int status = 0;
    ::waitpid(child, &status, 0);
    constexpr long options =
        PTRACE_O_TRACESECCOMP | PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK | PTRACE_O_EXITKILL;
    if (!WIFSTOPPED(status) || ::ptrace(PTRACE_SETOPTIONS, child, nullptr, options) != 0) {
        throw std::runtime_error("this system does not let a process be traced");
    }
    ::ptrace(PTRACE_CONT, child, nullptr, nullptr);
    while (true) {
        const pid_t thread = ::waitpid(-1, &status, __WALL);
        if (thread < 0) return -1;
        if (!WIFSTOPPED(status)) {
            if (thread == child) return outcome_of(status);
            continue;
        }
        const int event = status >> 16, number = WSTOPSIG(status);
        if (event == PTRACE_EVENT_SECCOMP) obey(thread, child, fate);
        const bool of_tracing = event != 0 || number == SIGSTOP || number == SIGTRAP;
        ::ptrace(PTRACE_CONT, thread, nullptr, of_tracing ? 0L : static_cast<long>(number));
    }
#else
    (void)fate;
    return end_of(start_process(work));
#endif
}

}  // namespace palpate::support
