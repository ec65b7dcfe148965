// Grids of NRRD and MetaImage headers: spacings, axis mins and maxs, centerings, units and spaces
// in every combination, and headers of any length.
#include <zlib.h>

#include <optional>

#include "palpate/io/orientation.hpp"
#include "palpate/io/raw_options.hpp"
#include "volume_support.hpp"

namespace palpate::io::test {
namespace {

const char* const plain = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nencoding: raw\n";

VolumeFile read_text(const ScratchFolder& folder, const std::string& name,
                     const std::string& header) {
    put_bytes(folder / name, header + std::string(24, 'x'));
    return read_volume(folder / name);
}

VolumeFile read_nrrd(const ScratchFolder& folder, const std::string& fields) {
    return read_text(folder, "a.nrrd", plain + fields + "\n");
}

TEST(nrrd, spacings_and_ends_of_axes_tell_each_other_for_every_centering) {
    const ScratchFolder folder;
    int both = 0;
    for (const char* field : {"centers", "centerings"}) {
        for (const std::string center : {"node", "cell", "???", "none", ""}) {
            for (int given = 0; given < 8; ++given) {
                const bool spacings = given & 1, minima = given & 2, maxima = given & 4;
                const bool node = center == "node";
                // The true grid: spacings 2 2 3 and a first end at 0 0 10.
                std::string fields;
                if (spacings) fields += "spacings: 2 2 3\n";
                if (minima) fields += "axis mins: 0 0 10\n";
                if (maxima) fields += node ? "axismaxs: 2 4 19\n" : "axis maxs: 4 6 22\n";
                if (!center.empty()) {
                    fields +=
                        std::string(field) + ": " + center + " " + center + " " + center + "\n";
                }
                SCOPED_TRACE(fields);
                const VolumeFile file = read_nrrd(folder, fields);
                const Geometry& g = file.volume.geometry();
                const bool known = spacings || (minima && maxima);
                EXPECT_EQ(g.spacing, known ? Vec3(2, 2, 3) : Vec3::Ones());
                EXPECT_EQ(contains(all_notes(file), "1 mm was taken"), !known);
                if (known) {
                    const Vec3 first = node ? Vec3(0, 0, 10) : Vec3(1, 1, 11.5);
                    EXPECT_EQ(g.origin, minima || maxima ? first : Vec3::Zero());
                } else if (minima) {
                    EXPECT_EQ(g.origin, Vec3(0, 0, 10) + Vec3::Constant(node ? 0 : 0.5));
                }
                EXPECT_EQ(contains(all_notes(file), "centerings"),
                          (minima || maxima) && center != "node" && center != "cell");
                both += known && (minima || maxima);
            }
        }
    }
    EXPECT_EQ(both, 40);
}

TEST(nrrd, units_scale_lengths_and_places_whether_of_axes_or_of_the_space) {
    const ScratchFolder folder;
    struct Unit {
        const char* name;
        double mm;
    };
    for (const Unit x : {Unit{"nm", 1e-6},
                         {"um", 1e-3},
                         {"micron", 1e-3},
                         {"mm", 1},
                         {"cm", 10},
                         {"m", 1000},
                         {"", 1},
                         {"???", 1},
                         {"furlong", 1}}) {
        for (const Unit z : {Unit{"um", 1e-3}, {"mm", 1}}) {
            const std::string units = std::string("\"") + x.name + "\" \"mm\" \"" + z.name + "\"\n";
            SCOPED_TRACE(units);
            const VolumeFile axes = read_nrrd(folder,
                                              "spacings: 2 2 3\naxis mins: 5 6 7\n"
                                              "centers: node node node\nunits: " +
                                                  units);
            const VolumeFile space =
                read_nrrd(folder,
                          "space: LPS\nspace directions: (2,0,0) (0,2,0) (0,0,3)\n"
                          "space origin: (5,6,7)\nspace units: " +
                              units);
            for (const VolumeFile* file : {&axes, &space}) {
                const Geometry& g = file->volume.geometry();
                EXPECT_TRUE(g.spacing.isApprox(Vec3(2 * x.mm, 2, 3 * z.mm), 1e-12));
                EXPECT_TRUE(g.origin.isApprox(Vec3(5 * x.mm, 6, 7 * z.mm), 1e-12));
                EXPECT_EQ(contains(all_notes(*file), "converted to mm"), x.mm != 1 || z.mm != 1);
                EXPECT_EQ(contains(all_notes(*file), "'furlong' is not known"),
                          std::string(x.name) == "furlong");
            }
        }
    }
}

TEST(nrrd, an_axis_without_a_direction_is_at_right_angles_to_the_others) {
    const ScratchFolder folder;
    const VolumeFile one =
        read_nrrd(folder, "space: LPS\nspace directions: (0,2,0) (0,0,3) none\n");
    EXPECT_EQ(one.volume.geometry().spacing, Vec3(2, 3, 1));
    EXPECT_EQ(one.volume.geometry().direction.col(2), Vec3(1, 0, 0));
    EXPECT_TRUE(contains(all_notes(one), "1 mm was taken"));
    const VolumeFile two = read_nrrd(folder, "space: LPS\nspace directions: none (2,0,0) none\n");
    EXPECT_EQ(two.volume.geometry().direction.col(1), Vec3(1, 0, 0));
}

TEST(nrrd, what_is_ignored_is_said) {
    const ScratchFolder folder;
    EXPECT_TRUE(
        contains(all_notes(read_nrrd(folder, "old min: -1000\noldmax: 3000\n")), "quantized"));
    EXPECT_TRUE(contains(all_notes(read_nrrd(folder, "favourite colour: blue\n")),
                         "'favourite colour' is not known"));
    EXPECT_TRUE(contains(all_notes(read_nrrd(folder, "space: scanner-xyz\n")), "'scanner-xyz'"));
    EXPECT_TRUE(
        contains(all_notes(read_nrrd(folder, "space units: \"um\" \"um\" \"um\"\n")), "no space"));
    EXPECT_TRUE(contains(
        all_notes(read_nrrd(folder, "spacings: 1 1 1\naxis mins: 0 0 0\naxis maxs: 9 9 9\n")),
        "spacings were taken"));
}

TEST(nrrd, a_spacing_that_is_not_a_number_is_not_known) {
    const ScratchFolder folder;
    const VolumeFile one = read_nrrd(folder, "spacings: 2 3 nan\n");
    EXPECT_EQ(one.volume.geometry().spacing, Vec3(2, 3, 1));
    EXPECT_FALSE(one.volume.geometry().measured);
    EXPECT_TRUE(contains(all_notes(one), "1 mm was taken")) << all_notes(one);
    const VolumeFile none = read_nrrd(folder, "spacings: NaN NaN NaN\n");
    EXPECT_EQ(none.volume.geometry().spacing, Vec3(1, 1, 1));
    EXPECT_FALSE(none.volume.geometry().measured);
}

TEST(nrrd, a_byte_skip_from_the_end_is_for_samples_that_are_no_text) {
    const ScratchFolder folder;
    const std::string head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nbyte skip: -1\n";
    std::string samples;
    for (char i = 0; i < 24; ++i) samples += i;
    put_gzip(folder / "packed.gz", std::string(10000, 'h') + samples);
    put_bytes(folder / "a.nhdr", head + "encoding: gzip\ndata file: packed.gz\n");
    const VolumeFile packed = read_volume(folder / "a.nhdr");
    for (int i = 0; i < 24; ++i) EXPECT_EQ(packed.volume.sample({i % 2, i / 2 % 3, i / 6}), i);
    EXPECT_EQ(all_notes(packed).find("bytes"), std::string::npos) << all_notes(packed);
    put_gzip(folder / "packed.gz", samples.substr(5));
    EXPECT_TRUE(contains(refusal(folder / "a.nhdr"), "cut off")) << refusal(folder / "a.nhdr");
    put_gzip(folder / "packed.gz", std::string((1 << 26) + 1, 'h') + samples);
    EXPECT_TRUE(contains(refusal(folder / "a.nhdr"), "unpacks to more"));
    put_bytes(folder / "a.nhdr", head + "encoding: text\ndata file: plain\n");
    EXPECT_TRUE(contains(refusal(folder / "a.nhdr"), "byte skip of -1"));
    put_bytes(folder / "plain", "header" + samples);
    put_bytes(folder / "a.nhdr", head + "encoding: raw\ndata file: plain\n");
    EXPECT_EQ(read_volume(folder / "a.nhdr").volume.sample({1, 0, 0}), 1);
    // A file that is cut off has no samples in its header.
    put_bytes(folder / "a.nrrd", head + "encoding: raw\n\n" + samples);
    EXPECT_EQ(read_volume(folder / "a.nrrd").volume.sample({1, 0, 0}), 1);
    put_bytes(folder / "a.nrrd", head + "encoding: raw\n\n" + samples.substr(5));
    EXPECT_TRUE(contains(refusal(folder / "a.nrrd"), "cut off")) << refusal(folder / "a.nrrd");
}

TEST(meta_image, units_scale_spacing_and_origin) {
    const ScratchFolder folder;
    const std::string head =
        "NDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\nElementSpacing = 2 3 4\n"
        "Offset = 5 6 7\n";
    for (const auto& [unit, mm] : {std::pair{"mm", 1.0}, {"um", 1e-3}, {"cm", 10.0}, {"?", 1.0}}) {
        const VolumeFile file = read_text(
            folder, "a.mha", head + "DistanceUnits = " + unit + "\nElementDataFile = LOCAL\n");
        const Geometry& g = file.volume.geometry();
        EXPECT_TRUE(g.spacing.isApprox(mm * Vec3(2, 3, 4), 1e-12)) << unit;
        EXPECT_TRUE(g.origin.isApprox(mm * Vec3(5, 6, 7), 1e-12)) << unit;
        EXPECT_EQ(contains(all_notes(file), "converted to mm"), mm != 1);
    }
}

TEST(meta_image, a_header_may_have_fields_for_each_of_thousands_of_frames) {
    const ScratchFolder folder;
    std::string head = "NDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\n";
    for (int frame = 0; frame < 5000; ++frame) {
        head += "Seq_Frame" + std::to_string(frame) + "_ProbeToTrackerTransform = 1 0 0 0 0 1\n";
    }
    const VolumeFile file =
        read_text(folder, "a.mha", head + "ElementSpacing = 1 1 2\nElementDataFile = LOCAL\n");
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(1, 1, 2));
}

TEST(meta_image, a_map_of_values_that_is_ignored_is_said) {
    const ScratchFolder folder;
    const std::string head = "NDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\n";
    const std::string end = "ElementDataFile = LOCAL\n";
    const auto said = [&](const std::string& field) {
        return contains(all_notes(read_text(folder, "a.mha", head + field + "\n" + end)),
                        "ElementToIntensityFunction");
    };
    EXPECT_TRUE(said("ElementToIntensityFunctionSlope = 2"));
    EXPECT_TRUE(said("ElementToIntensityFunctionOffset = -1024"));
    EXPECT_FALSE(said("ElementToIntensityFunctionSlope = 1"));
}

TEST(orientation, of_an_oblique_grid_names_three_different_sides) {
    // nibabel's aff2axcodes() gives S, L, P.
    Geometry grid;
    grid.direction << 0.656692, 0.676962, -0.332383, -0.360389, 0.668844, 0.650205, 0.662477,
        -0.307197, 0.683194;
    EXPECT_EQ(orientation_of(grid), "SLP");
    std::mt19937 random(5);
    for (int i = 0; i < 200; ++i) {
        grid = random_geometry(random, true, i % 2 == 0);
        EXPECT_NO_THROW((void)direction_from(orientation_of(grid))) << "\n" << grid.direction;
    }
}

TEST(volume_numbers, may_begin_with_one_plus_sign) {
    const ScratchFolder folder;
    const auto read_with = [&](const std::string& spacing, const std::string& name) {
        const bool is_nrrd = name.ends_with(".nrrd");
        put_bytes(folder / name,
                  is_nrrd ? "NRRD0004\ntype: uint8\ndimension: 3\nsizes: +2 2 2\nspacings: 1 1 " +
                                spacing + "\nencoding: raw\n\n12345678"
                          : "NDims = 3\nDimSize = 2 2 +2\nElementSpacing = 1 1 " + spacing +
                                "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n12345678");
        return folder / name;
    };
    for (const std::string name : {"a.nrrd", "a.mha"}) {
        EXPECT_EQ(read_volume(read_with("+2.5", name)).volume.geometry().spacing[2], 2.5);
        for (const char* const wrong : {"+-2.5", "++2.5", "+", "+ 2.5"}) {
            EXPECT_TRUE(contains(refusal(read_with(wrong, name)), "is not a list of numbers"))
                << wrong;
        }
    }
    EXPECT_EQ(spacing_from("+1,2,+0.5"), Vec3(1, 2, 0.5));
    for (const char* const wrong : {"+-1,2,3", "++1,2,3", "1,+,3"}) {
        EXPECT_THROW((void)spacing_from(wrong), std::invalid_argument) << wrong;
    }
}

}  // namespace
}  // namespace palpate::io::test
