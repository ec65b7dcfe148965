// Summaries of offline rendering for people and for scripts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "palpate/run/offline.hpp"

namespace palpate::app {

/// Lines of text for people, and JSON.
std::string summary_text(const run::OfflineSummary& summary);
nlohmann::ordered_json summary_json(const run::OfflineSummary& summary);

}  // namespace palpate::app
