// tools: rigid tools in six degrees of freedom. At rest against closed forms, a peg in its hole,
// wild hands, and a penalty method beside them.
#include <stdexcept>

#include "evaluation/experiment.hpp"
#include "evaluation/tools/equilibrium.hpp"
#include "evaluation/tools/hostile.hpp"

namespace palpate::evaluation {

Result tools(const Options& options) {
    if (!options.subjects.empty()) {
        throw std::invalid_argument("tools has scenes of its own: leave out --volume");
    }
    HostilePlan plan{.seed = options.seed};
    if (options.quick) {
        plan.ticks = 300;
        plan.penalty_ticks = 300;
    }
    Result result;
    add_equilibria(result.table);
    add_fit(result.table, options.quick);
    options.progress(0.05);
    add_hostile(result.table, plan, [&](double part) { options.progress(0.05 + 0.95 * part); });
    result.claims = equilibrium_claims(result.table);
    const std::vector<Claim> hostile = hostile_claims(result.table);
    result.claims.insert(result.claims.end(), hostile.begin(), hostile.end());
    result.figures = {hostile_figure(result.table), lever_figure(result.table)};
    result.paragraph =
        equilibrium_sentences(result.table) + hostile_sentences(result.table) +
        " What the penalty method lets through depends on its stiffness and on the shell's "
        "thickness; nothing here says how real tools and tissues feel.";
    return result;
}

}  // namespace palpate::evaluation
