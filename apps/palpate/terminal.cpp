// Reads keys by termios and poll.
#include "apps/palpate/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace palpate::app {

/// The terminal's settings before keys were read one at a time.
struct Keys::Before {
    termios settings{};
};

Keys::Keys() : before_(std::make_unique<Before>()) {
    // A program in the background that touches its terminal is stopped: leave it alone then.
    if (!::isatty(STDIN_FILENO) || !::isatty(STDERR_FILENO)) return;
    if (::tcgetpgrp(STDIN_FILENO) != ::getpgrp()) return;
    if (::tcgetattr(STDIN_FILENO, &before_->settings) != 0) return;
    termios raw = before_->settings;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    available_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
}

Keys::~Keys() {
    if (available_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_->settings);
}

void stay_awake() {
    for (const int s : {SIGTSTP, SIGTTIN, SIGTTOU}) std::signal(s, SIG_IGN);
}

std::size_t terminal_columns() {
    winsize size{};
    const bool told = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return told ? size.ws_col : 80;
}

std::optional<char> Keys::next() {
    if (!available_) return std::nullopt;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char key = 0;
    if (::poll(&input, 1, 0) != 1 || ::read(STDIN_FILENO, &key, 1) != 1) return std::nullopt;
    return key;
}

}  // namespace palpate::app
