// Floods the free space from outside, from corner to corner along the edges of the lattice.
#include "evaluation/fall_through/outside.hpp"

#include <array>
#include <stdexcept>

#include "palpate/density.hpp"

namespace palpate::evaluation {
namespace {

constexpr int border = 2;  // half voxels of background on each side

int odd_axes(const Index3& corner) {
    return (corner[0] & 1) + (corner[1] & 1) + (corner[2] & 1);
}

/// Which axes of a corner are odd, as bits: what kind of corner it is.
unsigned kind_of(const Index3& corner) {
    return unsigned(corner[0] & 1) | unsigned(corner[1] & 1) << 1 | unsigned(corner[2] & 1) << 2;
}

/// The edges of the lattice from each kind of corner.
std::array<std::vector<Index3>, 8> lattice_edges() {
    std::array<std::vector<Index3>, 8> edges;
    for (unsigned kind = 0; kind < 8; ++kind) {
        const Index3 corner(int(kind & 1), int(kind >> 1 & 1), int(kind >> 2 & 1));
        const int own = odd_axes(corner);
        for (int c = 0; c < 27; ++c) {
            const Index3 edge(c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1);
            const int odd = odd_axes(corner + edge);
            // One odd axis is the middle of an edge: no corner. Two centres of the same kind have
            // no edge between them.
            if (odd != 1 && odd != own) edges[kind].push_back(edge);
        }
        for (int a = 0; own == 0 && a < 3; ++a) {
            edges[kind].emplace_back(2 * Index3::Unit(a));
            edges[kind].emplace_back(-2 * Index3::Unit(a));
        }
    }
    return edges;
}

}  // namespace

Outside::Outside(const Field& field, double isovalue, const std::function<void()>& alive)
    : field_(field), isovalue_(isovalue) {
    extent_ = 2 * field.geometry().size + Index3::Constant(border + 1);
    const auto bits = static_cast<std::size_t>(extent_[0]) * static_cast<std::size_t>(extent_[1]) *
                      static_cast<std::size_t>(extent_[2]);
    bits_.resize(bits / 64 + 1);
    if (field.sign() * (field.background() - isovalue) > 0) {
        throw std::invalid_argument(
            "all around the data is solid at this level, so nothing can come from outside: choose "
            "another level");
    }
    flood(alive);
}

std::size_t Outside::bit_of(const Index3& corner) const {
    const auto [x, y, z] = std::array{static_cast<std::size_t>(corner[0] + border),
                                      static_cast<std::size_t>(corner[1] + border),
                                      static_cast<std::size_t>(corner[2] + border)};
    return x +
           static_cast<std::size_t>(extent_[0]) * (y + static_cast<std::size_t>(extent_[1]) * z);
}

bool Outside::within(const Index3& corner) const {
    const Index3 from = corner.array() + border;
    return (from.array() >= 0).all() && (from.array() < extent_.array()).all();
}

bool Outside::reached(const Index3& corner) const {
    const std::size_t bit = bit_of(corner);
    return bits_[bit / 64] >> bit % 64 & 1;
}

void Outside::reach(const Index3& corner) {
    const std::size_t bit = bit_of(corner);
    bits_[bit / 64] |= std::uint64_t{1} << bit % 64;
}

double Outside::excess_at(const Index3& corner) const {
    const Index3 cell(corner[0] >> 1, corner[1] >> 1, corner[2] >> 1);
    const CellSamples f = field_.cell(cell);
    double sum = 0;
    int count = 0;
    for (int c = 0; c < 8; ++c) {
        // Along an even axis the lower end alone, along an odd one both.
        const bool counts = (!(c & 1) || (corner[0] & 1)) && (!(c >> 1 & 1) || (corner[1] & 1)) &&
                            (!(c >> 2 & 1) || (corner[2] & 1));
        if (!counts) continue;
        sum += f[static_cast<std::size_t>(c)];
        ++count;
    }
    return field_.sign() * (field_.with_offset(sum / count) - isovalue_);
}

void Outside::flood(const std::function<void()>& alive) {
    const auto edges = lattice_edges();
    std::vector<Index3> front{Index3::Constant(-border)}, next;
    reach(front.front());
    while (!front.empty()) {
        alive();
        next.clear();
        for (const Index3& corner : front) {
            for (const Index3& edge : edges[kind_of(corner)]) {
                const Index3 other = corner + edge;
                if (!within(other) || reached(other) || excess_at(other) > 0) continue;
                reach(other);
                next.push_back(other);
            }
        }
        std::swap(front, next);
    }
}

bool Outside::holds(const Vec3& physical) const {
    const Geometry& geometry = field_.geometry();
    Vec3 at = physical;
    if (field_.interpolation() == Interpolation::cubic) {
        const double voxel = geometry.spacing.minCoeff();
        for (int i = 0; i < 40; ++i) {
            const Vec3 gradient = field_.sign() * gradient_at(field_, at);
            if (!(gradient.norm() > 0)) break;
            at -= 0.1 * voxel * gradient.normalized();
        }
    }
    return holds(locate(index_from_physical(geometry, at)));
}

bool Outside::holds(const LatticePoint& point) const {
    const Tetrahedron& t = point.tetrahedron;
    const Index3 centre = 2 * t.cell + Index3::Ones();
    const Index3 face = centre + t.sign[0] * Index3::Unit(t.axis[0]);
    const Index3 edge = face + t.sign[1] * Index3::Unit(t.axis[1]);
    const Index3 along = Index3::Unit(t.axis[2]);
    Index3 lowest = centre;
    double least = excess_at(centre);
    for (const Index3& corner : {face, Index3(edge + along), Index3(edge - along)}) {
        const double excess = excess_at(corner);
        if (excess >= least) continue;
        least = excess;
        lowest = corner;
    }
    return !within(lowest) || reached(lowest);
}

}  // namespace palpate::evaluation
