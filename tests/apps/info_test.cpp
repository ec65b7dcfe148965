// palpate info: its output for synthetic and for real volumes.
#include <nlohmann/json.hpp>

#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

using nlohmann::json;

json info(const ScratchFolder& folder, const Words& words) {
    const Outcome outcome = succeeds(folder, Words{"info", "--json"} + words);
    return json::parse(outcome.out, nullptr, false);
}

TEST(Info, tells_size_type_origin_and_range_of_a_synthetic_volume) {
    const ScratchFolder folder;
    const json j = info(folder, {"synthetic:cylinder"});
    EXPECT_EQ(j["size"], json({100, 100, 30}));
    EXPECT_EQ(j["type"], "float32");
    EXPECT_EQ(j["spacing_mm"], json({1.0, 1.0, 1.0}));
    EXPECT_EQ(j["origin_mm"], json({-49.5, -49.5, -14.5}));
    EXPECT_EQ(j["orientation"], nullptr) << "it is no body";
    EXPECT_EQ(j["spacing_known"], true);
    EXPECT_EQ(j["memory_bytes"], 4 * 100 * 100 * 30);
    EXPECT_EQ(j["time_steps"], 1);
    EXPECT_EQ(j["minimum"], 0);
    std::int64_t sum = 0;
    for (const auto& count : j["histogram"]["counts"]) sum += count.get<std::int64_t>();
    EXPECT_EQ(sum, 100 * 100 * 30);
}

TEST(Info, suggests_isovalues_inside_the_range_of_every_scene) {
    const ScratchFolder folder;
    for (const std::string name : {"cylinder", "sphere", "torus", "plane", "shell",
                                   "marschner-lobb", "shepp-logan", "noise"}) {
        for (const std::string type : {"uint8", "int16", "uint16", "float32"}) {
            const json j = info(folder, {"synthetic:" + name + ":20x21x22", "--type", type});
            EXPECT_EQ(j["type"], type);
            EXPECT_GE(j["suggested_isovalues"].size(), 1U) << name << " " << type;
            for (const double level : j["suggested_isovalues"]) {
                EXPECT_GT(level, j["minimum"].get<double>()) << name << " " << type;
                EXPECT_LT(level, j["maximum"].get<double>()) << name << " " << type;
            }
        }
    }
}

TEST(Info, suggests_the_middle_for_a_mask) {
    const ScratchFolder folder;
    support::put_bytes(folder / "mask.raw", std::string("\0\0\1\1\1\0\0\1", 8));
    support::put_bytes(folder / "full.raw", std::string("\0\0\xFF\xFF\xFF\0\0\xFF", 8));
    const Words layout{"--dims", "2x2x2", "--type", "uint8"};
    EXPECT_EQ(info(folder, Words{"mask.raw"} + layout)["suggested_isovalues"], json({0.5}));
    EXPECT_EQ(info(folder, Words{"full.raw"} + layout)["suggested_isovalues"], json({127.5}));
}

TEST(Info, suggests_to_dequantize_where_terraces_are_wide_and_says_why) {
    const ScratchFolder folder;
    const json ramp =
        info(folder, words_of("synthetic:cylinder:100x100x30 --type uint8"))["terraces"];
    EXPECT_EQ(ramp["level"], 1);
    EXPECT_TRUE(contains(ramp["suggestion"], "--dequantize: rounding to levels of 1")) << ramp;
    EXPECT_TRUE(contains(palpate(folder, "info synthetic:cylinder:100x100x30 --type uint8").out,
                         "terraces     try --dequantize: rounding"));
    support::put_bytes(folder / "mask.raw", std::string("\0\0\1\1\1\0\0\1", 8));
    const json mask = info(folder, words_of("mask.raw --dims 2x2x2 --type uint8"))["terraces"];
    EXPECT_TRUE(contains(mask["suggestion"], "stair steps")) << mask;
    EXPECT_FALSE(
        info(folder, words_of("synthetic:noise:20x20x20 --type uint8"))["terraces"].contains(
            "suggestion"));
    EXPECT_TRUE(
        info(folder, words_of("synthetic:noise:42x42x42 --type float32"))["terraces"].is_null());
}

TEST(Info, describes_the_volume_once_it_is_dequantized) {
    const ScratchFolder folder;
    const Words words = words_of("--dequantize=3 synthetic:torus:20x20x10 --type uint8");
    EXPECT_EQ(info(folder, words)["type"], "float32");
    // The word after the option is the volume.
    EXPECT_EQ(info(folder, words_of("--dequantize synthetic:torus:20x20x10"))["size"],
              json({20, 20, 10}));
    for (const std::string wrong : {"--dequantize=-1", "--dequantize=1001", "--dequantize=x",
                                    "--dequantize=1.5", "--dequantize="}) {
        const Outcome outcome = palpate(folder, Words{"info", "synthetic:torus", wrong});
        EXPECT_EQ(outcome.status, 2) << wrong;
        EXPECT_TRUE(contains(outcome.err, "--dequantize")) << outcome.err;
    }
}

TEST(Info, has_nothing_to_suggest_for_constant_data) {
    const ScratchFolder folder;
    support::put_bytes(folder / "one.raw", std::string(8, '\7'));
    EXPECT_EQ(info(folder, words_of("one.raw --dims 2x2x2 --type uint8"))["suggested_isovalues"],
              json::array());
    const Outcome text = succeeds(folder, "info one.raw --dims 2x2x2 --type uint8");
    EXPECT_TRUE(contains(text.out, "the data are constant")) << text.out;
    succeeds(folder, "info synthetic:noise:1x1x1");
}

TEST(Info, prints_the_same_facts_as_text) {
    const ScratchFolder folder;
    const Outcome text = succeeds(folder, "info synthetic:cylinder");
    EXPECT_EQ(text.err, "");
    for (const std::string part :
         {"synthetic:cylinder\n", "100 x 100 x 30 samples, float32", "1 x 1 x 1 mm",
          "100 x 100 x 30 mm", "not known: the file gives none (--orientation)", "1.2 MB",
          "isovalues    try ", "histogram"}) {
        EXPECT_TRUE(contains(text.out, part)) << part << " is not in\n" << text.out;
    }
}

TEST(Info, takes_orientation_and_spacing_from_the_command_line_where_the_file_has_none) {
    const ScratchFolder folder;
    support::put_bytes(folder / "a.raw", std::string(8, '\1') + std::string(16, '\2'));
    const Words raw{"a.raw", "--dims", "2x3x4", "--type", "uint8"};
    const json lacks = info(folder, raw);
    EXPECT_EQ(lacks["orientation"], nullptr);
    EXPECT_EQ(lacks["spacing_known"], false);
    const Outcome text = palpate(folder, Words{"info"} + raw);
    EXPECT_TRUE(contains(text.out, "1 x 1 x 1 mm, assumed: the file gives none (--spacing)"));
    const json given = info(folder, raw + Words{"--orientation", "LIA", "--spacing", "1,1,2"});
    EXPECT_EQ(given["orientation"], "L I A");
    EXPECT_EQ(given["spacing_known"], true);
    EXPECT_EQ(given["direction"], json({{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}));
    expect_failure(palpate(folder, Words{"info"} + raw + Words{"--orientation", "LRA"}), 2,
                   "orientation LRA: three letters are needed");
    const Outcome made = palpate(folder, "info synthetic:sphere --orientation LPS");
    EXPECT_TRUE(contains(made.err, "orientation are for files")) << made.err;
    // Unknown facts stay unknown in the converted file.
    for (const std::string out : {"a.nrrd", "a.mha", "a.zarr"}) {
        ASSERT_EQ(palpate(folder, Words{"convert"} + raw + Words{out}).status, 0) << out;
        EXPECT_EQ(info(folder, {out})["orientation"], nullptr) << out;
        const json same = info(folder, {out, "--orientation", "LPS", "--spacing", "1,1,1"});
        EXPECT_EQ(same["orientation"], "L P S") << out << " has these axes by chance";
        EXPECT_EQ(same["spacing_known"], true) << out;
        const std::string known = "known-" + out;
        const Words all = Words{"convert"} + raw + Words{"--orientation", "RAS", known};
        ASSERT_EQ(palpate(folder, all).status, 0) << out;
        EXPECT_EQ(info(folder, {known})["orientation"], "R A S") << out;
    }
}

TEST(Info, accepts_names_with_blanks_quotes_and_bytes_that_are_not_text) {
    const ScratchFolder folder;
    for (const std::string name : {"a b.raw", "it's \"q\".raw",
                                   "b\xFF"
                                   "d.raw",
                                   "-dash.raw"}) {
        support::put_bytes(folder / name, std::string(8, '\7'));
        const json j = info(folder, {"./" + name, "--dims", "2x2x2", "--type", "uint8"});
        EXPECT_EQ(j["size"], json({2, 2, 2})) << name;
    }
}

struct Known {
    std::string name;
    json size;
    std::string type;
    double minimum, maximum;
    std::vector<double> spacing;
    json orientation;
    friend std::ostream& operator<<(std::ostream& out, const Known& known) {
        return out << known.name;
    }
};

class RealVolume : public testing::TestWithParam<Known> {};

TEST_P(RealVolume, has_the_values_that_its_source_gives) {
    const Known& known = GetParam();
    SKIP_WITHOUT(known.name);
    const ScratchFolder folder;
    const json j = info(folder, {data_file(known.name).string()});
    EXPECT_EQ(j["size"], known.size);
    EXPECT_EQ(j["type"], known.type);
    EXPECT_EQ(j["minimum"], known.minimum);
    EXPECT_EQ(j["maximum"], known.maximum);
    EXPECT_EQ(j["orientation"], known.orientation);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(j["spacing_mm"][a], known.spacing[a], 1e-5);
    const int bytes = known.type == "uint8" ? 1 : 2;
    EXPECT_EQ(j["memory_bytes"], known.size[0].get<int>() * known.size[1].get<int>() *
                                     known.size[2].get<int>() * bytes);
}

INSTANTIATE_TEST_SUITE_P(
    Info, RealVolume,
    testing::Values(
        Known{"lobster.nrrd", {301, 324, 56}, "uint8", 0, 255, {1, 1, 1.4}, nullptr},
        Known{"orange.nrrd", {256, 256, 64}, "uint8", 0, 228, {0.390625, 0.390625, 1}, nullptr},
        Known{"cthead_unc.nrrd", {256, 256, 113}, "uint16", 0, 3272, {1, 1, 2}, nullptr},
        Known{"anatomical_be.nii", {33, 41, 25}, "int16", -610, 30393, {2, 2, 2}, "L A S"},
        Known{"HeadMRVolume.mhd", {48, 62, 42}, "uint8", 0, 255, {4, 4, 4}, nullptr},
        Known{"dicom_sphere", {86, 86, 63}, "uint16", 0, 3752, {2.23256, 2.23256, 2.2}, "P I R"}));

TEST(Info, the_first_level_suggested_bounds_what_was_scanned) {
    SKIP_WITHOUT("lobster.nrrd");
    SKIP_WITHOUT("cthead_unc.nrrd");
    const ScratchFolder folder;
    const auto first = [&](const char* name) {
        return info(folder, {data_file(name).string()})["suggested_isovalues"][0].get<double>();
    };
    EXPECT_GT(first("lobster.nrrd"), 25) << "not the resin, at 17";
    EXPECT_NEAR(first("cthead_unc.nrrd"), 571.5, 20) << "skin";
}

TEST(Info, reads_the_packed_raw_file_like_the_nrrd) {
    SKIP_WITHOUT("lobster.nrrd");
    SKIP_WITHOUT("lobster_301x324x56_uint8.raw.gz");
    const ScratchFolder folder;
    const json raw = info(folder, Words{data_file("lobster_301x324x56_uint8.raw.gz").string()} +
                                      words_of("--dims 301x324x56 --type uint8 --spacing 1,1,1.4"));
    const json nrrd = info(folder, {data_file("lobster.nrrd").string()});
    EXPECT_EQ(raw["histogram"], nrrd["histogram"]);
    EXPECT_EQ(raw["spacing_mm"], nrrd["spacing_mm"]);
}

TEST(Info, notes_go_to_standard_error_and_quiet_silences_them) {
    SKIP_WITHOUT("fmri_headturn_4d.nrrd");
    const ScratchFolder folder;
    const std::string file = data_file("fmri_headturn_4d.nrrd").string();
    EXPECT_TRUE(contains(palpate(folder, Words{"info", file}).err, "note: "));
    EXPECT_EQ(palpate(folder, Words{"info", file, "--quiet"}).err, "");
    EXPECT_EQ(info(folder, {file, "--time-step", "5"})["time_steps"], 6);
}

}  // namespace
}  // namespace palpate::app::test
