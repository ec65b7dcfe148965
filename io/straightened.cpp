// The nearest grid whose axes are at right angles.
#include "io/straightened.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::io {
namespace {

/// The greatest cosine between two axes, or deviation of the square of a length from 1.
double distance_from_orthonormal(const Mat3& direction) {
    return (direction.transpose() * direction - Mat3::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace

double distance_between(const Geometry& a, const Geometry& b) {
    double most = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3 ends(corner & 1, corner >> 1 & 1, corner >> 2);
        const Vec3 index = ends.cwiseProduct(a.size.cast<double>() - Vec3::Ones());
        most =
            std::max(most, (physical_from_index(a, index) - physical_from_index(b, index)).norm());
    }
    return most;
}

std::optional<Straightened> straightened(const Geometry& geometry) {
    constexpr double most = 0.01;  // of a cosine, and of a length
    if (!geometry.direction.allFinite()) return std::nullopt;
    if (distance_from_orthonormal(geometry.direction) < 1e-4) return Straightened{geometry};
    Straightened nearest{geometry, 0, true};
    for (int axis = 0; axis < 3; ++axis) {
        const double length = geometry.direction.col(axis).norm();
        if (std::abs(length - 1) > most) return std::nullopt;
        nearest.grid.direction.col(axis) /= length;
    }
    const Geometry sheared = nearest.grid;
    const double error = distance_from_orthonormal(sheared.direction);
    if (error > most) return std::nullopt;
    nearest.grid = orthonormal(sheared);
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        if (geometry.size[axis] > 1) least = std::min(least, geometry.spacing[axis]);
    }
    nearest.moved = distance_between(sheared, nearest.grid);
    if (nearest.moved > 0.5 * least) return std::nullopt;
    nearest.is_sheared = error >= 1e-4;
    return nearest;
}

}  // namespace palpate::io
