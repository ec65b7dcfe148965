// The doctor's results as text and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "doctor/faults.hpp"

namespace palpate::doctor {

/// For the terminal: a line for each part, then the faults with their remedies.
std::string summary_of(const Facts& facts, const std::vector<Fault>& faults);

/// To send along with a bug: everything that was found, and the real-time certificate of the
/// latency measurement. Markdown. `date`: ISO 8601.
std::string report_of(const Facts& facts, const std::vector<Fault>& faults,
                      const std::string& date);

nlohmann::ordered_json json_of(const Facts& facts, const std::vector<Fault>& faults);

}  // namespace palpate::doctor
