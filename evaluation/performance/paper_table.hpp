// The paper's Table 1: the haptic loop on a Core 2 Duo at 3 GHz with a PHANToM Omni. Facts, as
// printed there; times in microseconds instead of milliseconds and speeds in mm/s instead of cm/s.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace palpate::evaluation {

/// Low and high resolution: how many voxels a millimetre of hand is.
struct Resolution {
    const char* name;
    double voxels_per_mm;
};
inline constexpr std::array<Resolution, 2> resolutions{{{"LR", 0.5}, {"HR", 3}}};

struct PaperCell {
    double mean_us;            ///< of the haptic loop
    double speed_mm_s;         ///< mean, of the hand
    double constrained_share;  ///< of the updates
};

struct PaperRow {
    const char* volume;
    const char* size;
    std::array<PaperCell, 2> at;  ///< in the order of `resolutions`
};

inline constexpr std::array<PaperRow, 6> paper_table{{
    {"cylinder", "100x100x30", {{{52, 95.4, 0.7209}, {72, 30.4, 0.9316}}}},
    {"daisy-pollen", "192x180x168", {{{46, 39.8, 0.6159}, {94, 43.1, 0.5513}}}},
    {"visible-male", "128x256x256", {{{66, 103.2, 0.7941}, {103, 54.0, 0.5680}}}},
    {"lobster", "301x324x56", {{{45, 48.9, 0.6236}, {83, 31.4, 0.5014}}}},
    {"neuron", "1024x1024x39", {{{46, 30.3, 0.7572}, {61, 24.8, 0.4509}}}},
    {"orange", "256x256x64", {{{55, 47.0, 0.8935}, {71, 30.2, 0.6060}}}},
}};

/// Null where the paper has no such volume.
constexpr const PaperRow* paper_row(std::string_view volume) {
    const auto* const row = std::find_if(paper_table.begin(), paper_table.end(),
                                         [&](const PaperRow& r) { return volume == r.volume; });
    return row == paper_table.end() ? nullptr : row;
}

}  // namespace palpate::evaluation
