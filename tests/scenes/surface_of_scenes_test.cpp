// The isosurface of every scene: closed, and enclosing what a count at random points finds solid.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/lattice.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/surface.hpp"
#include "scenes/random.hpp"
#include "support/mesh_checks.hpp"

using namespace palpate;

namespace {

class SurfaceOfScenes : public testing::TestWithParam<std::string> {};

}  // namespace

TEST_P(SurfaceOfScenes, is_closed_and_encloses_what_is_solid) {
    const scenes::Scene scene = scenes::make_volume(GetParam() + ":40x40x40");
    const Field field = linear_field(scene.volume);
    const SurfaceMesh mesh = extract_surface(field, scene.isovalue);
    EXPECT_GT(mesh.triangles.size(), 1000U);
    EXPECT_EQ(support::flaw_in_closed_mesh(mesh), "");

    scenes::Random random(7);
    constexpr int count = 100000;
    int solid = 0;
    for (int i = 0; i < count; ++i) {
        Vec3 index;
        for (double& x : index) x = -1 + 41 * random.uniform();
        solid += value_at(field, locate(index)) > scene.isovalue;
    }
    const double voxel = scene.volume.geometry().spacing.prod();
    const double box = std::pow(41.0, 3) * voxel;  // [mm^3]: padded by one
    const double part = double(solid) / count;
    const double tolerance = 4 * std::sqrt(part * (1 - part) / count) * box;
    EXPECT_NEAR(enclosed_volume(mesh), part * box, tolerance);
    EXPECT_LT(tolerance, 0.25 * part * box);  // the count says something
}

INSTANTIATE_TEST_SUITE_P(Scenes, SurfaceOfScenes, testing::ValuesIn(scenes::volume_names()));
