// Keys from a console, one at a time; see terminal.hpp. Windows.
#include <windows.h>

#include <conio.h>
#include <io.h>

#include "apps/palpate/terminal.hpp"

namespace palpate::app {

struct Keys::Before {};

Keys::Keys() {
    constexpr int input = 0, errors = 2;
    available_ = ::_isatty(input) != 0 && ::_isatty(errors) != 0;
}

Keys::~Keys() = default;

/// Nobody suspends a program by a key there.
void stay_awake() {}

std::size_t terminal_columns() {
    CONSOLE_SCREEN_BUFFER_INFO info{};
    const bool told = ::GetConsoleScreenBufferInfo(::GetStdHandle(STD_ERROR_HANDLE), &info) != 0;
    return told ? static_cast<std::size_t>(info.srWindow.Right - info.srWindow.Left + 1) : 80;
}

std::optional<char> Keys::next() {
    if (!available_ || !::_kbhit()) return std::nullopt;
    return static_cast<char>(::_getch());
}

}  // namespace palpate::app
