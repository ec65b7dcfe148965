// How a live session does, in words: a line while it runs, a summary at the end.
#pragma once

#include <optional>
#include <string>

#include "palpate/servo.hpp"

namespace palpate::app {

/// One line, cut to `columns`, the most needed first: time, device or contact, force, isovalue,
/// missed deadlines, compute time, lateness.
std::string status_line(const Snapshot& now, const ServoReport& report, std::size_t columns);

/// A duration as people read it: 850 ns, 12.4 us, 3.1 ms.
std::string duration_text(std::int64_t ns);

/// Several lines for people; JSON, one object, for scripts. `seconds`: how long the session ran.
std::string report_text(const ServoReport& report, double seconds);
std::string report_json(const ServoReport& report, double seconds, const std::string& device);

/// What a force is held back by, in words; empty for a force that is simply rendered.
std::string force_words(const Tick& tick);

}  // namespace palpate::app
