// The figures of scaling.
#pragma once

#include <vector>

#include "evaluation/figure.hpp"
#include "evaluation/table.hpp"

namespace palpate::evaluation {

/// What an update's time grows with, a panel for each part; and the explicit approach beside the
/// dynamic one.
std::vector<Figure> scaling_figures(const Table& table);

}  // namespace palpate::evaluation
