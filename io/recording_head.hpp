// The head of a recording as JSON. Private to io/.
#pragma once

#include "io/settings_json.hpp"
#include "palpate/io/recording.hpp"

namespace palpate::io {

inline constexpr int recording_format = 1;
inline constexpr std::string_view recording_mark = " palpate recording ";  // after the #
inline constexpr std::string_view command_mark = " command ";
inline constexpr std::string_view end_mark = " end ";

Json to_json(const RecordingHead& head);
/// Throws std::invalid_argument, saying what is missing or wrong.
RecordingHead head_from_json(const Json& json);

}  // namespace palpate::io
