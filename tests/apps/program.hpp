// Runs the built program as a person would: words in, exit status and text out. Linux.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/eventually.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::app::test {

using support::comes_true;
using support::contains;
using support::ScratchFolder;
using Words = std::vector<std::string>;

inline Words words_of(const std::string& line) {
    std::istringstream in(line);
    Words words;
    for (std::string word; in >> word;) words.push_back(word);
    return words;
}

inline Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

struct Outcome {
    int status = -1;  ///< exit status, or 1000 + the signal that ended it
    std::string out, err;
};

enum class Stdout { captured, closed, full };

/// The program in a process group of its own, so that one sees what it leaves running.
class Running {
  public:
    Running(const Words& words, const std::filesystem::path& folder, Stdout to = Stdout::captured,
            const std::string& program = PALPATE_PROGRAM)
        : out_(std::tmpfile()), err_(std::tmpfile()) {
        std::vector<char*> argv{const_cast<char*>(program.c_str())};
        for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
        argv.push_back(nullptr);
        pid_ = ::fork();
        if (pid_ != 0) {
            ::setpgid(pid_, pid_);  // both sides do: whichever comes first
            return;
        }
        ::setpgid(0, 0);
        ::dup2(::open("/dev/null", O_RDONLY), 0);
        ::dup2(to == Stdout::full ? ::open("/dev/full", O_WRONLY) : ::fileno(out_), 1);
        ::dup2(::fileno(err_), 2);
        ::close_range(3, ~0U, 0);
        // No window on the screen of the person who runs the tests.
        if (!std::getenv("PALPATE_VIEWER")) ::unsetenv("DISPLAY");
        if (to == Stdout::closed) ::close(1);
        if (::chdir(folder.c_str()) == 0) ::execvp(program.c_str(), argv.data());
        ::_exit(127);
    }
    ~Running() {
        if (!ended_) (void)finish(SIGKILL);
        std::fclose(out_);
        std::fclose(err_);
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    /// True once it would react to the signal instead of being killed by it.
    bool catches(int signal) const {
        const std::string mask = status("SigCgt:");
        return !mask.empty() && (std::stoull(mask, nullptr, 16) >> (signal - 1) & 1) != 0;
    }

    /// Whether it has opened this file and waits for something.
    bool waits_with(const std::filesystem::path& path) const {
        std::error_code gone;
        const std::filesystem::directory_iterator files("/proc/" + std::to_string(pid_) + "/fd",
                                                        gone);
        for (const auto& file : files) {
            if (std::filesystem::read_symlink(file, gone) == path) {
                return contains(status("State:"), "sleeping");
            }
        }
        return false;
    }

    /// Whether it has written this to standard error so far. The place where it writes stays.
    bool has_said(const std::string& words) const {
        struct stat file {};
        if (::fstat(::fileno(err_), &file) != 0) return false;
        std::string text(static_cast<std::size_t>(file.st_size), '\0');
        const ssize_t got = ::pread(::fileno(err_), text.data(), text.size(), 0);
        text.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
        return contains(text, words);
    }

    void signal(int signal) const { ::kill(pid_, signal); }

    /// Sends `signal` (0: none) and waits for the end.
    Outcome finish(int signal = 0) {
        if (signal != 0) ::kill(pid_, signal);
        int status = 0;
        while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        ended_ = true;
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), text_of(out_),
                text_of(err_)};
    }

    /// Whether it has ended by itself; finish() says how.
    bool has_ended() const {
        siginfo_t info{};
        return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
               info.si_pid == pid_;
    }

    /// After the end: whether a process that it started lives on.
    bool left_a_process() const { return ::kill(-pid_, 0) == 0; }

  private:
    /// A line of what the system says about it.
    std::string status(const std::string& name) const {
        std::ifstream lines("/proc/" + std::to_string(pid_) + "/status");
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with(name)) return line.substr(name.size());
        }
        return {};
    }

    static std::string text_of(std::FILE* file) {
        std::string text(static_cast<std::size_t>(
                             std::max(0L, (std::fseek(file, 0, SEEK_END), std::ftell(file)))),
                         '\0');
        std::rewind(file);
        text.resize(std::fread(text.data(), 1, text.size(), file));
        return text;
    }

    std::FILE* out_;
    std::FILE* err_;
    pid_t pid_ = -1;
    bool ended_ = false;
};

inline Outcome palpate(const ScratchFolder& folder, const Words& words,
                       Stdout to = Stdout::captured) {
    return Running(words, folder.path(), to).finish();
}

inline Outcome palpate(const ScratchFolder& folder, const std::string& line,
                       Stdout to = Stdout::captured) {
    return palpate(folder, words_of(line), to);
}

/// What a line of Bash does, in which "$0" is the program.
inline Outcome by_bash(const ScratchFolder& folder, const std::string& line) {
    return Running({"-c", line, PALPATE_PROGRAM}, folder.path(), Stdout::captured, "/bin/bash")
        .finish();
}

/// The outcome of a command that has to succeed.
inline Outcome succeeds(const ScratchFolder& folder, const auto& words) {
    Outcome outcome = palpate(folder, words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome;
}

inline bool is_one_line(const std::string& text) {
    return text.rfind("palpate: ", 0) == 0 && text.find('\n') == text.size() - 1;
}

/// A failure as the contract wants it: the status, one line on standard error with `reason` in it,
/// nothing on standard output.
inline void expect_failure(const Outcome& outcome, int status, const std::string& reason) {
    EXPECT_EQ(outcome.status, status);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, reason)) << outcome.err;
}

/// A real volume; the calling test is skipped where it is absent.
inline std::filesystem::path data_file(const std::string& name) {
    return std::filesystem::path(PALPATE_DATA_FOLDER) / name;
}
#define SKIP_WITHOUT(name)                                             \
    if (!std::filesystem::exists(palpate::app::test::data_file(name))) \
    GTEST_SKIP() << (name) << " is not there"

/// A short motion through a small synthetic volume and out again: `t.csv` in the folder.
inline void put_trajectory(const ScratchFolder& folder, const std::string& name = "t.csv") {
    support::put_bytes(folder / name,
                       "t,x,y,z\n0,-20,0.1,0.2\n0.001,-12,0.1,0.2\n0.002,-9,0.3,0.1\n"
                       "0.003,-8,1.5,0.7\n0.004,-8,2.5,1.7\n0.005,-20,2.5,1.7\n");
}

/// A folder that has it.
struct MotionFolder : ScratchFolder {
    MotionFolder() { put_trajectory(*this); }
};

}  // namespace palpate::app::test
