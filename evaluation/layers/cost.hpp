// Part 5: what a tick costs with five surfaces, with one and without layers.
#pragma once

#include "evaluation/experiment.hpp"
#include "evaluation/layers/phantom.hpp"

namespace palpate::evaluation {

/// Adds rows of the part "cost", of the phantom of balls. `passes`: of each the median counts.
void add_costs(Table& table, LayeredPhantom phantom, int passes, bool quick);
std::string cost_sentences(const Table& table);

}  // namespace palpate::evaluation
