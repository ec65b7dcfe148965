// The named scenes: the promised properties of their samples, sizes, types and texts.
#include "palpate/scenes/volumes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "palpate/field.hpp"
#include "scenes/hash.hpp"
#include "scenes/random.hpp"

using namespace palpate;
using namespace palpate::scenes;

namespace {

std::string message_of(const std::string& spec) {
    try {
        make_volume(spec);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST(Volumes, the_cylinder_is_the_papers_formula_at_every_sample) {
    const Scene scene = make_volume("synthetic:cylinder");
    ASSERT_EQ(scene.volume.geometry().size, Index3(100, 100, 30));
    ASSERT_EQ(scene.volume.type(), SampleType::float32);
    int positive = 0;
    for (int k = 0; k < 30; k += 29) {
        for (int j = 0; j < 100; ++j) {
            for (int i = 0; i < 100; ++i) {
                const double expected = std::max(0.0, 1 - std::hypot(i - 49.5, j - 49.5) / 50);
                ASSERT_NEAR(scene.volume.sample({i, j, k}), expected, 1e-7) << i << ' ' << j;
                positive += expected > 0;
            }
        }
    }
    EXPECT_NEAR(positive / 2, 3.14159 * 50 * 50, 80);  // a round section, not a square one
}

TEST(Volumes, the_cylinder_scales_with_its_size) {
    const Scene scene = make_volume("cylinder:20x20x5");
    EXPECT_NEAR(scene.volume.sample({17, 9, 2}), 1 - std::hypot(7.5, 0.5) / 10, 1e-7);
}

TEST(Volumes, round_scenes_are_mirror_symmetric_bit_for_bit) {
    for (const std::string name : {"cylinder", "sphere", "torus", "shell"}) {
        const Volume volume = make_volume(name + ":31x31x18").volume;
        for (int k = 0; k < 18; ++k) {
            for (int j = 0; j < 31; ++j) {
                for (int i = 0; i < 31; ++i) {
                    const double here = volume.sample({i, j, k});
                    ASSERT_EQ(here, volume.sample({30 - i, j, k})) << name;
                    ASSERT_EQ(here, volume.sample({j, i, k})) << name;
                    ASSERT_EQ(here, volume.sample({i, j, 17 - k})) << name;
                }
            }
        }
        EXPECT_GT(volume.maximum(), volume.minimum()) << name;
    }
}

TEST(Volumes, samples_are_the_exact_density_rounded_to_the_type) {
    Random random(3);
    int analytic_scenes = 0;
    for (const std::string& name : volume_names()) {
        for (const auto type :
             {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
            const Scene scene = make_volume(name + ":17x12x9", type);
            ASSERT_EQ(scene.volume.type(), type);
            if (!scene.exact) continue;
            ++analytic_scenes;
            const double tolerance = type == SampleType::float32 ? 1e-7 : 0.5 + 1e-9;
            for (int n = 0; n < 200; ++n) {
                const Index3 i(int(random.bits() % 17), int(random.bits() % 12),
                               int(random.bits() % 9));
                const Vec3 p = physical_from_index(scene.volume.geometry(), i.cast<double>());
                ASSERT_NEAR(scene.exact(p), scene.volume.sample(i), tolerance) << name;
            }
        }
    }
    EXPECT_EQ(analytic_scenes, 7 * 4);
}

TEST(Volumes, integer_types_use_their_whole_positive_range) {
    EXPECT_NEAR(make_volume("plane", SampleType::uint8).volume.maximum(), 255, 0);
    EXPECT_NEAR(make_volume("plane", SampleType::int16).volume.maximum(), 32767, 0);
    EXPECT_NEAR(make_volume("plane", SampleType::uint16).volume.maximum(), 65535, 0);
    EXPECT_NEAR(make_volume("plane", SampleType::float32).volume.maximum(), 1, 0);
    EXPECT_NEAR(make_volume("plane", SampleType::uint16).isovalue, 32767.5, 0);
}

TEST(Volumes, every_isovalue_is_well_inside_the_range_of_the_data) {
    for (const std::string& name : volume_names()) {
        const Scene scene = make_volume(name);
        const double reach = scene.volume.maximum() - scene.volume.minimum();
        EXPECT_GT(scene.isovalue, scene.volume.minimum() + 0.05 * reach) << name;
        EXPECT_LT(scene.isovalue, scene.volume.maximum() - 0.05 * reach) << name;
        EXPECT_FALSE(scene.description.empty()) << name;
        EXPECT_EQ(scene.name, name);
    }
}

TEST(Volumes, the_physical_centre_is_the_origin) {
    for (const std::string spec : {"cylinder", "sphere:7x8x9", "noise:1x2x300"}) {
        EXPECT_EQ(physical_centre(make_volume(spec).volume.geometry()), Vec3(0, 0, 0)) << spec;
    }
}

TEST(Volumes, a_sphere_stays_a_sphere_on_an_anisotropic_and_oblique_grid) {
    const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    Geometry geometry = centred({60, 60, 15}, {0.5, 0.5, 2}, turned);
    geometry.origin += Vec3(10, -20, 30);
    const Scene scene = make_volume("sphere", geometry, SampleType::float32);
    const Field field = linear_field(scene.volume);
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.6, 0, -0.8)}) {
        const Vec3 p = Vec3(10, -20, 30) + 9 * way;
        EXPECT_NEAR(scene.exact(p), 1 - 9.0 / 15, 1e-12);
        EXPECT_NEAR(value_at(field, p), 1 - 9.0 / 15, 0.01);
    }
}

TEST(Volumes, marschner_lobb_is_the_published_signal) {
    const Scene scene = make_volume("marschner-lobb");
    ASSERT_EQ(scene.volume.geometry().size, Index3(41, 41, 41));
    const auto published = [](double x, double y, double z) {
        const double pi = std::acos(-1.0), r = std::sqrt(x * x + y * y);
        const double rho = std::cos(12 * pi * std::cos(pi * r / 2));
        return (1 - std::sin(pi * z / 2) + 0.25 * (1 + rho)) / 2.5;
    };
    EXPECT_NEAR(scene.volume.sample({20, 20, 20}), published(0, 0, 0), 1e-6);
    EXPECT_NEAR(scene.volume.sample({33, 12, 5}), published(0.65, -0.4, -0.75), 1e-6);
    EXPECT_NEAR(scene.volume.sample({40, 0, 40}), published(1, -1, 1), 1e-6);
}

TEST(Volumes, the_way_into_the_head_leads_through_skin_then_skull_then_brain) {
    const Scene scene = make_volume("shepp-logan");
    std::string layers;
    for (int k = 127; k >= 64; --k) {  // from the top of the head down
        const double hounsfield = scene.volume.sample({64, 64, k});
        const char layer = hounsfield == -1000                   ? 'a'
                           : std::abs(hounsfield - 60) < 1       ? 's'
                           : hounsfield > 900                    ? 'b'
                           : hounsfield >= 5 && hounsfield <= 45 ? 'n'
                                                                 : '-';
        if (layer != '-' && (layers.empty() || layers.back() != layer)) layers += layer;
    }
    EXPECT_EQ(layers.substr(0, 4), "asbn");
    EXPECT_LT(scene.isovalue, 60);
    EXPECT_GT(scene.isovalue, -1000);
    EXPECT_EQ(scene.volume.minimum(), -1000);
    EXPECT_EQ(scene.volume.maximum(), 1000);
    const Scene shifted = make_volume("shepp-logan", SampleType::uint16);
    EXPECT_EQ(shifted.volume.sample({64, 64, 64}), scene.volume.sample({64, 64, 64}) + 1000);
    EXPECT_EQ(shifted.isovalue, scene.isovalue + 1000);
}

TEST(Volumes, the_same_scene_is_the_same_bytes_everywhere) {
    // No libm beyond sqrt in these, so the bytes hold for every compiler and machine.
    const std::map<std::string, std::uint64_t> golden{
        {"cylinder", 0xadac075923da2ea5u},    {"sphere", 0x8755bf86f81a8d1du},
        {"torus", 0x572c32a04c73372du},       {"plane", 0x1607ae43934cbc25u},
        {"shell", 0x9a21085435a08f15u},       {"noise", 0x43d64c893e68d3bdu},
        {"shepp-logan", 0x8a73edd473f970d3u},
    };
    for (const auto& [name, hash] : golden) {
        const Volume volume = make_volume(name + ":24x20x16").volume;
        EXPECT_EQ(hash_of(volume.data(), volume.bytes()), hash) << name;
    }
}

TEST(Volumes, one_voxel_thin_sizes_work) {
    for (const std::string& name : volume_names()) {
        for (const std::string size : {"1x1x1", "1x16x16", "16x1x16", "16x16x1", "16x1x1"}) {
            SCOPED_TRACE(name + ":" + size);
            EXPECT_NO_THROW(make_volume(name + ":" + size));
        }
    }
    const Volume slice = make_volume("sphere:16x16x1").volume;  // through the middle
    EXPECT_GT(slice.maximum(), 200);
    EXPECT_EQ(slice.minimum(), 0);
}

TEST(Volumes, unknown_names_are_answered_with_the_known_ones) {
    for (const std::string spec : {"cylindre", "synthetic:", "", "synthetic:Sphere"}) {
        for (const std::string& name : volume_names()) {
            EXPECT_TRUE(contains(message_of(spec), name)) << message_of(spec);
        }
    }
}

TEST(Volumes, bad_sizes_are_refused_with_the_form) {
    for (const std::string size : {"", "64", "64x64", "64x64x64x64", "0x1x1", "-3x4x5", "4x4x4 ",
                                   "ax4x4", "4.5x4x4", "99999999999x1x1", "4x4x"}) {
        EXPECT_TRUE(contains(message_of("sphere:" + size), "64x64x64")) << size;
    }
}

TEST(Volumes, report_progress_and_stop_when_that_throws) {
    struct Cancelled {};
    for (const std::string& name : volume_names()) {
        int reports = 0;
        (void)make_volume(name + ":512x256x2", {}, [&](double part) {
            EXPECT_GT(part, 0);
            EXPECT_LE(part, 1);
            ++reports;
        });
        EXPECT_GE(reports, 3) << name;
        EXPECT_THROW((void)make_volume(name + ":512x256x2", {}, [](double) { throw Cancelled(); }),
                     Cancelled)
            << name;
    }
}

TEST(Volumes, absurd_sizes_are_refused_before_memory_is_asked_for) {
    EXPECT_TRUE(contains(message_of("noise:4096x4096x4096"), "GiB"));
    EXPECT_TRUE(contains(message_of("noise:1048576x1048576x1048576"), "GiB"));
    EXPECT_TRUE(contains(message_of("noise:2000000x1x1"), "1048576"));
}
