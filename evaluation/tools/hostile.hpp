// Wild hands with tools through scenes that let anything through that is not certified.
#pragma once

#include <functional>

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

struct HostilePlan {
    int ticks = 100'000;
    int penalty_ticks = 10'000;
    std::vector<int> points{1, 10, 100, 1000};
    std::uint64_t seed = 1;
};

/// Adds rows of the part `hostile`: `exact` and `penalty`.
void add_hostile(Table& table, const HostilePlan& plan,
                 const std::function<void(double)>& progress);
std::vector<Claim> hostile_claims(const Table& table);
std::string hostile_sentences(const Table& table);
Figure hostile_figure(const Table& table);

}  // namespace palpate::evaluation
