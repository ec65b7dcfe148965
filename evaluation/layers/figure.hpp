// The figures of layers, from its table.
#pragma once

#include <vector>

#include "evaluation/experiment.hpp"
#include "evaluation/layers/heads.hpp"

namespace palpate::evaluation {

/// Force over depth of straight insertions, beside the closed form.
Figure insertion_figure(const Table& table);
/// The greatest force sampled before a surface gives way, over the hand's speed.
Figure puncture_figure(const Table& table);
/// Force over depth of a needle in and out.
Figure needle_figure(const Table& table);
/// Density and force over depth, a column a head.
Figure head_figure(const Table& table, const std::vector<LayeredHead>& heads);

}  // namespace palpate::evaluation
