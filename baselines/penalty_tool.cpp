// The penalty method for tools.
#include "palpate/baselines/penalty_tool.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "palpate/field.hpp"

namespace palpate::baselines {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

}  // namespace

PenaltyUpdate update_penalty(PenaltyTool& state, const Field& field, const Pose& hand,
                             const PenaltySettings& settings) noexcept {
    const Tool& tool = *state.tool;
    const double gyration = tool.gyration();
    const double most = settings.deepest * field.geometry().spacing.minCoeff();
    if (!state.placed) state.pose = hand;
    state.placed = true;
    PenaltyUpdate update;
    for (int step = 0; step < settings.steps; ++step) {
        update.inside = 0;
        update.deepest = 0;
        Mat6 stiffness = Mat6::Identity();
        Six pull = Six::Zero();
        pull.head<3>() = hand.position - state.pose.position;
        if (tool.turns()) {
            pull.tail<3>() = gyration * rotation_between(state.pose.orientation, hand.orientation);
        }
        for (const Vec3& point : tool.points()) {
            const Vec3 at = physical_from_tool(state.pose, point);
            const double excess = field.sign() * (value_at(field, at) - state.isovalue);
            if (!(excess > 0)) continue;
            ++update.inside;
            const Vec3 gradient = gradient_at(field, at);
            const double slope = gradient.norm();
            if (!(slope > 0)) continue;
            const double depth = excess / slope;
            update.deepest = std::max(update.deepest, depth);
            const Vec3 out = -field.sign() * gradient / slope;
            Six row = Six::Zero();
            row.head<3>() = out;
            if (tool.turns()) row.tail<3>() = (at - state.pose.position).cross(out) / gyration;
            stiffness += settings.point_stiffness * row * row.transpose();
            pull += settings.point_stiffness * std::min(depth, most) * row;
        }
        const Six motion = stiffness.ldlt().solve(pull);
        state.pose.position += motion.head<3>();
        if (tool.turns()) {
            state.pose.orientation =
                turned(state.pose.orientation, Vec3(motion.tail<3>() / gyration));
        } else {
            state.pose.orientation = hand.orientation;
        }
    }
    update.proxy = state.pose;
    return update;
}

}  // namespace palpate::baselines
