// Figures, claims and paragraph of scaling, from its table.
#pragma once

#include <string>
#include <vector>

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

/// What stays the same while one thing grows.
struct UsualTouch {
    double speed_mm_s = 50;
    double voxels_per_mm = 3;  ///< of hand
    double depth_mm = 0.5;     ///< of hand
    double rate_hz = 1000;
};
inline constexpr UsualTouch usual;

/// What an update's time grows with, a panel for each part; and the explicit approach beside the
/// dynamic one.
std::vector<Figure> scaling_figures(const Table& table);
/// `own_volumes`: the experiment's, about which more is known than about a user's.
std::vector<Claim> scaling_claims(const Table& table, bool own_volumes);
/// A time with its unit, to three digits: 120 ns, 4.5 ms.
std::string time_text(double seconds);
std::string scaling_paragraph(const Table& table, bool own_volumes);

}  // namespace palpate::evaluation
