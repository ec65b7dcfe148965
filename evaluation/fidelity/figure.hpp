// The figures of fidelity.
#pragma once

#include <vector>

#include "evaluation/figure.hpp"
#include "evaluation/table.hpp"

namespace palpate::evaluation {

/// The ball beside the incumbent; its facets and the turn of the force at this grid, tick by tick;
/// 8-bit terraces; what the smooth field costs; torus and ripples.
std::vector<Figure> fidelity_figures(const Table& table, int facet_grid);
/// Volumes of the user: what can be said without knowing their true surface.
Figure fidelity_figure_of_users(const Table& table);

}  // namespace palpate::evaluation
