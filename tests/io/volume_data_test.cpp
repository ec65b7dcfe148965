// Real volumes: size, type, spacing and range as other programs give them. The head comes with the
// project; tests of other volumes are skipped where those are missing.
#include "real_volumes.hpp"
#include "volume_support.hpp"

namespace palpate::io::test {
namespace {

struct Known {
    const char* name;
    Index3 size;
    SampleType type;
    Vec3 spacing;
    double minimum, maximum;
    int time_step = 0;
};

void PrintTo(const Known& known, std::ostream* out) {
    *out << known.name;
}

class RealVolume : public testing::TestWithParam<Known> {};

TEST_P(RealVolume, is_read_as_others_read_it) {
    const Known& known = GetParam();
    const auto path = real_volume(known.name);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    ReadOptions options;
    options.time_step = known.time_step;
    const VolumeFile file = read_volume(path, options);
    EXPECT_EQ(file.volume.geometry().size, known.size);
    EXPECT_EQ(file.volume.type(), known.type);
    EXPECT_LT((file.volume.geometry().spacing - known.spacing).cwiseAbs().maxCoeff(), 5e-4);
    EXPECT_EQ(file.volume.minimum(), known.minimum);
    EXPECT_EQ(file.volume.maximum(), known.maximum);
}

constexpr auto u8 = SampleType::uint8;
INSTANTIATE_TEST_SUITE_P(
    data, RealVolume,
    testing::Values(
        Known{"head", {96, 108, 110}, u8, {2, 2, 2}, 0, 220},
        Known{"lobster.nrrd", {301, 324, 56}, u8, {1, 1, 1.4}, 0, 255},
        Known{"orange.nrrd", {256, 256, 64}, u8, {0.390625, 0.390625, 1}, 0, 228},
        Known{"daisy_pollen.nrrd", {192, 180, 168}, u8, {1, 1, 1}, 0, 254},
        Known{"cthead_unc.nrrd", {256, 256, 113}, SampleType::uint16, {1, 1, 2}, 0, 3272},
        Known{"visible_human_head.nrrd", {512, 512, 234}, u8, {1, 1, 1}, 0, 255},
        Known{"neuron_confocal.nrrd", {409, 415, 119}, u8, {1, 1, 1}, 0, 255},
        Known{"engine.nrrd", {256, 256, 128}, u8, {1, 1, 1}, 0, 255},
        Known{"bonsai.nrrd", {256, 256, 256}, u8, {1, 1, 1}, 0, 255},
        Known{"fuel_small.nrrd", {64, 33, 32}, u8, {1, 1, 1}, 0, 255},
        Known{"iguana.nii.gz", {210, 256, 179}, u8, {0.1018, 0.1018, 0.1018}, 0, 229},
        Known{"chris_MRA.nii.gz", {200, 256, 120}, u8, {0.521, 0.521, 0.65}, 0, 254},
        Known{"anatomical_be.nii", {33, 41, 25}, SampleType::int16, {2, 2, 2}, -610, 30393},
        Known{"HeadMRVolume.mhd", {48, 62, 42}, u8, {4, 4, 4}, 0, 255},
        Known{"dicom_sphere", {86, 86, 63}, SampleType::uint16, {2.23256, 2.23256, 2.2}, 0, 3752},
        Known{"visible_human_male_1001.dcm",
              {512, 512, 1},
              SampleType::int16,
              {1, 1, 1},
              -1024,
              1017}));

TEST(real_volume, the_time_steps_of_the_turning_head_differ_and_cover_its_range) {
    const auto path = real_volume("fmri_headturn_4d.nrrd");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    double maximum = 0;
    std::vector<Volume> steps;
    for (int step = 0; step < 6; ++step) {
        ReadOptions options;
        options.time_step = step;
        const VolumeFile file = read_volume(path, options);
        EXPECT_EQ(file.time_steps, 6);
        EXPECT_EQ(file.volume.geometry().size, Index3(64, 64, 36));
        EXPECT_EQ(file.volume.geometry().spacing, Vec3(3.203125, 3.203125, 3.6));
        maximum = std::max(maximum, file.volume.maximum());
        for (const Volume& other : steps) EXPECT_FALSE(same_samples(other, file.volume));
        steps.push_back(file.volume);
    }
    EXPECT_EQ(maximum, 3174);
    ReadOptions options;
    options.time_step = 6;
    EXPECT_TRUE(contains(refusal(path, options), "it has 6"));
}

TEST(real_volume, the_lobster_without_a_header_is_the_lobster) {
    const auto path = real_volume("lobster_301x324x56_uint8.raw.gz");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    ReadOptions options;
    options.raw = RawLayout{{301, 324, 56}, SampleType::uint8, {1, 1, 1.4}, 0};
    const VolumeFile file = read_volume(path, options);
    EXPECT_TRUE(same_samples(file.volume, read_volume(real_volume("lobster.nrrd")).volume));
    options.raw->size[2] = 57;
    const std::string message = refusal(path, options);
    EXPECT_TRUE(contains(message, "5461344") && contains(message, "5558868")) << message;
}

TEST(real_volume, a_dicom_series_lies_where_its_slices_say) {
    const auto path = real_volume("dicom_sphere");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const VolumeFile file = read_volume(path);
    const Geometry& g = file.volume.geometry();
    EXPECT_EQ(file.format, "DICOM series");
    EXPECT_EQ(g.direction.col(2), Vec3(-1, 0, 0));  // sagittal
    EXPECT_NEAR(g.origin[0], 68.2, 1e-6);
    const VolumeFile first = read_volume(path / "5002064.dcm");
    EXPECT_EQ(first.volume.geometry().size, Index3(86, 86, 1));
}

}  // namespace
}  // namespace palpate::io::test
