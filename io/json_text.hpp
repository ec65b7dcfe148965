// JSON that others wrote: checked before it is parsed. All documents from files, the network and
// programs go through this. Private to io/, stream/, run/ and programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace palpate::io {

/// What a document may be nested at most. Walks through JSON are recursive: deeper ones overflow
/// the stack.
inline constexpr int deepest_json = 64;
/// What its values may take in memory, roughly: 128 bytes for a list or object, also for "[]", 64
/// for a string, and 32 for each value but the first.
inline constexpr std::size_t most_json_bytes = std::size_t{64} << 20;

/// Throws nlohmann::json::exception for what is no JSON, nested deeper, or larger, and for an
/// object that has a member twice. `with_comments`: as in C++ they are left out.
nlohmann::json parsed_json(std::string_view text, bool with_comments = false);

/// The same with `room` instead of most_json_bytes, less what the values take afterwards: for
/// several documents that are held together.
nlohmann::json parsed_json_within(std::size_t& room, std::string_view text,
                                  bool with_comments = false);

/// The same; discarded (nlohmann::json::is_discarded) instead of an exception.
nlohmann::json parsed_or_discarded(std::string_view text);

}  // namespace palpate::io
