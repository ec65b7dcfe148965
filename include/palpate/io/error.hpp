// The two ways input and output fail. Each message is one short line that stands alone: the file,
// the fault and the remedy. Header only, so that every reader and writer can throw them.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace palpate::io {

/// A message as one line of at most 900 bytes, whatever text of a file it quotes. Control
/// characters become blanks. A longer text keeps so many bytes of its beginning and its end, and no
/// part of a character of UTF-8.
inline std::string one_line(std::string text, std::size_t beginning = 640, std::size_t end = 250) {
    if (text.size() > beginning + end) {
        const auto continues = [&](std::size_t at) {
            return (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80;
        };
        std::size_t rest = text.size() - end;
        for (int i = 0; i < 3 && continues(beginning); ++i) --beginning;  // it has at most 4 bytes
        for (int i = 0; i < 3 && continues(rest); ++i) ++rest;
        text.replace(beginning, rest - beginning, " ... ");
    }
    for (char& c : text) {
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
    }
    return text;
}

/// The text without the parts of its addresses that give access: user, password, and the query,
/// which may be a signature. "https://me:pw@host/a?sig=b" becomes "https://host/a?...".
inline std::string without_secrets(std::string text) {
    constexpr const char* ends = " \t\r\n'\"<>";
    constexpr std::string_view signs = ":,;)";  // of the sentence, if they come last
    for (std::size_t at = 0; (at = text.find("://", at)) != text.npos;) {
        at += 3;
        const std::size_t host_end = std::min(text.find_first_of("/?# \t\r\n", at), text.size());
        const std::size_t sign = text.substr(at, host_end - at).rfind('@');
        if (sign != text.npos) text.erase(at, sign + 1);
        const std::size_t query = text.find('?', at);
        if (query >= std::min(text.find_first_of(ends, at), text.size())) continue;
        std::size_t end = std::min(text.find_first_of(ends, query), text.size());
        while (end > query + 1 && signs.find(text[end - 1]) != signs.npos) --end;
        text.replace(query + 1, end - query - 1, "...");
    }
    return text;
}

/// Input could not be read or is not valid (exit status 3).
class InputError : public std::runtime_error {
  public:
    explicit InputError(const std::string& message)
        : std::runtime_error(one_line(without_secrets(message))) {}
};

/// Output could not be written (exit status 5). Nothing half-written is left behind.
class OutputError : public std::runtime_error {
  public:
    explicit OutputError(const std::string& message)
        : std::runtime_error(one_line(without_secrets(message))) {}
};

/// Thrown by work that was asked to stop.
struct Cancelled {};

/// The system's description of an errno.
inline std::string reason(int error) {
    return std::generic_category().message(error);
}

}  // namespace palpate::io
