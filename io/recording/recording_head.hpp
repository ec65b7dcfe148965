// The head of a recording as JSON. Private to io/.
#pragma once

#include <span>
#include <vector>

#include "io/recording/settings_json.hpp"
#include "palpate/io/recording.hpp"

namespace palpate::io {

/// The newest. Format 1 had neither tick numbers nor checksums.
inline constexpr int recording_format = 7;
/// Recordings of one hand are written so: earlier versions can read them.
inline constexpr int format_of_one_hand = 6;
inline constexpr std::string_view recording_mark = " palpate recording ";  // after the #
inline constexpr std::string_view command_mark = " command ";
inline constexpr std::string_view end_mark = " end ";

/// The CRC-32 of events, continued by the text of one more line: a command's, or a tick's up to the
/// comma before its last cell, which is the checksum. That of no events is 0.
std::uint32_t checksum_with(std::string_view line, std::uint32_t before);

/// Of one hand, or of several that feel the same volume: "hands" has what is each one's own.
Json to_json(std::span<const RecordingHead> heads);
/// The head of each hand. Throws std::invalid_argument, saying what is missing or wrong.
std::vector<RecordingHead> heads_from_json(const Json& json, int format);

}  // namespace palpate::io
