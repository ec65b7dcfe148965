// Runs a helper program and collects its answer. See the header.
#include "io/process/helper_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "io/helper/library_words.hpp"
#include "io/helper/protocol.hpp"
#include "io/process/helper_folders.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
}

/// Above the numbers that the helper expects, so that placing one cannot overwrite another.
Descriptor moved_up(int number) {
    const int up = fcntl(number, F_DUPFD_CLOEXEC, 16);
    const int error = errno;
    close(number);
    errno = error;
    if (up < 0) fail("no file descriptor left");
    return Descriptor(up);
}

struct Pipe {
    Descriptor read_end, write_end;
};

Pipe open_pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) fail("no pipe");
    Descriptor first(ends[0]);  // owned, should the second one fail
    Pipe pipe{std::move(first), moved_up(ends[1])};
    fcntl(pipe.read_end.number(), F_SETFL, O_NONBLOCK);
    return pipe;
}

/// "PALPATE_IO_HELPER" of "palpate-io-helper".
std::string variable_of(const HelperProgram& program) {
    std::string name = program.name;
    for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
    return name;
}

/// The program's file; an empty path if it is in none of `folders`.
fs::path find_program(const HelperJob& job, const std::vector<fs::path>& folders) {
    if (!job.path.empty()) return job.path;
    if (const char* set = std::getenv(variable_of(job.program).c_str())) return set;
    for (const fs::path& folder : folders) {
        if (access((folder / job.program.name).c_str(), X_OK) == 0) {
            return folder / job.program.name;
        }
    }
    return {};
}

std::string list_of(const std::vector<fs::path>& folders) {
    std::string text;
    for (const fs::path& folder : folders) text += (text.empty() ? "" : ", ") + folder.string();
    return text;
}

/// A child process that is dead and reaped when this object is gone.
class Child {
  public:
    explicit Child(pid_t pid) : pid_(pid) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (pid_ <= 0) return;
        kill(pid_, SIGKILL);
        int status = 0;
        while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
    }
    /// Waits for the end of a child that has closed its pipes, two seconds at most before it is
    /// killed. The status is waitpid's; 0 if the caller's program ignores SIGCHLD.
    int wait() {
        int status = 0;
        for (int tries = 0;; ++tries) {
            const pid_t ended = waitpid(pid_, &status, WNOHANG);
            if (ended == pid_ || (ended < 0 && errno != EINTR)) break;
            if (tries == 2000) kill(pid_, SIGKILL);
            usleep(1000);
        }
        pid_ = -1;
        return status;
    }

  private:
    pid_t pid_;
};

struct SpawnActions {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    SpawnActions() {
        posix_spawn_file_actions_init(&files);
        posix_spawnattr_init(&attributes);
    }
    ~SpawnActions() {
        posix_spawn_file_actions_destroy(&files);
        posix_spawnattr_destroy(&attributes);
    }
};

/// Returns the child's id, or 0 with errno set.
pid_t spawn(const fs::path& program, const HelperJob& job, const Descriptor& report,
            const Descriptor& errors) {
    SpawnActions actions;
    auto* files = &actions.files;
    posix_spawn_file_actions_addopen(files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(files, errors.number(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(files, errors.number(), STDERR_FILENO);
    if (job.memory) {
        posix_spawn_file_actions_adddup2(files, job.memory->number(), samples_descriptor);
    } else {
        posix_spawn_file_actions_addopen(files, samples_descriptor, "/dev/null", O_RDONLY, 0);
    }
    posix_spawn_file_actions_adddup2(files, report.number(), report_descriptor);
    if (job.mirror) {
        posix_spawn_file_actions_adddup2(files, job.mirror->number(), mirror_descriptor);
    }
    posix_spawn_file_actions_addclosefrom_np(
        files, job.mirror ? mirror_descriptor + 1 : report_descriptor + 1);
    // The caller may block or ignore Ctrl-C; the helper must not.
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&actions.attributes, &signals);
    for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) sigaddset(&signals, s);
    posix_spawnattr_setsigdefault(&actions.attributes, &signals);
    posix_spawnattr_setflags(&actions.attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

    std::vector<std::string> words = job.arguments;
    words.insert(words.begin(), program.string());
    std::vector<char*> argv;
    for (std::string& w : words) argv.push_back(w.data());
    argv.push_back(nullptr);
    pid_t pid = 0;
    errno = posix_spawn(&pid, program.c_str(), files, &actions.attributes, argv.data(), environ);
    return errno == 0 ? pid : 0;
}

/// The system then ends it with SIGXCPU, whatever a library in it does.
void limit_processor_time(pid_t pid, double seconds) {
    rlimit limit{};
    if (seconds <= 0 || prlimit(pid, RLIMIT_CPU, nullptr, &limit) != 0) return;
    limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(std::ceil(seconds)));
    prlimit(pid, RLIMIT_CPU, &limit, nullptr);
}

/// Reads the helper's messages until it closes both pipes.
class Listener {
  public:
    Listener(const HelperJob& job, const Descriptor& report, const Descriptor& errors)
        : job_(job), report_(report), errors_(errors) {}

    /// False if the time limit came first.
    bool listen() {
        const auto start = Clock::now();
        bool report_open = true, errors_open = true;
        while (report_open || errors_open) {
            pollfd fds[2] = {{report_open ? report_.number() : -1, POLLIN, 0},
                             {errors_open ? errors_.number() : -1, POLLIN, 0}};
            poll(fds, 2, 100);  // whatever it returns, the reads below do not block
            if (report_open) report_open = drain(report_, pending_);
            if (errors_open) errors_open = drain(errors_, error_text_);
            if (error_text_.size() > 8192) error_text_.erase(0, error_text_.size() - 4096);
            take_lines();
            if (job_.progress) job_.progress(fraction_);
            const std::chrono::duration<double> elapsed = Clock::now() - start;
            if (elapsed.count() > job_.time_limit_s) return false;
        }
        return true;
    }

    const nlohmann::json& done() const { return done_; }
    const std::string& error() const { return error_; }
    const std::string& doing() const { return doing_; }
    const std::string& error_text() const { return error_text_; }

  private:
    /// Reads what is there; false at the end of the stream.
    static bool drain(const Descriptor& from, std::string& to) {
        char buffer[4096];
        for (int i = 0; i < 64; ++i) {
            const ssize_t got = read(from.number(), buffer, sizeof buffer);
            if (got == 0) return false;
            if (got < 0) return errno == EAGAIN || errno == EINTR;
            to.append(buffer, static_cast<std::size_t>(got));
        }
        return true;
    }

    void take_lines() {
        std::size_t begin = 0;
        for (std::size_t end; (end = pending_.find('\n', begin)) != std::string::npos;) {
            const auto line =
                nlohmann::json::parse(pending_.begin() + static_cast<long>(begin),
                                      pending_.begin() + static_cast<long>(end), nullptr, false);
            begin = end + 1;
            if (!line.is_object()) continue;
            fraction_ = line.value("progress", fraction_);
            doing_ = line.value("doing", doing_);
            error_ = line.value("error", error_);
            if (line.contains("done")) done_ = line["done"];
        }
        pending_.erase(0, begin);
        if (pending_.size() > 1 << 20) pending_.clear();  // not our helper
    }

    const HelperJob& job_;
    const Descriptor& report_;
    const Descriptor& errors_;
    std::string pending_, error_text_, error_, doing_;
    nlohmann::json done_;
    double fraction_ = 0;
};

/// The last line of a library's error output, short enough for a message.
std::string last_words(const std::string& text) {
    const auto end = text.find_last_not_of(" \t\r\n");
    if (end == std::string::npos) return {};
    const auto begin = text.find_last_of('\n', end);
    const std::string line =
        library_words(text.substr(begin == std::string::npos ? 0 : begin + 1), 160);
    return line.empty() ? "" : " (" + line + ")";
}

std::string seconds_text(double seconds) {
    return std::to_string(std::lround(std::ceil(seconds))) + " s";
}

std::string failure_of(const HelperJob& job, const Listener& said, int status) {
    const HelperProgram& program = job.program;
    if (!said.error().empty()) return said.error();
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && said.done().is_object()) return {};
    const std::string where = said.doing().empty() ? "" : " at " + said.doing();
    if (WIFSIGNALED(status)) {
        const int s = WTERMSIG(status);
        if (s == SIGINT || s == SIGTERM || s == SIGHUP) return "interrupted";
        if (s == SIGXCPU) {
            return "it took more than " + seconds_text(job.processor_limit_s) +
                   " of processor time" + where + ": " + program.too_slow;
        }
        if (s == SIGKILL) {
            return "the helper process was killed" + where + ": most likely out of memory; " +
                   program.out_of_memory;
        }
        return program.who_crashes + std::string(" crashed") + where + " (" + strsignal(s) +
               "): " + program.after_crash + last_words(said.error_text());
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {  // the loader's
        return std::string("a library that it needs is missing: install what ") +
               "scripts/install_packages.sh names for io" + last_words(said.error_text());
    }
    return "the helper process ended without an answer" + where + ": check that " + program.name +
           " belongs to this version of Palpate" + last_words(said.error_text());
}

}  // namespace

Descriptor::~Descriptor() {
    close_now();
}

void Descriptor::close_now() {
    if (number_ >= 0) close(number_);
    number_ = -1;
}

Descriptor shared_memory() {
    const int number = memfd_create("palpate-samples", MFD_CLOEXEC);
    if (number < 0) fail("no shared memory");
    return moved_up(number);
}

Descriptor shared_memory(std::size_t bytes) {
    Descriptor memory = shared_memory();
    if (ftruncate(memory.number(), static_cast<off_t>(bytes)) != 0) fail("no memory");
    return memory;
}

std::shared_ptr<void> map_shared(const Descriptor& memory, std::size_t bytes) {
    void* at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, memory.number(), 0);
    if (at == MAP_FAILED) fail("the samples do not fit into memory");
    return {at, [bytes](void* mapped) { munmap(mapped, bytes); }};
}

HelperResult run_helper(const HelperJob& job) {
    const HelperProgram& helper = job.program;
    const std::vector<fs::path> folders = helper_folders();
    const fs::path path = find_program(job, folders);
    const std::string remedy = "; reinstall Palpate, or set " + variable_of(helper);
    if (path.empty()) {
        return {{}, helper.name + (" was not found in " + list_of(folders) + remedy)};
    }
    Pipe errors = open_pipe();
    Pipe report = open_pipe();
    const pid_t pid = spawn(path, job, report.write_end, errors.write_end);
    if (pid == 0) {
        return {{}, "cannot run '" + path.string() + "' (" + std::strerror(errno) + ")" + remedy};
    }
    Child child(pid);
    limit_processor_time(pid, job.processor_limit_s);
    // Only the helper may hold write ends; otherwise the end of its output would not be seen.
    report.write_end.close_now();
    errors.write_end.close_now();
    Listener listener(job, report.read_end, errors.read_end);
    if (!listener.listen()) {
        return {{}, "no answer after " + seconds_text(job.time_limit_s) + ": " + helper.too_slow};
    }
    return {listener.done(), failure_of(job, listener, child.wait())};
}

}  // namespace palpate::io
