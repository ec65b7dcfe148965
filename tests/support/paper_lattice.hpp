// Slow reference of the lattice: the paper's own form (Corenthy et al. 2012, Eq. 1-3). Every cell
// is 24 explicit tetrahedra of four vertices; points are found by trying them all, values are
// barycentric. Shares nothing with src/ but Volume::sample.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "palpate/field.hpp"

namespace palpate::support {

using Vec4 = Eigen::Vector4d;

/// A tetrahedron of the unit cell: vertices 0 = cell centre, 1 = face centre, 2, 3 = edge ends.
struct PaperTetrahedron {
    std::array<Vec3, 4> vertex;
    std::array<Eigen::Matrix<double, 8, 1>, 4> mean;  ///< weights of the 8 samples at each vertex
    Mat3 inverse;                                     ///< of [v1 - v0, v2 - v0, v3 - v0]

    /// Eq. 1: p in cell coordinates -> barycentric coordinates.
    Vec4 barycentric(const Vec3& p) const {
        const Vec3 b = inverse * (p - vertex[0]);
        return {1 - b.sum(), b[0], b[1], b[2]};
    }
};

inline const std::array<PaperTetrahedron, 24>& paper_tetrahedra() {
    static const auto all = [] {
        std::array<PaperTetrahedron, 24> made;
        int count = 0;
        for (int face = 0; face < 6; ++face) {
            const int d = face / 2;
            for (int edge = 0; edge < 4; ++edge) {
                // Corners of the face and of the edge, straight from their positions.
                const int s = (d + 1 + edge / 2) % 3;
                PaperTetrahedron& t = made[count++];
                for (auto& m : t.mean) m.setZero();
                t.vertex[0] = Vec3::Constant(0.5);
                t.vertex[1] = Vec3::Constant(0.5);
                t.vertex[1][d] = face % 2;
                int end = 2;
                for (int corner = 0; corner < 8; ++corner) {
                    const Vec3 at(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
                    t.mean[0][corner] = 1.0 / 8;
                    if (at[d] != face % 2) continue;
                    t.mean[1][corner] = 1.0 / 4;
                    if (at[s] != edge % 2) continue;
                    t.vertex[end] = at;
                    t.mean[end][corner] = 1;
                    ++end;
                }
                Mat3 edges;
                for (int i = 0; i < 3; ++i) edges.col(i) = t.vertex[i + 1] - t.vertex[0];
                t.inverse = edges.inverse();
            }
        }
        return made;
    }();
    return all;
}

/// A sample of the field continued with its background.
inline double paper_sample(const Field& field, const Index3& at) {
    const bool inside =
        (at.array() >= 0).all() && (at.array() < field.geometry().size.array()).all();
    return inside ? field.samples().sample(at, field.moment()) : field.background();
}

inline Eigen::Matrix<double, 8, 1> paper_samples(const Field& field, const Index3& cell) {
    Eigen::Matrix<double, 8, 1> samples;
    for (int c = 0; c < 8; ++c) {
        samples[c] = paper_sample(field, cell + Index3(c & 1, c >> 1 & 1, c >> 2 & 1));
    }
    return samples;
}

/// The four values of a tetrahedron.
inline Vec4 paper_values(const PaperTetrahedron& t, const Eigen::Matrix<double, 8, 1>& samples) {
    return {t.mean[0].dot(samples), t.mean[1].dot(samples), t.mean[2].dot(samples),
            t.mean[3].dot(samples)};
}

/// A point found by brute force: the tetrahedron of its cell that contains it best.
struct PaperPlace {
    Index3 cell;
    int tetrahedron;
    Vec4 barycentric;
};
inline PaperPlace paper_locate(const Vec3& index) {
    PaperPlace best{index.array().floor().matrix().cast<int>(), -1, Vec4::Constant(-1)};
    const Vec3 p = index - best.cell.cast<double>();
    for (int i = 0; i < 24; ++i) {
        const Vec4 b = paper_tetrahedra()[i].barycentric(p);
        if (b.minCoeff() <= best.barycentric.minCoeff()) continue;
        best.tetrahedron = i;
        best.barycentric = b;
    }
    return best;
}

/// Density at a point in index space.
inline double paper_value(const Field& field, const Vec3& index) {
    const PaperPlace at = paper_locate(index);
    const auto& t = paper_tetrahedra()[at.tetrahedron];
    return paper_values(t, paper_samples(field, at.cell)).dot(at.barycentric);
}

/// Gradient in index space [data units / voxel].
inline Vec3 paper_gradient(const Field& field, const PaperPlace& at) {
    const auto& t = paper_tetrahedra()[at.tetrahedron];
    const Vec4 values = paper_values(t, paper_samples(field, at.cell));
    const Vec3 along = values.tail<3>() - Vec3::Constant(values[0]);
    return t.inverse.transpose() * along;
}

/// Every tetrahedron of the 27 cells around that contains the point within `tolerance`, as the
/// centroid of its vertices (index space): what names a tetrahedron without any convention.
inline std::vector<Vec3> paper_incident(const Vec3& index, double tolerance = 1e-12) {
    std::vector<Vec3> centroids;
    const Index3 middle = index.array().floor().matrix().cast<int>();
    for (int n = 0; n < 27; ++n) {
        const Vec3 cell = (middle + Index3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1)).cast<double>();
        for (const auto& t : paper_tetrahedra()) {
            if (t.barycentric(index - cell).minCoeff() < -tolerance) continue;
            const Vec3 sum = t.vertex[0] + t.vertex[1] + t.vertex[2] + t.vertex[3];
            centroids.push_back(cell + sum / 4);
        }
    }
    return centroids;
}

/// The greatest value of sign * f on a segment (index space), exactly: f is linear between the
/// walls (x=k, y=k, z=k, x+-y=k, x+-z=k, y+-z=k), so it is greatest at an end or on a wall.
template <class Value>
double greatest_on_segment(const Vec3& a, const Vec3& b, double sign, Value&& value) {
    static const std::array<Vec3, 9> forms{Vec3(1, 0, 0),  Vec3(0, 1, 0),  Vec3(0, 0, 1),
                                           Vec3(1, 1, 0),  Vec3(1, -1, 0), Vec3(1, 0, 1),
                                           Vec3(1, 0, -1), Vec3(0, 1, 1),  Vec3(0, 1, -1)};
    double greatest = std::max(sign * value(a), sign * value(b));
    for (const Vec3& form : forms) {
        const double from = form.dot(a);
        const double to = form.dot(b);
        const double low = std::min(from, to);
        const double high = std::max(from, to);
        for (double k = std::ceil(low); k <= high; ++k) {
            if (from == to) break;
            // Rounding puts walls along which the segment runs beyond its ends.
            const Vec3 at = a + std::clamp((k - from) / (to - from), 0.0, 1.0) * (b - a);
            greatest = std::max(greatest, sign * value(at));
        }
    }
    return greatest;
}

}  // namespace palpate::support
