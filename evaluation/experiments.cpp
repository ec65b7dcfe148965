// The list of experiments.
#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

std::span<const Experiment> experiments() {
    static constexpr Experiment all[] = {
        {"scaling", &scaling},
        {"streaming", &streaming},
    };
    return all;
}

}  // namespace palpate::evaluation
