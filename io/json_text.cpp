// JSON that other programs wrote. See the header.
#include "io/json_text.hpp"

#include <algorithm>
#include <string>

namespace palpate::io {
namespace {

using nlohmann::json;

/// End of a comment that begins at `at`. `at` if none does.
std::size_t end_of_comment(std::string_view text, std::size_t at) {
    const std::string_view begin = text.substr(at, 2);
    if (begin == "//") return std::min(text.find('\n', at), text.size());
    if (begin != "/*") return at;
    const std::size_t end = text.find("*/", at + 2);
    return end == text.npos ? text.size() : end + 2;
}

std::size_t end_of_string(std::string_view text, std::size_t at) {
    for (++at; at < text.size() && text[at] != '"'; ++at) at += text[at] == '\\' ? 1 : 0;
    return std::min(at + 1, text.size());
}

/// Why a document is not parsed; empty: it is, and `room` is less. `members` are what its objects
/// have, as often as they are written.
std::string flaw_in(std::string_view text, bool with_comments, std::size_t& room,
                    std::size_t& members) {
    int depth = 0;
    std::size_t bytes = 0;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        const std::size_t after = with_comments ? end_of_comment(text, at) : at;
        if (after != at) {
            at = after;
            continue;
        }
        const bool opens = c == '[' || c == '{';
        members += c == ':';
        depth += opens ? 1 : c == ']' || c == '}' ? -1 : 0;
        bytes += opens ? 128 : c == '"' ? 64 : c == ',' ? 32 : 0;
        if (depth > deepest_json) {
            return "it is nested more than " + std::to_string(deepest_json) + " levels deep";
        }
        if (bytes > room) {
            return "its values take more than " + std::to_string(room >> 20) + " MiB";
        }
        at = c == '"' ? end_of_string(text, at) : at + 1;
    }
    room -= bytes;
    return "";
}

/// Members of all objects in a value.
std::size_t members_of(const json& value) {
    std::size_t members = value.is_object() ? value.size() : 0;
    if (value.is_structured()) {
        for (const json& one : value) members += members_of(one);
    }
    return members;
}

}  // namespace

json parsed_json_within(std::size_t& room, std::string_view text, bool with_comments) {
    std::size_t members = 0;
    const std::string flaw = flaw_in(text, with_comments, room, members);
    if (!flaw.empty()) throw json::other_error::create(501, flaw, nullptr);
    json value = json::parse(text, nullptr, true, with_comments);
    if (members_of(value) != members) {
        throw json::other_error::create(501, "an object in it has a member twice", nullptr);
    }
    return value;
}

json parsed_json(std::string_view text, bool with_comments) {
    std::size_t room = most_json_bytes;
    return parsed_json_within(room, text, with_comments);
}

json parsed_or_discarded(std::string_view text) {
    try {
        return parsed_json(text);
    } catch (const json::exception&) {
        return json(json::value_t::discarded);
    }
}

}  // namespace palpate::io
