// Runs a helper program and collects its answer. See the header.
#include "io/process/helper_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <span>
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

/// A child process that is dead and reaped when this object is gone. In a fork of the process that
/// began it nothing happens to it.
class Child {
  public:
    Child() = default;
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (pid_ <= 0 || parent_ != getpid()) return;
        kill(pid_, SIGKILL);
        int status = 0;
        while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
    }
    void begin(pid_t pid) {
        pid_ = pid;
        parent_ = getpid();
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
    pid_t pid_ = -1, parent_ = -1;
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
    posix_spawn_file_actions_addclosefrom_np(files, report_descriptor + 1);
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

/// A helper that runs, and all that it says. In a talk it has an input.
class Running {
  public:
    explicit Running(const HelperJob& job, const Descriptor* input = nullptr)
        : job_(job), input_(input) {
        const std::vector<fs::path> folders = helper_folders();
        const fs::path path = find_program(job, folders);
        const std::string remedy = "; reinstall Palpate, or set " + variable_of(job.program);
        if (path.empty()) {
            failure_ = job.program.name + (" was not found in " + list_of(folders) + remedy);
            return;
        }
        const pid_t pid = spawn(path, job, report_.write_end, errors_.write_end);
        if (pid == 0) {
            failure_ = "cannot run '" + path.string() + "' (" + std::strerror(errno) + ")" + remedy;
            return;
        }
        child_.begin(pid);
        limit_processor_time(pid, job.processor_limit_s);
        // Only the helper may hold write ends; otherwise the end of its output would not be seen.
        report_.write_end.close_now();
        errors_.write_end.close_now();
    }

    void tell(const std::string& line) {
        const auto bytes = std::as_bytes(std::span(line));
        sending_.assign(bytes.begin(), bytes.end());
        done_ = {};
    }

    /// Listens until it has ended or, in a talk, has answered. `give`: of a talk.
    HelperResult result(const std::function<void(double)>& progress, const GiveBytes& give = {}) {
        if (!failure_.empty()) return {{}, failure_};
        if (!listen(progress, give)) {
            return {{},
                    "no answer after " + seconds_text(job_.time_limit_s) + ": " +
                        job_.program.too_slow};
        }
        if (has_answered(give)) return {done_, error_};
        return {done_, failure_of(child_.wait())};
    }

  private:
    bool has_answered(const GiveBytes& give) const {
        return give && (done_.is_object() || !error_.empty());
    }

    /// False if the time limit came first. What it asks for is sent before it is heard again, so
    /// that it cannot ask for more than one part at a time.
    bool listen(const std::function<void(double)>& progress, const GiveBytes& give) {
        auto start = Clock::now();
        while ((report_open_ || errors_open_) && !has_answered(give)) {
            const bool sends = !sending_.empty();
            const int report = report_.read_end.number(), errors = errors_.read_end.number();
            pollfd fds[3] = {{report_open_ && !sends ? report : -1, POLLIN, 0},
                             {errors_open_ ? errors : -1, POLLIN, 0},
                             {sends ? input_->number() : -1, POLLOUT, 0}};
            poll(fds, 3, 100);  // whatever it returns, what follows does not block
            if (sends) send_some();
            if (report_open_ && !sends) report_open_ = drain(report, pending_);
            if (errors_open_) errors_open_ = drain(errors, error_text_);
            if (error_text_.size() > 8192) error_text_.erase(0, error_text_.size() - 4096);
            take_lines(give, start);
            // What is being put in its place counts as written: it is not cancelled any more.
            if (progress && !placing_) progress(fraction_);
            const std::chrono::duration<double> elapsed = Clock::now() - start;
            if (elapsed.count() > job_.time_limit_s) return false;
        }
        return true;
    }

    void send_some() {
        const ssize_t sent = send(input_->number(), sending_.data() + sent_,
                                  sending_.size() - sent_, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0 && (errno == EAGAIN || errno == EINTR)) return;
        sent_ += static_cast<std::size_t>(std::max<ssize_t>(sent, 0));
        if (sent >= 0 && sent_ < sending_.size()) return;
        sending_.clear();  // all, or nobody listens any more
        sent_ = 0;
    }

    /// Reads what is there; false at the end of the stream.
    static bool drain(int from, std::string& to) {
        char buffer[4096];
        for (int i = 0; i < 64; ++i) {
            const ssize_t got = read(from, buffer, sizeof buffer);
            if (got == 0) return false;
            if (got < 0) return errno == EAGAIN || errno == EINTR;
            to.append(buffer, static_cast<std::size_t>(got));
        }
        return true;
    }

    void take_lines(const GiveBytes& give, Clock::time_point& start) {
        std::size_t begin = 0;
        for (std::size_t end;
             sending_.empty() && (end = pending_.find('\n', begin)) != std::string::npos;) {
            const auto line =
                nlohmann::json::parse(pending_.begin() + static_cast<long>(begin),
                                      pending_.begin() + static_cast<long>(end), nullptr, false);
            begin = end + 1;
            if (!line.is_object()) continue;
            fraction_ = line.value("progress", fraction_);
            doing_ = line.value("doing", doing_);
            placing_ = line.value("placing", placing_);
            error_ = line.value("error", error_);
            if (line.contains("done")) done_ = line["done"];
            if (!give || !line.contains("read")) continue;
            const auto part = line["read"].get<std::array<std::uint64_t, 2>>();
            const auto before = Clock::now();
            sending_ = give(part[0], part[1]);
            start += Clock::now() - before;
        }
        pending_.erase(0, begin);
        if (pending_.size() > 1 << 20) pending_.clear();  // not our helper
    }

    std::string failure_of(int status) const {
        const HelperProgram& program = job_.program;
        if (!error_.empty()) return error_;
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && done_.is_object()) return {};
        const std::string where = doing_.empty() ? "" : " at " + doing_;
        if (WIFSIGNALED(status)) {
            const int s = WTERMSIG(status);
            if (s == SIGINT || s == SIGTERM || s == SIGHUP) return "interrupted";
            if (s == SIGXCPU) {
                return "it took more than " + seconds_text(job_.processor_limit_s) +
                       " of processor time" + where + ": " + program.too_slow;
            }
            if (s == SIGKILL) {
                return "the helper process was killed" + where + ": most likely out of memory; " +
                       program.out_of_memory;
            }
            return program.who_crashes + std::string(" crashed") + where + " (" + strsignal(s) +
                   "): " + program.after_crash + last_words(error_text_);
        }
        if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {  // the loader's
            return std::string("a library that it needs is missing: install what ") +
                   "scripts/install_packages.sh names for io" + last_words(error_text_);
        }
        return "the helper process ended without an answer" + where + ": check that " +
               program.name + " belongs to this version of Palpate" + last_words(error_text_);
    }

    const HelperJob& job_;
    const Descriptor* const input_;
    Pipe errors_ = open_pipe(), report_ = open_pipe();
    Child child_;
    bool report_open_ = true, errors_open_ = true;
    std::string failure_;  // to run
    std::string pending_, error_text_, error_, doing_;
    nlohmann::json done_;
    double fraction_ = 0;
    bool placing_ = false;            // of a file that is written
    std::vector<std::byte> sending_;  // of which `sent_` bytes have gone
    std::size_t sent_ = 0;
};

/// The two ends of what a helper is told. Not a pipe: writing to a dead one would raise SIGPIPE.
Pipe open_input() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("no socket");
    Descriptor own(ends[0]);
    return {moved_up(ends[1]), std::move(own)};
}

struct Talk {
    explicit Talk(HelperJob of) : job(std::move(of)) {
        job.memory = &input.read_end;
        running.emplace(job, &input.write_end);
        input.read_end.close_now();
    }
    HelperJob job;
    Pipe input = open_input();
    std::optional<Running> running;
};

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
    return Running(job).result(job.progress);
}

HelperTalk talk_to_helper(HelperJob job) {
    const auto talk = std::make_shared<Talk>(std::move(job));
    return [talk](const nlohmann::json& question, const GiveBytes& give,
                  const std::function<void(double)>& progress) {
        talk->running->tell(line_from(question));
        return talk->running->result(progress, give);
    };
}

}  // namespace palpate::io
