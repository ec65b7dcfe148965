// The two ways input and output fail. Each message is one short line that stands alone: the file,
// what is wrong, what to do. Header only, so that every reader and writer can throw them.
#pragma once

#include <stdexcept>
#include <string>
#include <system_error>

namespace palpate::io {

/// A message as one line of at most 900 characters, whatever a file made it quote: control
/// characters become blanks, and of a longer text the beginning and the end are kept.
inline std::string one_line(std::string text) {
    constexpr std::size_t beginning = 640, end = 250;
    if (text.size() > beginning + end) {
        text.replace(beginning, text.size() - beginning - end, " ... ");
    }
    for (char& c : text) {
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
    }
    return text;
}

/// Input could not be read or is not valid (exit status 3).
class InputError : public std::runtime_error {
  public:
    explicit InputError(const std::string& message) : std::runtime_error(one_line(message)) {}
};

/// Output could not be written (exit status 5). Nothing half-written is left behind.
class OutputError : public std::runtime_error {
  public:
    explicit OutputError(const std::string& message) : std::runtime_error(one_line(message)) {}
};

/// The system's description of an errno.
inline std::string reason(int error) {
    return std::generic_category().message(error);
}

}  // namespace palpate::io
