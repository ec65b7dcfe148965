// palpate demo: the files it promises, and none that it does not.
#include "apps/program.hpp"
#include "io/system/leftovers.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/io/trajectory.hpp"
#include "support/png.hpp"

namespace palpate::app::test {
namespace {

const std::string quick = "demo synthetic:sphere:20x20x20 --duration 0.5 --picture 150 ";

bool is_picture(const std::filesystem::path& path) {
    const support::Png png = support::png_from(support::bytes_of(path));
    return png.width > 100 && png.height > 100 && png.colours() > 20;
}

void expect_results(const std::filesystem::path& folder, std::size_t ticks) {
    EXPECT_TRUE(is_picture(folder / "surface.png"));
    EXPECT_EQ(io::read_trajectory(folder / "trajectory.csv").time.size(), ticks);
    EXPECT_EQ(io::read_trace(folder / "trace.csv").size(), ticks);
    EXPECT_TRUE(std::filesystem::exists(folder / "path.csv"));
    const std::string report = support::bytes_of(folder / "report.html");
    // Everything that the report names is there.
    for (const std::string attribute : {"src=\"", "href=\""}) {
        for (auto at = report.find(attribute); at != std::string::npos;
             at = report.find(attribute, at + 1)) {
            const auto begin = at + attribute.size();
            const std::string name = report.substr(begin, report.find('"', begin) - begin);
            EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
        }
    }
    EXPECT_TRUE(contains(report, "surface.png") && contains(report, "trace.csv"));
    if (std::filesystem::exists(folder / "session.png")) {  // where gnuplot is installed
        EXPECT_TRUE(is_picture(folder / "session.png"));
        EXPECT_TRUE(contains(report, "session.png"));
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        EXPECT_FALSE(contains(entry.path().filename().string(), ".part")) << entry.path();
    }
}

TEST(Demo, leaves_its_results_in_a_folder_that_it_names) {
    const ScratchFolder folder;
    const Outcome outcome = succeeds(folder, quick);
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(contains(outcome.out, "Results: palpate-demo")) << outcome.out;
    EXPECT_EQ(folder.names(), std::vector<std::string>{"palpate-demo"});
    expect_results(folder / "palpate-demo", 501);
    int felt = 0;
    for (const auto& row : io::read_trace(folder / "palpate-demo/trace.csv")) {
        felt += row.constrained;
    }
    EXPECT_GT(felt, 50);
}

TEST(Demo, feels_the_sample_volume_if_none_is_named) {
    const ScratchFolder folder;
    const Outcome outcome = succeeds(folder, "demo --duration 1 --picture 150 -o head");
    EXPECT_TRUE(contains(outcome.out, "visible_human_head.nrrd at isovalue 34.5")) << outcome.out;
    expect_results(folder / "head", 1001);
}

TEST(Demo, chooses_the_level_of_a_real_volume) {
    SKIP_WITHOUT("fuel_small.nrrd");
    const ScratchFolder folder;
    succeeds(folder, Words{"demo", data_file("fuel_small.nrrd").string(), "--duration", "1",
                           "--picture", "150", "--motion", "slide", "-o", "my <results> & 'more'"});
    expect_results(folder / "my <results> & 'more'", 1001);
}

TEST(Demo, the_picture_shows_the_surface_and_the_paths_of_hand_and_proxy) {
    const ScratchFolder folder;
    ASSERT_EQ(palpate(folder,
                      "demo synthetic:sphere:20x20x20 --duration 2 --picture 150 --motion "
                      "circle -q -o out")
                  .status,
              0);
    const auto png = support::png_from(support::bytes_of(folder / "out/surface.png"));
    EXPECT_EQ(png.width, 150U);
    EXPECT_EQ(png.height, 120U);
    EXPECT_GT(png.count(support::is_bone), 2000U);
    EXPECT_GT(png.count(support::is_vermilion), 20U);
    EXPECT_GT(png.count(support::is_blue), 5U);
}

TEST(Demo, says_so_if_the_picture_fails_and_leaves_the_other_results) {
    const ScratchFolder folder;
    ::setenv("PALPATE_PICTURE_HELPER", "/bin/false", 1);
    const Outcome outcome = palpate(folder, quick);
    ::unsetenv("PALPATE_PICTURE_HELPER");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(is_one_line(outcome.err)) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "note: the picture could not be drawn")) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "palpate-demo/surface.png"));
    EXPECT_TRUE(std::filesystem::exists(folder / "palpate-demo/trace.csv"));
    const std::string report = support::bytes_of(folder / "palpate-demo/report.html");
    EXPECT_FALSE(contains(report, "surface.png"));
    EXPECT_TRUE(contains(report, "trace.csv"));
}

TEST(Demo, uses_an_existing_folder_and_keeps_other_files) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "out");
    support::put_bytes(folder / "out/mine.txt", "mine");
    // A folder of a run that was killed. No process has such a number.
    const auto left = folder / "out/.palpate-999999999-1.part";
    std::filesystem::create_directory(left);
    support::put_bytes(left / io::temporary_marker, std::string(io::temporary_marker_text));
    support::put_bytes(left / "surface.png", "half");
    succeeds(folder, quick + "-o out -q");
    expect_results(folder / "out", 501);
    succeeds(folder, quick + "-o out -q --rate 100 --motion tap");
    expect_results(folder / "out", 51);
    EXPECT_EQ(support::bytes_of(folder / "out/mine.txt"), "mine");
}

TEST(Demo, a_misspelt_kind_is_no_volume_that_is_missing) {
    const ScratchFolder folder;
    expect_failure(palpate(folder, "demo sculp"), 2, "did you mean demo sculpt?");
    expect_failure(palpate(folder, "demo beatng -q"), 2, "did you mean demo beating?");
    expect_failure(palpate(folder, "demo head.nrrd"), 3, "does not exist");
    EXPECT_TRUE(folder.names().empty());
}

TEST(Demo, never_replaces_what_it_reads) {
    const ScratchFolder folder;
    const std::string ball = "convert synthetic:sphere:20x20x20 -q ";
    for (const std::string name : {"edited.nrrd", "other.nrrd"}) {
        succeeds(folder, ball + name);
    }
    support::put_bytes(folder / "path.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n");
    std::filesystem::copy(folder / "other.nrrd", folder / "animation.png");
    const auto names = folder.names();
    const std::string before = support::bytes_of(folder / "edited.nrrd");
    for (const auto& [words, input] : {std::pair{"sculpt edited.nrrd", "edited.nrrd"},
                                       {"other.nrrd --tool path.csv", "path.csv"},
                                       {"beating --labels animation.png", "animation.png"}}) {
        const Outcome refused = palpate(folder, std::string("demo ") + words + " -i 50% -o .");
        expect_failure(refused, 2, std::string(input) + " is an input");
    }
    EXPECT_EQ(folder.names(), names);
    EXPECT_EQ(support::bytes_of(folder / "edited.nrrd"), before);
    // Other files of its folder may be inputs.
    EXPECT_EQ(palpate(folder, "demo edited.nrrd -i 50% -q --duration 0.1 --picture 64 -o .").status,
              0);
    EXPECT_EQ(support::bytes_of(folder / "edited.nrrd"), before);
}

TEST(Demo, touches_the_level_of_a_store_that_is_asked_for) {
    const ScratchFolder folder;
    succeeds(folder, "convert synthetic:sphere:136x40x40 ball.zarr -q");
    const std::string line = "demo ball.zarr -i 50% --duration 0.05 --picture 64 -q -o out";
    for (const auto& [level, size] : {std::pair{"0", "136 x 40 x 40"}, {"1", "68 x 20 x 20"}}) {
        const Outcome done = succeeds(folder, line + " --coarse-first --level " + level);
        EXPECT_TRUE(contains(done.err, "--coarse-first does nothing")) << done.err;
        const std::string report = support::bytes_of(folder / "out/report.html");
        EXPECT_TRUE(contains(report, size)) << level;
    }
    expect_failure(palpate(folder, line + " --level 0 --memory 100kB"), 3, "more memory");
}

TEST(Demo, traces_have_the_columns_of_a_tool_and_of_layers) {
    const ScratchFolder folder;
    const auto head_with = [&](const std::string& words) {
        const std::string line = "demo synthetic:shepp-logan:32x32x32 --duration 0.1 --picture 64 ";
        EXPECT_EQ(palpate(folder, line + "-q -o out " + words).status, 0) << words;
        const std::string trace = support::bytes_of(folder / "out/trace.csv");
        return trace.substr(0, trace.find('\n'));
    };
    EXPECT_TRUE(head_with("").ends_with(",update_ns"));
    EXPECT_TRUE(head_with("--layers sample-head").ends_with(",update_ns,layer,inside"));
    const std::string tool = head_with("--tool sphere:2");
    EXPECT_TRUE(contains(tool, "proxy_qw") && contains(tool, "torque_x")) << tool;
    EXPECT_TRUE(tool.ends_with(",contacts")) << tool;
}

TEST(Demo, needs_something_to_touch) {
    const ScratchFolder folder;
    for (const std::string kind : {"", "sculpt synthetic:sphere:20x20x20", "beating"}) {
        expect_failure(palpate(folder, "demo " + kind + " -i 1000"), 2, "nothing to touch");
    }
    expect_failure(palpate(folder, "demo --layers sample-head -i 50"), 2, "with layers");
    EXPECT_TRUE(folder.names().empty());
    // Only a corner is solid, past which the hand goes.
    const std::string head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n";
    for (const std::string name : {"f_0.nrrd", "f_1.nrrd"}) {
        support::put_bytes(folder / name, head + '\xff' + std::string(511, '\0'));
    }
    expect_failure(palpate(folder, "demo beating f_%d.nrrd -i 50% -q"), 2, "meets no surface");
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"f_0.nrrd", "f_1.nrrd"}));
}

TEST(Demo, renders_forces_at_any_rate) {
    const ScratchFolder folder;
    succeeds(folder, quick + "-o out -q --rate 20 -k 0.05");
    double most = 0;
    for (const auto& row : io::read_trace(folder / "out/trace.csv")) {
        most = std::max(most, row.force.norm());
    }
    EXPECT_GT(most, 0.01);
}

TEST(Demo, a_folder_that_cannot_be_made_is_an_error) {
    const ScratchFolder folder;
    support::put_bytes(folder / "file", "x");
    for (const std::string name : {"file", "file/inside", "/proc/palpate", "/dev/full/x"}) {
        expect_failure(palpate(folder, quick + "-o " + name), 5, name);
    }
    expect_failure(palpate(folder, words_of(quick) + Words{"-o", ""}), 2, "--output");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"file"});
}

TEST(Demo, reports_show_the_name_of_the_volume_as_text) {
    SKIP_WITHOUT("fuel_small.nrrd");
    const ScratchFolder folder;
    std::filesystem::copy(data_file("fuel_small.nrrd"), folder / "a<b>&c.nrrd");
    ASSERT_EQ(palpate(folder, "demo a<b>&c.nrrd -i 30 --duration 0.2 --picture 120 -o out").status,
              0);
    EXPECT_TRUE(contains(support::bytes_of(folder / "out/report.html"), "a&lt;b&gt;&amp;c.nrrd"));
}

}  // namespace
}  // namespace palpate::app::test
