// Part 3: the work of the force on a hand that goes round closed loops.
#pragma once

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

struct EnergyPlan {
    int loops = 200;  ///< in each body with each set of layers
    /// Of a loop. What is gained is the error of the sum of force times way, which falls with it.
    int ticks = 16000;
    std::uint64_t seed = 1;
};

/// Adds rows of the part "energy".
void add_energies(Table& table, const EnergyPlan& plan,
                  const std::function<void(double)>& progress);

std::vector<Claim> energy_claims(const Table& table);
std::string energy_sentences(const Table& table);

}  // namespace palpate::evaluation
