// layers: several surfaces in one stroke, each with its own character. Straight insertions and a
// needle against closed forms, the energy of closed loops, strokes into heads, and the cost.
#include "evaluation/experiment.hpp"
#include "evaluation/layers/cost.hpp"
#include "evaluation/layers/energy.hpp"
#include "evaluation/layers/figure.hpp"
#include "evaluation/layers/heads.hpp"
#include "evaluation/layers/insertion.hpp"
#include "evaluation/layers/needle.hpp"

namespace palpate::evaluation {
namespace {

void append(std::vector<Claim>& all, const std::vector<Claim>& claims) {
    all.insert(all.end(), claims.begin(), claims.end());
}

/// Parts 1 and 2, on both bodies and both fields.
void add_closed_forms(Table& table, const std::vector<LayeredPhantom>& phantoms,
                      const Options& options) {
    double done = 0;
    for (const LayeredPhantom& phantom : phantoms) {
        for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
            options.progress(0.3 * done++ / 4);
            add_insertions(table, phantom, interpolation, options.quick, options.seed);
            add_needles(table, phantom, interpolation, options.seed);
        }
    }
}

}  // namespace

Result layers(const Options& options) {
    const std::vector<LayeredHead> heads = layered_heads(options);
    const std::vector<LayeredPhantom> phantoms{ramp_phantom(), ball_phantom()};
    Result result;
    add_closed_forms(result.table, phantoms, options);
    EnergyPlan plan{.seed = options.seed};
    if (options.quick) {
        plan.loops = 3;
        plan.ticks = 4000;
    }
    add_energies(result.table, plan, [&](double part) { options.progress(0.3 + 0.6 * part); });
    for (const LayeredHead& head : heads) {
        options.progress(0.9);
        add_head(result.table, head, options.quick);
    }
    options.progress(0.95);
    add_costs(result.table, phantoms.back(), options.quick ? 3 : 25, options.quick);
    append(result.claims, insertion_claims(result.table));
    append(result.claims, needle_claims(result.table));
    append(result.claims, energy_claims(result.table));
    append(result.claims, head_claims(result.table));
    result.summary = insertion_summary(result.table);
    result.figures = {insertion_figure(result.table), puncture_figure(result.table),
                      needle_figure(result.table), head_figure(result.table, heads)};
    result.paragraph =
        insertion_sentences(result.table) + needle_sentences(result.table) +
        energy_sentences(result.table) + head_sentences(result.table) +
        cost_sentences(result.table) +
        " All of this shows that the model is rendered as it is written down, on "
        "straight ways in and with frictionless loops. The stiffnesses, drags and "
        "puncture forces are chosen, not measured on tissue, and a real surface does "
        "not hold like a spring until it breaks.";
    return result;
}

}  // namespace palpate::evaluation
