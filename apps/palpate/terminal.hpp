// Keys from a terminal, one at a time, without waiting.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

namespace palpate::app {

/// While one exists, and standard input and standard error are a terminal, keys come without Enter
/// and are not echoed. The terminal is put back as it was at the end.
class Keys {
  public:
    Keys();
    ~Keys();
    Keys(const Keys&) = delete;
    Keys& operator=(const Keys&) = delete;

    bool available() const { return available_; }
    /// A key that was pressed since the last call; nothing if none was.
    std::optional<char> next();

  private:
    struct Before;
    bool available_ = false;
    std::unique_ptr<Before> before_;
};

/// A program that is suspended could not end the force: from now on Ctrl-Z does nothing.
void stay_awake();

/// Columns of the terminal on standard error; 80 if it does not tell.
std::size_t terminal_columns();

}  // namespace palpate::app
