// Starts volume_server.py for a test, and ends it.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::stream::test {

class VolumeServer {
  public:
    /// `options`: as on its command line.
    explicit VolumeServer(std::vector<std::string> options = {}) {
        int to[2], from[2];
        if (::pipe2(to, O_CLOEXEC) != 0 || ::pipe2(from, O_CLOEXEC) != 0) {
            throw std::runtime_error("no pipes");
        }
        options.insert(options.begin(), {PALPATE_ZARR_PYTHON, "-B",
                                         std::string(PALPATE_STREAM_TESTS) + "/volume_server.py"});
        std::vector<char*> words;
        for (std::string& option : options) words.push_back(option.data());
        words.push_back(nullptr);
        process_ = ::fork();
        if (process_ == 0) {
            ::dup2(to[0], STDIN_FILENO);
            ::dup2(from[1], STDOUT_FILENO);
            ::execv(words[0], words.data());
            ::_exit(127);
        }
        ::close(to[0]);
        ::close(from[1]);
        input_ = to[1];
        char c = 0;
        while (::read(from[0], &c, 1) == 1 && c != '\n') port_ += c;
        ::close(from[0]);
        if (port_.empty()) throw std::runtime_error("volume_server.py does not start");
    }
    ~VolumeServer() {
        answer_again();
        ::close(input_);  // it ends with its input
        ::waitpid(process_, nullptr, 0);
    }
    VolumeServer(const VolumeServer&) = delete;
    VolumeServer& operator=(const VolumeServer&) = delete;

    /// Connections stay open but nothing more is answered.
    void stop_answering() const { ::kill(process_, SIGSTOP); }
    void answer_again() const { ::kill(process_, SIGCONT); }

    std::string address(const std::string& path = "") const {
        return "http://127.0.0.1:" + port_ + "/" + path;
    }

  private:
    pid_t process_ = 0;
    int input_ = -1;
    std::string port_;
};

/// The virtual volume's formula, as volume_server.py has it: sample `index` of a level.
template <class Index>
int virtual_sample(int level, const Index& index) {
    double square = 0;
    for (int a = 0; a < 3; ++a) {
        const double position = (index[a] + 0.5) * std::ldexp(1.0, level) - 0.5;
        const double offset = position - 768 * std::floor(position / 768) - 384;
        square += offset * offset;
    }
    return static_cast<int>(
        std::clamp(std::floor(128.5 + (256 - std::sqrt(square)) / 2), 0.0, 255.0));
}

}  // namespace palpate::stream::test
