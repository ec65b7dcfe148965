// Part 4: one stroke from the skin through the bone of heads in CT scans.
#pragma once

#include "evaluation/experiment.hpp"
#include "evaluation/layers/phantom.hpp"

namespace palpate::evaluation {

/// A head, or a volume of the user's with two levels.
struct LayeredHead {
    std::string name;
    Field field;
    double skin = 0, bone = 0;  ///< levels [data units]
    HandLine line;              ///< depth 0 is where it meets the skin
    double depth = 0;           ///< [mm] how far past that the hand goes
};

/// The sample volume, the CT head and the Visible Human head where the data folder has them (not in
/// quick mode); or the user's volumes. Throws std::invalid_argument where a line meets no surface.
std::vector<LayeredHead> layered_heads(const Options& options);

/// Names of the two sets of layers, in the order of figures.
inline constexpr const char* head_sets[] = {"skin, bone", "drilling"};

/// Presses in at 20 mm/s until the force is more than the hand stands, once with each set. Adds
/// rows of the parts "head", "head event" (a surface that is met or gives way) and "head curve".
void add_head(Table& table, const LayeredHead& head, bool quick);

std::vector<Claim> head_claims(const Table& table);
std::string head_sentences(const Table& table);

}  // namespace palpate::evaluation
