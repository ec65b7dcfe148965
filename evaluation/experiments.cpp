// The list of experiments.
#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

std::span<const Experiment> experiments() {
    static constexpr Experiment all[] = {
        {"performance", &performance}, {"scaling", &scaling}, {"stability", &stability},
        {"layers", &layers},           {"tools", &tools},     {"streaming", &streaming},
    };
    return all;
}

}  // namespace palpate::evaluation
