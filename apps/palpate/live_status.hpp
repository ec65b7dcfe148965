// The state of a live session as text: a line while it runs, a report at the end.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/options/words.hpp"
#include "palpate/servo.hpp"
#include "palpate/stream/loader.hpp"

namespace palpate::app {

/// One line, cut to `columns`, the most needed first: time, device or contact, force, isovalue,
/// missed deadlines, compute time, lateness.
std::string status_line(const Snapshot& now, const Layers* layers, const ServoReport& report,
                        std::size_t columns);

/// Several lines for people; JSON, one object, for scripts. `seconds`: how long the session ran.
/// What was read of a store, and what is in memory.
std::string streaming_text(const stream::BrickLoaderStatus& status);
std::string report_text(const ServoReport& report, double seconds);
nlohmann::ordered_json report_json(const ServoReport& report, double seconds,
                                   const DeviceInfo& device);

}  // namespace palpate::app
