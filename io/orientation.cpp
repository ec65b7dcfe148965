// Converts between directions and the letters of the body's sides.
#include "palpate/io/orientation.hpp"

#include <stdexcept>

namespace palpate::io {
namespace {

// Along x, y and z of LPS, and against them.
constexpr std::string_view positive = "LPS", negative = "RAI";

}  // namespace

std::string orientation_of(const Geometry& geometry) {
    std::string letters;
    Mat3 left = geometry.direction.cwiseAbs();  // of sides that no axis before runs to
    for (int axis = 0; axis < 3; ++axis) {
        Eigen::Index most = 0;
        left.col(axis).maxCoeff(&most);
        left.row(most).setConstant(-1);
        const bool forwards = geometry.direction(most, axis) > 0;
        letters += (forwards ? positive : negative)[static_cast<std::size_t>(most)];
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
