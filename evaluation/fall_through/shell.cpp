// Fills the samples of a shell, voxel by voxel.
#include "evaluation/fall_through/shell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "palpate/scenes/volumes.hpp"

namespace palpate::evaluation {
namespace {

constexpr int samples = 28;  // along an axis
constexpr int cells = samples - 1;
constexpr double half_width = 10.5;  // [voxel] of the body, the outer layer of samples included
constexpr double full = 255;

/// Cells of the body, and the samples that are full; both by index, x fastest.
struct Voxels {
    Enclosed enclosed;
    std::vector<std::uint8_t> sample;

    bool is_body(const Index3& cell) const {
        const Vec3 from = cell.cast<double>() + Vec3::Constant(0.5 - 0.5 * cells);
        return enclosed == Enclosed::box ? from.cwiseAbs().maxCoeff() <= half_width
                                         : from.norm() <= half_width;
    }
    std::uint8_t& at(const Index3& index) {
        return sample[static_cast<std::size_t>(index[0] +
                                               samples * (index[1] + samples * index[2]))];
    }
};

template <class Visit>
void for_each_cell(Visit&& visit) {
    for (int k = 0; k < cells; ++k) {
        for (int j = 0; j < cells; ++j) {
            for (int i = 0; i < cells; ++i) visit(Index3(i, j, k));
        }
    }
}

/// Fills the four samples of each face between a cell of the body and one that is not.
void fill_surface(Voxels& voxels) {
    for_each_cell([&](const Index3& cell) {
        if (!voxels.is_body(cell)) return;
        for (int a = 0; a < 3; ++a) {
            for (const int side : {0, 1}) {
                if (voxels.is_body(cell + (2 * side - 1) * Index3::Unit(a))) continue;
                const Index3 corner = cell + side * Index3::Unit(a);
                const Index3 u = Index3::Unit((a + 1) % 3), v = Index3::Unit((a + 2) % 3);
                for (const Index3& index :
                     {corner, Index3(corner + u), Index3(corner + v), Index3(corner + u + v)}) {
                    voxels.at(index) = full;
                }
            }
        }
    });
}

/// Fills the corners of every cell of the body that has a full one already.
void fill_layer_inside(Voxels& voxels) {
    const std::vector<std::uint8_t> before = voxels.sample;
    Voxels old{voxels.enclosed, before};
    for_each_cell([&](const Index3& cell) {
        if (!voxels.is_body(cell)) return;
        const auto corner = [&](int c) {
            return Index3(cell + Index3(c & 1, c >> 1 & 1, c >> 2 & 1));
        };
        bool touched = false;
        for (int c = 0; c < 8; ++c) touched |= old.at(corner(c)) != 0;
        for (int c = 0; touched && c < 8; ++c) voxels.at(corner(c)) = full;
    });
}

/// A smooth field across a flat wall of so many full layers, `x` [voxel] from its middle: a
/// quadratic spline.
double across_layers(int layers, double x) {
    double sum = 0;
    for (int i = 0; i < layers; ++i) {
        const double off = std::abs(x - (i - 0.5 * (layers - 1)));
        const double tail = std::max(0.0, 1.5 - off);
        sum += off <= 0.5 ? 0.75 - off * off : 0.5 * tail * tail;
    }
    return sum;
}

}  // namespace

Subject closed_shell(Enclosed enclosed, double thickness, Interpolation interpolation) {
    if (!(thickness > 0 && thickness <= 4)) {
        throw std::invalid_argument(
            fmt::format("a shell of {} voxels: it can be above 0 and up to 4 thick", thickness));
    }
    const bool is_smooth = interpolation == Interpolation::cubic;
    const int layers = std::max(is_smooth ? 2 : 1, static_cast<int>(std::lround(thickness)));
    Voxels voxels{enclosed, std::vector<std::uint8_t>(samples * samples * samples, 0)};
    fill_surface(voxels);
    for (int i = 1; i < layers; ++i) fill_layer_inside(voxels);
    Volume volume(scenes::centred(Index3::Constant(samples)), std::move(voxels.sample));
    const double level =
        is_smooth ? across_layers(layers, 0.5 * thickness) : 1 - 0.5 * (thickness - layers + 1);
    return {enclosed == Enclosed::box ? "box" : "ball",
            Field(std::move(volume), Solid::above, std::nullopt, interpolation), full * level};
}

}  // namespace palpate::evaluation
