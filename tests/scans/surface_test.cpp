// The isosurface of scanned data: noise, borders that cut bodies, values equal to the isovalue.
// The head comes with the project; tests of other volumes are skipped where those are missing.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "io/real_volumes.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/lattice.hpp"
#include "palpate/surface.hpp"
#include "support/mesh_checks.hpp"

using namespace palpate;

namespace {

using io::test::Scan;

class SurfaceOnRealVolumes : public testing::TestWithParam<Scan> {};

/// Volume of the solid [mm^3], by counting at random points, with four standard deviations.
struct Count {
    double volume, tolerance;
};

Count counted_volume(const Field& field, double isovalue) {
    const Geometry& geometry = field.geometry();
    const Vec3 low = -Vec3::Ones();
    const Vec3 extent = (geometry.size + Index3::Ones()).cast<double>();
    const double box = extent.cwiseProduct(geometry.spacing).prod();
    constexpr int count = 300000;
    std::mt19937_64 random(1);
    int solid = 0;
    for (int i = 0; i < count; ++i) {
        Vec3 index;
        for (int a = 0; a < 3; ++a) {
            index[a] = low[a] + extent[a] * (static_cast<double>(random() >> 11) * 0x1p-53);
        }
        solid += field.sign() * (value_at(field, locate(index)) - isovalue) > 0;
    }
    const double part = double(solid) / count;
    return {part * box, 4 * std::sqrt(part * (1 - part) / count) * box};
}

}  // namespace

TEST_P(SurfaceOnRealVolumes, is_closed_and_encloses_the_solid) {
    const auto path = io::test::real_volume(GetParam().file);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const Field field = linear_field(io::read_volume(path).volume, GetParam().solid);
    const SurfaceMesh mesh = extract_surface(field, GetParam().isovalue);
    EXPECT_GT(mesh.triangles.size(), 1000U);
    EXPECT_EQ(support::flaw_in_closed_mesh(mesh), "");
    const Count count = counted_volume(field, GetParam().isovalue);
    EXPECT_NEAR(enclosed_volume(mesh), count.volume, count.tolerance);
    double farthest = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 97) {
        const double off = std::abs(value_at(field, mesh.vertices[i]) - GetParam().isovalue);
        farthest = std::max(farthest, off / field.range());
    }
    EXPECT_LE(farthest, surface_margin);
}

// Isovalues from the list that comes with the data; the iguana from the inside out.
INSTANTIATE_TEST_SUITE_P(Scans, SurfaceOnRealVolumes,
                         testing::Values(Scan{"head", io::sample_volume_skin},
                                         Scan{"head", io::sample_volume_bone, Solid::below},
                                         Scan{"fuel_small.nrrd", 30}, Scan{"lobster.nrrd", 35},
                                         Scan{"orange.nrrd", 15}, Scan{"daisy_pollen.nrrd", 40},
                                         Scan{"engine.nrrd", 60}, Scan{"cthead_unc.nrrd", 1200},
                                         Scan{"neuron_confocal.nrrd", 30},
                                         Scan{"HeadMRVolume.mhd", 60}, Scan{"dicom_sphere", 600},
                                         Scan{"iguana.nii.gz", 120, Solid::below},
                                         Scan{"visible_human_head.nrrd", 110}));
