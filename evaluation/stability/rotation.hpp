// The part of the experiment that turns: how stiff a rotational spring a simulated device with
// torque holds before it shakes.
#pragma once

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

/// Adds its rows (parts `rotation, ideal` and `rotation`), claims, figure and sentences.
void add_rotation(const Options& options, const Subject& subject, Result& result);

}  // namespace palpate::evaluation
