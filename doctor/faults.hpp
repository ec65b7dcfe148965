// Judges whether a machine is fit for haptics: its faults, their meaning, and their remedies.
#pragma once

#include <string>
#include <vector>

#include "doctor/facts.hpp"

namespace palpate::doctor {

struct Fault {
    std::string name;  ///< "real-time-priority": the same in all versions
    /// Without it surfaces cannot be felt, or shake or drop out; otherwise it is worth mending.
    bool essential = false;
    std::string meaning;  ///< one line
    std::string remedy;   ///< one line: commands, or what to do
};

/// Pure: the same facts, the same faults. Essential ones first, each kind in the order in which
/// they are worth mending.
std::vector<Fault> faults_of(const Facts& facts);

// The parts of it, by what they look at.
std::vector<Fault> real_time_faults(const Facts& facts);
std::vector<Fault> kernel_faults(const Facts& facts);
std::vector<Fault> latency_faults(const Facts& facts);
std::vector<Fault> program_faults(const Facts& facts);
std::vector<Fault> device_faults(const Facts& facts);

}  // namespace palpate::doctor
