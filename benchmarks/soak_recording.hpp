// Reads the recording of palpate_soak: whether it replays bit for bit, and the cost of its ticks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "palpate/exchange.hpp"
#include "palpate/field.hpp"

namespace palpate::benchmarks {

struct ReadBack {
    static constexpr int repeats = 5;

    std::int64_t ticks = 0, commands = 0, in_contact = 0, with_force = 0;
    double largest_force = 0;  ///< [N]
    LatencySummary update;     ///< the proxy updates as they ran, by the wall clock [ns]
    /// The same ticks rendered `repeats` times, the shortest of each [ns]: what they cost with warm
    /// caches and without the machine's interrupts. The session alone: no device, no snapshot.
    LatencySummary again;
    std::string problem;  ///< what is wrong with the recording, in words; empty if nothing is
};

/// Renders every tick of a recording of this field again and compares. Throws io::InputError for
/// what is no recording.
ReadBack read_back(const std::filesystem::path& path, const Field& field);

}  // namespace palpate::benchmarks
