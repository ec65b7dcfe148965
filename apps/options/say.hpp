// Notes and warnings for people, on standard error.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

#include "palpate/io/error.hpp"

namespace palpate::app {

/// Formats to standard error, without what gives access to addresses in the text
/// (io::without_secrets()). Where that is full, closed or read by nobody, the words are lost and
/// the work goes on: fmt::print() would throw.
template <class... T>
void say(fmt::format_string<T...> text, T&&... values) {
    const std::string words = io::without_secrets(fmt::format(text, std::forward<T>(values)...));
    std::fwrite(words.data(), 1, words.size(), stderr);
}

}  // namespace palpate::app
