// Turns failures into an exit status and one line, in the same way for every program of ours.
#pragma once

#include <exception>
#include <string>

namespace palpate::app {

/// See docs/command_line.md.
enum ExitStatus { done = 0, wrong_use = 2, bad_input = 3, no_device = 4, bad_output = 5 };
/// Exit status after a signal that ended the program, as shells report it: 130 for SIGINT, 143 for
/// SIGTERM.
constexpr int status_of_signal(int signal) {
    return 128 + signal;
}

struct Failure {
    ExitStatus status;
    std::string text;  ///< one line for people
};

/// Without line ends and other control characters, and not as long as the words of a command line
/// may be.
std::string one_line(std::string text);

/// What an exception that nobody caught means.
Failure failure_of(const std::exception& exception);

/// Prints the line on standard error, behind the program's name, without what gives access to
/// addresses in it (io::without_secrets()). Returns the status.
int fail(const std::string& text, int status);

}  // namespace palpate::app
