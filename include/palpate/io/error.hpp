// The two ways input and output fail. Each message is one line that stands alone: the file, what is
// wrong, what to do. Header only, so that every reader and writer can throw them.
#pragma once

#include <stdexcept>
#include <string>
#include <system_error>

namespace palpate::io {

/// Input could not be read or is not valid (exit status 3).
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Output could not be written (exit status 5). Nothing half-written is left behind.
class OutputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The system's description of an errno.
inline std::string reason(int error) {
    return std::generic_category().message(error);
}

}  // namespace palpate::io
