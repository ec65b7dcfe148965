// The figure of performance.
#pragma once

#include "evaluation/figure.hpp"
#include "evaluation/table.hpp"

namespace palpate::evaluation {

/// One panel a method, from the experiment's table.
Figure performance_figure(const Table& table);

}  // namespace palpate::evaluation
