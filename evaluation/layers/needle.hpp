// Part 2: a needle goes in, rests and is withdrawn.
#pragma once

#include "evaluation/experiment.hpp"
#include "evaluation/layers/phantom.hpp"

namespace palpate::evaluation {

inline constexpr double needle_speed = 10;  ///< [mm/s]
inline constexpr double needle_fast_speed = 100;

/// Adds a row of the part "needle" and, for the slow one in flat layers on the linear field,
/// those of "needle curve".
void add_needles(Table& table, const LayeredPhantom& phantom, Interpolation interpolation,
                 std::uint64_t seed);

std::vector<Claim> needle_claims(const Table& table);
std::string needle_sentences(const Table& table);

}  // namespace palpate::evaluation
