// Part 1: a hand goes straight through the layers of the phantoms, at several speeds.
#pragma once

#include "evaluation/experiment.hpp"
#include "evaluation/layers/phantom.hpp"

namespace palpate::evaluation {

/// [mm/s]
inline constexpr double insertion_speeds[] = {5, 50, 250, 1000};

/// Adds rows of the parts "insertion" (a phantom, a field and a speed each), "puncture" (each
/// surface that gave way) and, of the linear field, "insertion curve" (force over depth of the
/// first line at the least and the greatest speed).
void add_insertions(Table& table, const LayeredPhantom& phantom, Interpolation interpolation,
                    bool quick, std::uint64_t seed);

std::vector<Claim> insertion_claims(const Table& table);
/// The main numbers, a phantom, a field and a speed a row.
Table insertion_summary(const Table& table);
std::string insertion_sentences(const Table& table);

}  // namespace palpate::evaluation
