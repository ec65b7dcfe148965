// Tools at rest, where force and torque have a closed form; and a peg in its hole.
#pragma once

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

/// Adds rows of the parts `equilibrium` and `fit`.
void add_equilibria(Table& table);
void add_fit(Table& table, bool quick);
std::vector<Claim> equilibrium_claims(const Table& table);
std::string equilibrium_sentences(const Table& table);
Figure lever_figure(const Table& table);

}  // namespace palpate::evaluation
