// A finer part of a surface in place of a coarse one: the two meet without holes.
#include "apps/viewer/scene/render_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/viewer/model/detail.hpp"
#include "apps/viewer/scene/surface_blocks.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/parameter.hpp"
#include "viewer/scene/mesh_points.hpp"

namespace palpate::viewer {
namespace {

/// The mean of 4 x 4 x 4 samples, as a store's level is.
Volume coarse_of(const Volume& fine) {
    Geometry grid = fine.geometry();
    grid.size /= 4;
    grid.origin = physical_from_index(grid, Vec3::Constant(1.5));
    grid.spacing *= 4;
    std::vector<float> means;
    for (int k = 0; k < grid.size[2]; ++k) {
        for (int j = 0; j < grid.size[1]; ++j) {
            for (int i = 0; i < grid.size[0]; ++i) {
                double sum = 0;
                for (int s = 0; s < 64; ++s) {
                    sum += fine.sample(4 * Index3(i, j, k) + Index3(s & 3, s >> 2 & 3, s >> 4));
                }
                means.push_back(static_cast<float>(sum / 64));
            }
        }
    }
    return {grid, std::move(means)};
}

Volume part_of(const Volume& volume, const SampleBox& box) {
    Geometry grid = volume.geometry();
    grid.origin = physical_from_index(grid, box.low.cast<double>());
    grid.size = box.high - box.low + Index3::Ones();
    std::vector<float> samples;
    for (int k = box.low[2]; k <= box.high[2]; ++k) {
        for (int j = box.low[1]; j <= box.high[1]; ++j) {
            for (int i = box.low[0]; i <= box.high[0]; ++i) {
                samples.push_back(static_cast<float>(volume.sample({i, j, k})));
            }
        }
    }
    return {grid, std::move(samples)};
}

ExtractedSurface surface_of(const Field& field, double level, const Vec3& origin) {
    SurfaceBlocks blocks(field.geometry(), 1, field.interpolation(), origin);
    (void)blocks.renew(
        field, level, [] { return true; }, 1U << 30);
    ExtractedSurface surface;
    surface.isovalue = level;
    surface.blocks = blocks.meshes();
    surface.finished = true;
    return surface;
}

Point corner_of(const RenderMesh& mesh, std::int32_t v) {
    const float* const p = mesh.positions.data() + 3 * static_cast<std::size_t>(v);
    return {p[0], p[1], p[2]};
}
Vec3 vector(const Point& p) {
    return {p[0], p[1], p[2]};
}

/// Ends of edges that have one triangle.
std::vector<Vec3> rim_of(const MeshBlocks& blocks) {
    ByPlace<Edge, int> edges;
    for (const auto& mesh : blocks) {
        if (!mesh) continue;
        for (std::size_t t = 0; t < mesh->triangles.size(); t += 3) {
            for (std::size_t c = 0; c < 3; ++c) {
                Point a = corner_of(*mesh, mesh->triangles[t + c]);
                Point b = corner_of(*mesh, mesh->triangles[t + (c + 1) % 3]);
                if (b < a) std::swap(a, b);
                if (a != b) ++edges[{a, b}];
            }
        }
    }
    std::vector<Vec3> rim;
    for (const auto& [edge, count] : edges) {
        if (count % 2 == 0) continue;
        rim.push_back(vector(edge.first));
        rim.push_back(0.5 * (vector(edge.first) + vector(edge.second)));
    }
    return rim;
}

double distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    // By a fine subdivision: slow and obvious.
    double least = HUGE_VAL;
    constexpr int n = 12;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; i + j <= n; ++j) {
            const Vec3 at = a + double(i) / n * (b - a) + double(j) / n * (c - a);
            least = std::min(least, (p - at).norm());
        }
    }
    return least;
}

using Triangle = std::array<Vec3, 3>;

std::vector<Triangle> triangles_of(const MeshBlocks& blocks) {
    std::vector<Triangle> triangles;
    for (const auto& mesh : blocks) {
        if (!mesh) continue;
        for (std::size_t t = 0; t < mesh->triangles.size(); t += 3) {
            const auto corner = [&](std::size_t i) {
                return vector(corner_of(*mesh, mesh->triangles[t + i]));
            };
            triangles.push_back({corner(0), corner(1), corner(2)});
        }
    }
    return triangles;
}

double distance_to(const std::vector<Triangle>& triangles, const Vec3& p) {
    double least = HUGE_VAL;
    for (const auto& [a, b, c] : triangles) {
        if ((a - p).squaredNorm() > (least + 2) * (least + 2)) continue;
        least = std::min(least, distance(p, a, b, c));
    }
    return least;
}

struct Case {
    const char* scene;
    double level;
    Vec3 low, high;  // of the patch, in the overview's index space, for a linear field
};

class Patch : public testing::TestWithParam<Interpolation> {
  protected:
    /// Whole, finer and both, of a patch between planes of the overview.
    void make(const Case& with) {
        const Volume fine =
            scenes::make_volume(std::string(with.scene) + ":96x96x96", SampleType::float32).volume;
        const Field overview(coarse_of(fine), Solid::above, {}, GetParam());
        const double begin = GetParam() == Interpolation::cubic ? -0.5 : 0;
        PatchChoice patch;
        patch.low = with.low.array() + begin;
        patch.high = with.high.array() + begin;
        for (int a = 0; a < 3; ++a) {
            const auto plane = [&](double index) {
                Vec3 at = Vec3::Zero();
                at[a] = index;
                return index_from_physical(fine.geometry(),
                                           physical_from_index(overview.geometry(), at))[a];
            };
            patch.box.low[a] =
                std::isfinite(patch.low[a]) ? int(std::floor(plane(patch.low[a]))) - 2 : 0;
            patch.box.high[a] =
                std::isfinite(patch.high[a]) ? int(std::ceil(plane(patch.high[a]))) + 2 : 95;
        }
        const Vec3 origin = physical_centre(overview.geometry());
        bounds_ = {overview.geometry(), patch.low, patch.high};
        const Field finer(joined_samples(part_of(fine, patch.box), overview, patch), Solid::above,
                          overview.background(), GetParam());
        whole_ = surface_of(overview, with.level, origin);
        finer_ = surface_of(finer, with.level, origin);
        fine_spacing_ = fine.geometry().spacing.minCoeff();
    }
    Vec3 index(const Vec3& position) const {
        return index_from_physical(bounds_.grid, position + physical_centre(bounds_.grid));
    }
    MeshBlocks kept(const MeshBlocks& blocks, Keep keep) const {
        MeshBlocks all;
        for (const auto& block : blocks) all.push_back(cut(block, bounds_, keep));
        return all;
    }
    MeshBlocks outside() const { return kept(whole_.blocks, Keep::outside); }
    MeshBlocks inside() const { return kept(finer_.blocks, Keep::reaching_in); }

    PatchBounds bounds_;
    ExtractedSurface whole_, finer_;
    double fine_spacing_ = 1;
};

TEST_P(Patch, the_rim_of_what_is_left_of_the_coarse_surface_lies_on_the_finer_one) {
    for (const Case& with :
         {Case{"sphere", 0.3, {4, 4, 4}, {15, 14, 13}}, Case{"torus", 0.4, {3, 2, 7}, {12, 20, 16}},
          Case{"sphere", 0.3, {-HUGE_VAL, 3, 5}, {11, HUGE_VAL, HUGE_VAL}}}) {
        make(with);
        ASSERT_TRUE(rim_of(whole_.blocks).empty());
        const std::vector<Vec3> rim = rim_of(outside());
        ASSERT_GT(rim.size(), 20U) << with.scene;
        const std::vector<Triangle> finer = triangles_of(inside());
        double farthest = 0;
        for (const Vec3& point : rim) {
            farthest = std::max(farthest, distance_to(finer, point) / fine_spacing_);
        }
        EXPECT_LT(farthest, 0.5) << with.scene << ": of a fine voxel";
        std::printf("%s: %zu places, at most %.3f fine voxels apart\n", with.scene, rim.size(),
                    farthest);
    }
}

TEST_P(Patch, nothing_coarse_is_inside_and_nothing_fine_is_farther_outside_than_a_cell) {
    make({"torus", 0.4, {3, 2, 7}, {12, 20, 16}});
    const auto each = [&](const MeshBlocks& blocks, const auto& work) {
        for (const auto& mesh : blocks) {
            if (!mesh) continue;
            for (std::size_t t = 0; t < mesh->triangles.size(); t += 3) {
                std::array<Vec3, 3> corners;
                for (std::size_t c = 0; c < 3; ++c) {
                    corners[c] = index(vector(corner_of(*mesh, mesh->triangles[t + c])));
                }
                work(corners);
            }
        }
    };
    int coarse = 0, fine = 0;
    each(outside(), [&](const auto& c) {
        ++coarse;
        EXPECT_FALSE(bounds_.has((c[0] + c[1] + c[2]) / 3));
    });
    each(inside(), [&](const auto& c) {
        ++fine;
        for (const Vec3& corner : c) {
            const Vec3 beyond = (bounds_.low - corner).cwiseMax(corner - bounds_.high);
            EXPECT_LT(beyond.maxCoeff(), 0.3) << "a fine cell is a quarter of a coarse one";
        }
    });
    EXPECT_GT(coarse, 1000);
    EXPECT_GT(fine, 10000);
    // Cells of a linear field do not end with the part.
    EXPECT_GE(triangle_count(kept(finer_.blocks, Keep::reaching_out)),
              triangle_count(kept(finer_.blocks, Keep::outside)));
}

TEST_P(Patch, blocks_of_which_all_or_nothing_is_kept_cost_nothing) {
    make({"torus", 0.4, {3, 2, 7}, {12, 20, 16}});
    std::size_t same = 0, none = 0;
    for (const auto& block : finer_.blocks) {
        const auto left = cut(block, bounds_, Keep::reaching_in);
        same += block && left == block;
    }
    for (const auto& block : whole_.blocks) {
        PatchBounds everywhere = bounds_;
        everywhere.low = Vec3::Constant(-HUGE_VAL);
        everywhere.high = Vec3::Constant(HUGE_VAL);
        none += block && !cut(block, everywhere, Keep::outside);
    }
    EXPECT_GT(same, 0U) << "blocks that lie inside as a whole";
    EXPECT_GT(none, 0U);
}

INSTANTIATE_TEST_SUITE_P(Fields, Patch,
                         testing::Values(Interpolation::linear, Interpolation::cubic));

}  // namespace
}  // namespace palpate::viewer
