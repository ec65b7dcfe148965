// Values at the nodes of a cell. Sums run in the same order from both sides of a face.
#include "surface/nodes.hpp"

#include <cmath>

namespace palpate::marching {

bool LinearNodes::enter(const Index3& cell) {
    const CellSamples f = field_.cell(cell);
    int solid_corners = 0;
    for (const double value : f) solid_corners += is_solid(value);
    // Rounded means stay between the least and the greatest sample: no node can differ.
    if (solid_corners == 0 || solid_corners == 8) return false;
    for (int corner = 0; corner < 8; ++corner) value_[corner] = f[corner];
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            const auto at = [&](int q) { return f[corner_of_face(axis, side, q)]; };
            value_[face_node(axis, side)] = ((at(0) + at(1)) + (at(2) + at(3))) * 0.25;
        }
    }
    value_[centre_node] =
        (((f[0] + f[1]) + (f[2] + f[3])) + ((f[4] + f[5]) + (f[6] + f[7]))) * 0.125;
    return true;
}

CubicNodes::CubicNodes(const Field& field, double isovalue, const SampleBox& box)
    : field_(field), isovalue_(isovalue - field.offset()), box_(box) {
    const Index3 count = box.high - box.low + Index3::Constant(2);
    const auto layer = static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]);
    for (auto* sides : {&below_, &here_, &either_}) sides->resize(layer);
}

void CubicNodes::look_at(int z, std::vector<std::uint8_t>& sides) const {
    const std::uint8_t outside =
        field_.sign() * (field_.background() - field_.offset() - isovalue_) > 0 ? 2 : 1;
    std::uint8_t* out = sides.data();
    for (int y = box_.low[1] - 1; y <= box_.high[1]; ++y) {
        for (int x = box_.low[0] - 1; x <= box_.high[0]; ++x) {
            const Index3 cell(x, y, z);
            std::uint8_t found = outside;
            if (!field_.is_background(cell)) {
                found = 0;
                for (const double value : field_.cell(cell)) {
                    found |= field_.sign() * (value - isovalue_) > 0 ? 2 : 1;
                }
            }
            *out++ = found;
        }
    }
}

void CubicNodes::enter_slab(int z) {
    if (slab_ == z - 1) {
        std::swap(below_, here_);
    } else {
        look_at(z - 1, below_);
    }
    look_at(z, here_);
    for (std::size_t i = 0; i < either_.size(); ++i) {
        either_[i] = static_cast<std::uint8_t>(below_[i] | here_[i]);
    }
    slab_ = z;
}

bool CubicNodes::enter(const Index3& cell) {
    if (cell[2] != slab_) enter_slab(cell[2]);
    const std::size_t row = static_cast<std::size_t>(box_.high[0] - box_.low[0]) + 2;
    const std::uint8_t* const first = either_.data() +
                                      static_cast<std::size_t>(cell[1] - box_.low[1]) * row +
                                      static_cast<std::size_t>(cell[0] - box_.low[0]);
    // The field stays between the least and the greatest of the samples around the cell.
    if ((first[0] | first[1] | first[row] | first[row + 1]) != 3) return false;
    samples_ = field_.around(cell);
    for (double& sample : samples_) sample = field_.sign() * (sample - isovalue_);
    known_ = 0;
    take_values();
    return true;
}

namespace {

constexpr std::array<int, 3> stride{1, 3, 9};

/// The sum over the four nearest of a sample's neighbours in a plane, and over the other four.
double edges(const double* c, int s, int e) {
    return (c[-s] + c[s]) + (c[-e] + c[e]);
}
double corners(const double* c, int s, int e) {
    return (c[-s - e] + c[s + e]) + (c[s - e] + c[e - s]);
}

/// The lowest of the eight samples around a corner.
int first_of(int corner) {
    return (corner & 1) + 3 * (corner >> 1 & 1) + 9 * (corner >> 2 & 1);
}

}  // namespace

void CubicNodes::take_values() {
    const double* const f = samples_.data();
    for (int corner = 0; corner < 8; ++corner) {
        const double* const c = f + first_of(corner);
        excess_[corner] =
            0.125 * (((c[0] + c[1]) + (c[3] + c[4])) + ((c[9] + c[10]) + (c[12] + c[13])));
    }
    const double* const centre = f + 13;
    double nearest = 0, next = 0;
    for (int a = 0; a < 3; ++a) {
        const int d = stride[a], s = stride[(a + 1) % 3], e = stride[(a + 2) % 3];
        nearest += centre[-d] + centre[d];
        next += corners(centre, s, e);
        for (int side = 0; side < 2; ++side) {
            const double* const low = side == 0 ? centre - d : centre;
            const double* const high = low + d;
            excess_[face_node(a, side)] =
                (52 * (low[0] + high[0]) + 10 * (edges(low, s, e) + edges(high, s, e)) +
                 (corners(low, s, e) + corners(high, s, e))) *
                (1.0 / 192);
        }
    }
    excess_[centre_node] = (36 * centre[0] + 8 * nearest + next) * (1.0 / 96);
}

Vec3 CubicNodes::corner_gradient(Node corner) const {
    const double* const c = samples_.data() + first_of(corner);
    Vec3 gradient;
    for (int a = 0; a < 3; ++a) {
        const int d = stride[a], s = stride[(a + 1) % 3], e = stride[(a + 2) % 3];
        const auto rise = [&](int at) { return c[at + d] - c[at]; };
        gradient[a] = 0.25 * ((rise(0) + rise(s)) + (rise(e) + rise(s + e)));
    }
    return gradient;
}

Vec3 CubicNodes::centre_gradient() const {
    const double* const c = samples_.data() + 13;
    Vec3 gradient;
    for (int a = 0; a < 3; ++a) {
        const int d = stride[a], s = stride[(a + 1) % 3], e = stride[(a + 2) % 3];
        gradient[a] =
            (36 * (c[d] - c[-d]) + 3 * (edges(c + d, s, e) - edges(c - d, s, e))) * (1.0 / 96);
    }
    return gradient;
}

/// A face's centre sees the nine samples before and the nine behind it.
Vec3 CubicNodes::face_gradient(Node face) const {
    const int axis = (face - 8) / 2, side = face & 1;
    const int d = stride[axis], s = stride[(axis + 1) % 3], e = stride[(axis + 2) % 3];
    const double* const centre = samples_.data() + 13;
    const double* const low = side == 0 ? centre - d : centre;
    const double* const high = low + d;
    const auto rise = [](const double* c, int along, int across) {
        return 7 * (c[along] - c[-along]) + 0.5 * ((c[along - across] - c[-along - across]) +
                                                   (c[along + across] - c[across - along]));
    };
    Vec3 gradient;
    gradient[axis] = (12 * (high[0] - low[0]) + 4 * (edges(high, s, e) - edges(low, s, e)) +
                      (corners(high, s, e) - corners(low, s, e))) *
                     (1.0 / 32);
    gradient[(axis + 1) % 3] = (rise(low, s, e) + rise(high, s, e)) * (1.0 / 32);
    gradient[(axis + 2) % 3] = (rise(low, e, s) + rise(high, e, s)) * (1.0 / 32);
    return gradient;
}

const Vec3& CubicNodes::gradient(Node node) {
    if ((known_ >> node & 1) == 0) {
        known_ |= 1U << node;
        gradient_[node] = node < 8              ? corner_gradient(node)
                          : node == centre_node ? centre_gradient()
                                                : face_gradient(node);
    }
    return gradient_[node];
}

double CubicNodes::crossing(Node a, Node b) {
    const Vec3 along = 0.5 * (node_position(b) - node_position(a));
    const double f0 = excess_[a], f1 = excess_[b];
    const double d0 = gradient(a).dot(along), d1 = gradient(b).dot(along);
    // f0 + t (d0 + t (c2 + t c3)), between ends of which one is solid.
    const double c2 = 3 * (f1 - f0) - 2 * d0 - d1, c3 = 2 * (f0 - f1) + d0 + d1;
    const bool rises = f1 > 0;
    double low = 0, high = 1, t = f0 / (f0 - f1);
    const double enough = 1e-13 * field_.range();
    for (int i = 0; i < 100 && low < t && t < high; ++i) {
        const double p = f0 + t * (d0 + t * (c2 + t * c3));
        if (std::abs(p) <= enough) break;
        ((p > 0) == rises ? high : low) = t;
        const double next = t - p / (d0 + t * (2 * c2 + t * (3 * c3)));
        t = next > low && next < high ? next : 0.5 * (low + high);
    }
    return within_margin(t);
}

}  // namespace palpate::marching
