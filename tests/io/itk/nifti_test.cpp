// Palpate and ITK read the same samples and the same geometry from random NIfTI files, where ITK
// follows the format: lengths in mm, and transforms that agree. tests/python compares the rest with
// nibabel.
#include "io/real_volumes.hpp"
#include "io/volume_nifti_bytes.hpp"
#include "itk_reader.hpp"

namespace palpate::io::test {
namespace {

struct Type {
    std::int16_t code;
    std::int16_t bytes;
};
constexpr Type types[] = {{2, 1},   {4, 2},   {8, 4},   {16, 4},   {64, 8},
                          {256, 1}, {512, 2}, {768, 4}, {1024, 8}, {1280, 8}};

/// Little-endian bytes, or those in the other order.
template <class T>
std::string number(T value, bool big) {
    std::string bytes = little(value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

void put_geometry(std::string& header, const Geometry& g, int codes, bool big) {
    const auto put = [&](std::size_t at, double value) {
        put_at(header, at, number(static_cast<float>(value), big));
    };
    Mat3 ras = g.direction;
    ras.topRows<2>() *= -1;
    const bool mirrored = ras.determinant() < 0;
    put(76, mirrored ? -1 : 1);
    Mat3 turn = ras;
    if (mirrored) turn.col(2) *= -1;
    const Eigen::Quaterniond q(turn);
    const double sign = q.w() < 0 ? -1 : 1;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        const double offset = a < 2 ? -g.origin[i] : g.origin[i];
        put(80 + 4 * a, g.spacing[i]);
        put(256 + 4 * a, sign * q.vec()[i]);
        put(268 + 4 * a, offset);
        for (std::size_t b = 0; b < 3; ++b) {
            const auto j = static_cast<Eigen::Index>(b);
            put(280 + 16 * a + 4 * b, ras(i, j) * g.spacing[j]);
        }
        put(292 + 16 * a, offset);
    }
    put_at(header, 252, number<std::int16_t>(codes & 1, big));
    put_at(header, 254, number<std::int16_t>(codes >> 1, big));
}

std::string random_nifti(std::mt19937& random, const Type& type, const Geometry& g, int steps,
                         int codes) {
    const bool big = random() % 2 == 0;
    std::string header = nifti([](std::string&) {});
    header.resize(352);
    put_at(header, 0, number<std::int32_t>(348, big));
    const std::int16_t sizes[8] = {static_cast<std::int16_t>(steps > 1 ? 4 : 3),
                                   static_cast<std::int16_t>(g.size[0]),
                                   static_cast<std::int16_t>(g.size[1]),
                                   static_cast<std::int16_t>(g.size[2]),
                                   static_cast<std::int16_t>(steps),
                                   1,
                                   1,
                                   1};
    for (std::size_t i = 0; i < 8; ++i) put_at(header, 40 + 2 * i, number(sizes[i], big));
    put_at(header, 70, number(type.code, big));
    put_at(header, 72, number(static_cast<std::int16_t>(8 * type.bytes), big));
    put_at(header, 92, number(1.0F, big));
    put_at(header, 108, number(352.0F, big));
    put_geometry(header, g, codes, big);
    const auto count = static_cast<std::size_t>(sample_count(g) * steps);
    for (std::size_t i = 0; i < count; ++i) {
        if (type.code == 16) header += number(float(uniform(random, -1e4, 1e4)), big);
        if (type.code == 64) header += number(uniform(random, -1e4, 1e4), big);
        if (type.code == 16 || type.code == 64) continue;
        for (int b = 0; b < type.bytes; ++b) header += static_cast<char>(random());
    }
    return header;
}

void expect_as_itk(const std::filesystem::path& path) {
    const ItkVolume itk = read_with_itk(path);
    ASSERT_EQ(itk.error, "");
    VolumeFile file = read_volume(path);
    const Geometry& g = file.volume.geometry();
    for (std::size_t a = 0; a < 3; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        ASSERT_EQ(g.size[i], itk.sizes[a]);
        EXPECT_NEAR(g.spacing[i], itk.spacing[a], 1e-6 * itk.spacing[a]);
        EXPECT_NEAR(g.origin[i], itk.origin[a], 1e-4);
        for (std::size_t r = 0; r < 3; ++r) {
            EXPECT_NEAR(g.direction(static_cast<Eigen::Index>(r), i), itk.axes[a][r], 1e-3);
        }
    }
    const std::int64_t count = sample_count(g);
    ASSERT_EQ(static_cast<std::int64_t>(itk.samples.size()), count * file.time_steps);
    for (int step = 0; step < file.time_steps; ++step) {
        ReadOptions options;
        options.time_step = step;
        if (step > 0) file = read_volume(path, options);
        for (std::int64_t i = 0; i < count; ++i) {
            const Index3 at(int(i % g.size[0]), int(i / g.size[0] % g.size[1]),
                            int(i / g.size[0] / g.size[1]));
            const double expected = itk.samples[static_cast<std::size_t>(step * count + i)];
            ASSERT_EQ(file.volume.sample(at), double(float(expected))) << at.transpose();
        }
    }
}

}  // namespace

TEST(read_as_itk, random_nifti_files) {
    const ScratchFolder folder;
    std::mt19937 random(20240703);
    for (int round = 0; round < 60; ++round) {
        const Geometry g = random_geometry(random, round % 2 == 1, round % 5 == 2);
        const int codes = 1 + round % 3, steps = round % 4 == 3 ? 3 : 1;
        const std::string bytes = random_nifti(random, types[round % 10], g, steps, codes);
        const bool packed = round % 3 == 2;
        const auto path = folder / (packed ? "a.nii.gz" : "b.nii");
        packed ? put_gzip(path, bytes) : put_bytes(path, bytes);
        SCOPED_TRACE(testing::Message() << "round " << round);
        expect_as_itk(path);
        if (testing::Test::HasFailure()) return;
    }
}

TEST(read_as_itk, real_nifti_files) {
    for (const char* name : {"iguana.nii.gz", "chris_MRA.nii.gz", "anatomical_be.nii"}) {
        if (std::filesystem::exists(real_volume(name))) expect_as_itk(real_volume(name));
    }
}

TEST(read_otherwise_than_itk, a_nifti_file_without_a_transform_has_the_axes_of_lps) {
    const ScratchFolder folder;
    put_bytes(folder / "a.nii",
              nifti([](std::string& h) { put_at(h, 252, std::string(4, '\0')); }));
    const ItkVolume itk = read_with_itk(folder / "a.nii");
    EXPECT_EQ(itk.axes[0], (std::vector<double>{1, 0, 0}));
    EXPECT_EQ(itk.origin, (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(read_volume(folder / "a.nii").volume.geometry().direction, Mat3::Identity());
}

}  // namespace palpate::io::test
