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

void expect_as_itk(const std::filesystem::path& path, const ItkVolume& itk) {
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

void expect_geometry(const VolumeFile& file, const Geometry& written) {
    const Geometry& g = file.volume.geometry();
    EXPECT_EQ(g.size, written.size);
    EXPECT_LT((g.spacing - written.spacing).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_LT((g.origin - written.origin).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((g.direction - written.direction).cwiseAbs().maxCoeff(), 1e-3);
}

/// ITK refuses sheared sforms, and also, by rounding errors, ones with axes at right angles: it
/// inverts them in single precision, which does not suffice for, say, 0.1 mm 200 mm off the origin.
bool is_refused_for_its_axes(const ItkVolume& itk) {
    return itk.error.find("orthonormal direction cosines") != std::string::npos;
}

}  // namespace

TEST(read_as_itk, random_nifti_files) {
    const ScratchFolder folder;
    std::mt19937 random(20240703);
    int compared = 0;
    for (int round = 0; round < 60; ++round) {
        const Geometry g = random_geometry(random, round % 2 == 1, round % 5 == 2);
        const int codes = 1 + round % 3, steps = round % 4 == 3 ? 3 : 1;
        const std::string bytes = random_nifti(random, types[round % 10], g, steps, codes);
        const bool packed = round % 3 == 2;
        const auto path = folder / (packed ? "a.nii.gz" : "b.nii");
        packed ? put_gzip(path, bytes) : put_bytes(path, bytes);
        SCOPED_TRACE(testing::Message() << "round " << round);
        const ItkVolume itk = read_with_itk(path);
        if (is_refused_for_its_axes(itk)) {
            EXPECT_EQ(codes, 2);  // with a qform, it takes that
        } else {
            expect_as_itk(path, itk);
            ++compared;
        }
        const VolumeFile file = read_volume(path);
        expect_geometry(file, g);
        EXPECT_FALSE(contains(all_notes(file), "sform")) << all_notes(file);
        if (testing::Test::HasFailure()) return;
    }
    EXPECT_GE(compared, 55);  // of 60
}

TEST(read_as_itk, nifti_files_with_a_sheared_or_another_sform_and_a_note_says_so) {
    const ScratchFolder folder;
    std::mt19937 random(20240704);
    int compared = 0;
    for (int round = 0; round < 40; ++round) {
        Geometry g = random_geometry(random, round % 2 == 1, round % 5 == 2);
        g.spacing = g.spacing.cwiseMax(0.5);  // see above
        const bool sheared = round % 4 < 2, has_qform = round % 3 > 0;
        std::string bytes = random_nifti(random, types[0], g, 1, has_qform ? 3 : 2);
        const bool big = bytes[0] == 0;
        const auto srow = [&](std::size_t row, std::size_t column, double more) {
            const std::size_t at = 280 + 16 * row + 4 * column;
            std::string value = bytes.substr(at, 4);
            if (big) std::reverse(value.begin(), value.end());
            float old = 0;
            std::memcpy(&old, value.data(), sizeof old);
            put_at(bytes, at, number(static_cast<float>(old + more), big));
        };
        Geometry expected = g;
        if (sheared) {
            const Vec3 first = g.direction.col(0);
            const double shear = uniform(random, 0.05, 0.5);
            srow(0, 1, -shear * first[0]);
            srow(1, 1, -shear * first[1]);
            srow(2, 1, shear * first[2]);
        } else {
            const double shift = uniform(random, 1, 50);
            srow(1, 3, -shift);
            expected.origin[1] += shift;
        }
        put_bytes(folder / "a.nii", bytes);
        SCOPED_TRACE(testing::Message() << "round " << round);
        const ItkVolume itk = read_with_itk(folder / "a.nii");
        if (sheared && !has_qform) {
            EXPECT_TRUE(is_refused_for_its_axes(itk)) << itk.error;
            EXPECT_TRUE(contains(refusal(folder / "a.nii"), "sheared"));
            continue;
        }
        expect_as_itk(folder / "a.nii", itk);
        ++compared;
        const VolumeFile file = read_volume(folder / "a.nii");
        expect_geometry(file, expected);
        const char* const note = sheared ? "its sform is sheared" : "the sform was taken";
        EXPECT_EQ(contains(all_notes(file), note), has_qform) << all_notes(file);
        if (testing::Test::HasFailure()) return;
    }
    EXPECT_GE(compared, 30);
}

TEST(read_as_itk, real_nifti_files) {
    for (const char* name : {"iguana.nii.gz", "chris_MRA.nii.gz", "anatomical_be.nii"}) {
        if (!std::filesystem::exists(real_volume(name))) continue;
        expect_as_itk(real_volume(name), read_with_itk(real_volume(name)));
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
