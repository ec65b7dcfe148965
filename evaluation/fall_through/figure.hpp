// The figures of fall-through.
#pragma once

#include <vector>

#include "evaluation/figure.hpp"
#include "evaluation/table.hpp"

namespace palpate::evaluation {

/// Maps of the share that ends inside and of the share that feels nothing, a panel a method: walls
/// against the hand's step in a tick.
std::vector<Figure> fall_through_figures(const Table& table);

}  // namespace palpate::evaluation
