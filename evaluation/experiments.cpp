// The list of experiments.
#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

std::span<const Experiment> experiments() {
    static constexpr Experiment all[] = {
        {"drift", "Does the proxy stay on the isosurface?", &drift},
        {"fall-through", "Does a fast hand fall through a thin wall?", &fall_through},
        {"performance", "What does an update cost?", &performance},
        {"scaling", "What does the cost grow with, and what does the explicit approach cost?",
         &scaling},
        {"fidelity", "How near is the force to the true surface's?", &fidelity},
        {"stability", "How stiff may a surface be before it buzzes?", &stability},
        {"walk-through", "How does a proxy move, step by step?", &walk_through},
        {"penetration", "What is felt from the skin into the brain?", &penetration},
        {"layers", "What is felt of several surfaces in one stroke?", &layers},
        {"tools", "Does any point of a tool go through?", &tools},
        {"streaming", "How long does a hand wait for a volume that is read as it is felt?",
         &streaming},
    };
    return all;
}

}  // namespace palpate::evaluation
