// Converts between directions and the letters of the body's sides.
#include "palpate/io/orientation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace palpate::io {
namespace {

// Along x, y and z of LPS, and against them.
constexpr std::string_view positive = "LPS", negative = "RAI";

}  // namespace

std::string orientation_of(const Geometry& geometry) {
    // Each axis gets another side: of the six orders, the one that is nearest to the directions.
    std::array<int, 3> order{0, 1, 2}, best = order;
    double most = -1;
    do {
        double sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            sum += std::abs(geometry.direction(order[static_cast<std::size_t>(axis)], axis));
        }
        if (sum > most) best = order;
        most = std::max(most, sum);
    } while (std::ranges::next_permutation(order).found);
    std::string letters;
    for (int axis = 0; axis < 3; ++axis) {
        const int side = best[static_cast<std::size_t>(axis)];
        const bool forwards = geometry.direction(side, axis) > 0;
        letters += (forwards ? positive : negative)[static_cast<std::size_t>(side)];
    }
    return letters;
}

Mat3 direction_from(std::string_view orientation) {
    Mat3 direction = Mat3::Zero();
    for (std::size_t axis = 0; axis < 3 && orientation.size() == 3; ++axis) {
        const char letter = orientation[axis];
        for (std::size_t side = 0; side < 3; ++side) {
            if (letter != positive[side] && letter != negative[side]) continue;
            direction(static_cast<Eigen::Index>(side), static_cast<Eigen::Index>(axis)) =
                letter == positive[side] ? 1 : -1;
        }
    }
    if (direction.cwiseAbs().rowwise().sum() == Vec3::Ones()) return direction;
    throw std::invalid_argument("orientation " + std::string(orientation) +
                                ": three letters are needed, one of L and R, one of P and A, one "
                                "of S and I: the sides that "
                                "the axes run to, as in LPS or RAS");
}

void put_in(const GivenGrid& given, Geometry& geometry) {
    if (given.spacing) {
        geometry.spacing = *given.spacing;
        geometry.measured = true;
    }
    if (given.orientation.empty()) return;
    geometry.direction = direction_from(given.orientation);
    geometry.oriented = true;
}

}  // namespace palpate::io
