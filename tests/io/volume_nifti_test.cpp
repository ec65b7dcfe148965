// NIfTI as the format says and as nibabel reads it: units, transforms, slopes, packing. The same
// from a file read whole and, in tests/stream, by the box.
#include <array>
#include <cmath>

#include "volume_nifti_bytes.hpp"

namespace palpate::io::test {
namespace {

VolumeFile read_nifti(const ScratchFolder& folder, const std::string& bytes) {
    put_bytes(folder / "a.nii", bytes);
    return read_volume(folder / "a.nii");
}

void put_transform(std::string& header, const std::array<float, 12>& rows) {
    for (std::size_t i = 0; i < 12; ++i) put_at(header, 280 + 4 * i, little(rows[i]));
}

void put_codes(std::string& header, std::int16_t qform, std::int16_t sform) {
    put_at(header, 252, little(qform) + little(sform));
}

void put_pixdim(std::string& header, float x, float y, float z) {
    put_at(header, 80, little(x) + little(y) + little(z));
}

void put_offset(std::string& header, float x, float y, float z) {
    put_at(header, 268, little(x) + little(y) + little(z));
}

TEST(nifti, a_spacing_of_0_or_below_is_corrected_and_said) {
    for (const std::int16_t qform : {0, 1}) {
        const ScratchFolder folder;
        const VolumeFile file = read_nifti(folder, nifti([&](std::string& h) {
                                               put_pixdim(h, 2, 0, -3);
                                               put_codes(h, qform, 0);
                                           }));
        EXPECT_EQ(file.volume.geometry().spacing, Vec3(2, 1, 3));
        EXPECT_TRUE(contains(all_notes(file), "spacing 0 along axis 2: 1 mm was taken"));
        EXPECT_TRUE(contains(all_notes(file), "spacing -3 along axis 3: 3 mm was taken"));
    }
}

TEST(nifti, units_scale_the_spacing_and_the_origin_of_every_transform) {
    const ScratchFolder folder;
    // Unknown units and codes that the format does not have are taken as mm, and said.
    for (const auto& [code, mm] : {std::pair{0, 1.0}, {1, 1e3}, {2, 1.0}, {3, 1e-3}, {6, 1.0}}) {
        for (const auto& [qform, sform] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
            const VolumeFile file = read_nifti(
                folder, nifti([&, code = code, qform = qform, sform = sform](std::string& h) {
                    put_at(h, 123, std::string(1, static_cast<char>(code | 16)));
                    put_pixdim(h, 2, 4, 8);
                    put_offset(h, 16, 32, 64);
                    put_transform(h, {2, 0, 0, 16, 0, 4, 0, 32, 0, 0, 8, 64});
                    put_codes(h, static_cast<std::int16_t>(qform),
                              static_cast<std::int16_t>(sform));
                }));
            SCOPED_TRACE(testing::Message() << code << " " << qform << " " << sform);
            const Geometry& g = file.volume.geometry();
            EXPECT_TRUE(g.spacing.isApprox(mm * Vec3(2, 4, 8), 1e-12)) << g.spacing.transpose();
            const bool placed = qform + sform > 0;
            const Vec3 origin = placed ? Vec3(mm * Vec3(-16, -32, 64)) : Vec3::Zero();
            EXPECT_TRUE(g.origin.isApprox(origin, 1e-12)) << g.origin.transpose();
            EXPECT_EQ(contains(all_notes(file), "mm were taken"), code == 0 || code == 6);
            EXPECT_EQ(contains(all_notes(file), "orientation"), !placed);
        }
    }
}

TEST(nifti, a_slope_that_is_none_leaves_the_samples_and_an_ignored_intercept_is_said) {
    const ScratchFolder folder;
    const auto read = [&](float slope, float intercept) {
        return read_nifti(folder, nifti([&](std::string& h) {
                              put_at(h, 112, little(slope) + little(intercept));
                          }));
    };
    for (const float slope : {0.0F, -0.0F, not_a_number, infinite, -infinite}) {
        for (const float intercept : {0.0F, 7.0F, not_a_number, infinite}) {
            SCOPED_TRACE(testing::Message() << slope << " " << intercept);
            const VolumeFile file = read(slope, intercept);
            EXPECT_EQ(file.volume.type(), SampleType::int16);
            EXPECT_EQ(file.volume.minimum(), 0);
            EXPECT_EQ(file.volume.maximum(), 23);
            const bool unset = !std::isinf(slope) && (intercept == 0 || std::isnan(intercept));
            EXPECT_EQ(contains(all_notes(file), "slope"), !unset);
        }
    }
    for (const float slope : {1.0F, -2.0F, 0.5F, 1e-3F}) {
        for (const float intercept : {0.0F, -1000.0F}) {
            const VolumeFile file = read(slope, intercept);
            const auto expected = [&](int stored) {
                return double(float(stored * double(slope) + double(intercept)));
            };
            for (int i = 0; i < 24; ++i) {
                ASSERT_EQ(file.volume.sample({i % 2, i / 2 % 3, i / 6}), expected(i));
            }
        }
        for (const float intercept : {not_a_number, infinite}) {
            put_bytes(folder / "a.nii", nifti([&](std::string& h) {
                          put_at(h, 112, little(slope) + little(intercept));
                      }));
            EXPECT_TRUE(contains(refusal(folder / "a.nii"), "intercept"));
        }
    }
}

TEST(nifti, samples_come_from_the_file_itself_whatever_lies_beside_it) {
    const ScratchFolder folder;
    const auto with_slope = [](float slope) {
        return nifti([&](std::string& h) { put_at(h, 112, little(slope)); });
    };
    put_bytes(folder / "a.nii", with_slope(2));
    put_gzip(folder / "a.nii.gz", with_slope(3));
    put_bytes(folder / "a.hdr", with_slope(5));
    put_bytes(folder / "a.img", with_slope(7));
    EXPECT_EQ(read_volume(folder / "a.nii").volume.maximum(), 46);
    EXPECT_EQ(read_volume(folder / "a.nii.gz").volume.maximum(), 69);
    put_bytes(folder / "a.nii", "nothing of a volume");
    EXPECT_EQ(read_volume(folder / "a.nii.gz").volume.maximum(), 69);
}

TEST(nifti, of_two_files_of_samples_beside_a_header_it_is_said_which_was_taken) {
    const ScratchFolder folder;
    const std::string bytes = nifti([](std::string& h) { put_at(h, 344, "ni1"); });
    put_bytes(folder / "a.hdr", bytes.substr(0, 348));
    put_bytes(folder / "a.img", bytes);
    EXPECT_FALSE(contains(all_notes(read_volume(folder / "a.hdr")), "beside it"));
    put_gzip(folder / "a.img.gz", bytes);
    EXPECT_TRUE(contains(all_notes(read_volume(folder / "a.hdr")),
                         "both 'a.img' and 'a.img.gz' are beside it: 'a.img' was taken"));
}

TEST(nifti, whether_it_is_packed_is_seen_from_its_bytes_and_not_from_its_name) {
    const ScratchFolder folder;
    put_gzip(folder / "packed.nii", nifti([](std::string&) {}));
    put_bytes(folder / "plain.nii.gz", nifti([](std::string&) {}));
    for (const char* name : {"packed.nii", "plain.nii.gz"}) {
        const VolumeFile file = read_volume(folder / name);
        EXPECT_EQ(file.format, "NIfTI");
        EXPECT_EQ(file.volume.sample({1, 2, 3}), 23) << name;
    }
}

TEST(nifti, samples_that_are_not_finite_become_the_least_one_and_are_counted) {
    const ScratchFolder folder;
    std::string bytes = nifti(
        [](std::string& h) { put_at(h, 70, little<std::int16_t>(16) + little<std::int16_t>(32)); });
    bytes.resize(352);
    for (int i = 0; i < 24; ++i) {
        bytes += little(i == 3   ? not_a_number
                        : i == 5 ? infinite
                        : i == 7 ? -infinite
                                 : 100.0F + i);
    }
    const VolumeFile file = read_nifti(folder, bytes);
    EXPECT_EQ(file.volume.minimum(), 100);
    EXPECT_EQ(file.volume.maximum(), 123);
    EXPECT_EQ(file.volume.sample({1, 1, 0}), 100);
    EXPECT_TRUE(contains(all_notes(file), "3 samples were not finite")) << all_notes(file);
}

TEST(nifti, numbers_beyond_float32_are_counted_with_those_that_are_not_finite) {
    const ScratchFolder folder;
    std::string bytes = nifti(
        [](std::string& h) { put_at(h, 70, little<std::int16_t>(64) + little<std::int16_t>(64)); });
    bytes.resize(352);
    for (int i = 0; i < 24; ++i) bytes += little(i == 3 ? 1e300 : i == 5 ? -1e39 : 100.0 + i);
    const VolumeFile file = read_nifti(folder, bytes);
    EXPECT_EQ(file.volume.minimum(), 100);
    EXPECT_EQ(file.volume.maximum(), 123);
    EXPECT_TRUE(contains(all_notes(file), "2 samples were not finite (NaN, infinity or beyond "));
}

TEST(nifti, sizes_and_bits_that_a_writer_left_at_0_are_those_of_the_reference_library) {
    const ScratchFolder folder;
    const VolumeFile file =
        read_nifti(folder, nifti([](std::string& h) {
                       put_at(h, 40, little<std::int16_t>(5));  // axes
                       put_at(h, 48, little<std::int16_t>(0) + little<std::int16_t>(0));
                       put_at(h, 72, little<std::int16_t>(0));  // bitpix
                   }));
    EXPECT_EQ(file.volume.geometry().size, Index3(2, 3, 4));
    EXPECT_EQ(file.time_steps, 1);
    EXPECT_EQ(file.volume.sample({1, 2, 3}), 23);
}

TEST(nifti, of_two_transforms_that_disagree_the_sform_is_taken_and_that_is_said) {
    const ScratchFolder folder;
    const auto read = [&](const std::array<float, 12>& sform) {
        return read_nifti(folder, nifti([&](std::string& h) {
                              put_pixdim(h, 1, 1, 1);
                              put_offset(h, 10, 20, 30);
                              put_transform(h, sform);
                              put_codes(h, 1, 2);
                          }));
    };
    const VolumeFile same = read({1, 0, 0, 10, 0, 1, 0, 20, 0, 0, 1, 30});
    EXPECT_EQ(all_notes(same), "");
    const VolumeFile moved = read({1, 0, 0, 10, 0, 1, 0, 25, 0, 0, 1, 30});
    EXPECT_EQ(moved.volume.geometry().origin, Vec3(-10, -25, 30));
    EXPECT_TRUE(contains(all_notes(moved), "5 mm apart): the sform was taken")) << all_notes(moved);
    const VolumeFile turned = read({0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30});
    EXPECT_EQ(turned.volume.geometry().direction.col(0), Vec3(0, -1, 0));
    EXPECT_TRUE(contains(all_notes(turned), "the sform was taken"));
    const VolumeFile longer = read({1, 0, 0, 10, 0, 1, 0, 20, 0, 0, 2, 30});
    EXPECT_EQ(longer.volume.geometry().spacing, Vec3(1, 1, 2));
    EXPECT_TRUE(contains(all_notes(longer), "two spacings along axis 3"));
}

TEST(nifti, a_sheared_sform_gives_way_to_the_qform_or_is_refused) {
    const ScratchFolder folder;
    const auto sheared = [](std::int16_t qform) {
        return nifti([&](std::string& h) {
            put_offset(h, 10, 20, 30);
            put_transform(h, {1, 0.1F, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3});
            put_codes(h, qform, 1);
        });
    };
    const VolumeFile file = read_nifti(folder, sheared(1));
    EXPECT_EQ(file.volume.geometry().origin, Vec3(-10, -20, 30));
    EXPECT_TRUE(contains(all_notes(file), "sheared")) << all_notes(file);
    put_bytes(folder / "a.nii", sheared(0));
    EXPECT_TRUE(contains(refusal(folder / "a.nii"), "sheared"));
}

/// Half turns around axes whose numbers are rounded in the header.
TEST(nifti, a_half_turn_is_none_of_another_angle) {
    const ScratchFolder folder;
    std::mt19937 random(5);
    for (int i = 0; i < 40; ++i) {
        Vec3 axis(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
        if (i == 0) axis = Vec3(1, 1, 0);
        axis.normalize();
        const VolumeFile file = read_nifti(folder, nifti([&](std::string& h) {
                                               for (Eigen::Index a = 0; a < 3; ++a) {
                                                   put_at(h, 256 + 4 * std::size_t(a),
                                                          little(static_cast<float>(axis[a])));
                                               }
                                           }));
        const Mat3 turn = 2 * axis * axis.transpose() - Mat3::Identity();
        const Mat3 expected = Vec3(-1, -1, 1).asDiagonal() * turn;
        EXPECT_LT((file.volume.geometry().direction - expected).cwiseAbs().maxCoeff(), 1e-6) << i;
    }
}

TEST(nifti, a_quaternion_and_its_handedness_place_the_axes) {
    const ScratchFolder folder;
    for (const float handed : {1.0F, 0.0F, -1.0F}) {
        const VolumeFile file =
            read_nifti(folder, nifti([&](std::string& h) {
                           put_at(h, 76, little(handed));
                           // A quarter turn around z: x goes to y.
                           put_at(h, 256, little(0.0F) + little(0.0F) + little(std::sqrt(0.5F)));
                       }));
        Mat3 expected;
        expected << 0, 1, 0, -1, 0, 0, 0, 0, handed < 0 ? -1 : 1;
        EXPECT_TRUE(file.volume.geometry().direction.isApprox(expected, 1e-6))
            << file.volume.geometry().direction;
    }
    put_bytes(folder / "a.nii", nifti([](std::string& h) {
                  put_at(h, 256, little(0.9F) + little(0.9F) + little(0.0F));
              }));
    EXPECT_TRUE(contains(refusal(folder / "a.nii"), "no rotation"));
}

}  // namespace
}  // namespace palpate::io::test
