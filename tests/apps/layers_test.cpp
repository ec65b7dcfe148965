// Layers from the command line: --layers, --labels, live commands, and the columns of a trace.
#include <algorithm>

#include "apps/program.hpp"
#include "palpate/io/trace.hpp"
#include "support/recordings.hpp"

namespace palpate::app::test {
namespace {

using support::put_bytes;

/// With a motion along z into the middle of the sphere (density 1, at 0) and back.
struct StrokeFolder : ScratchFolder {
    StrokeFolder() {
        std::string text = "t,x,y,z\n";
        for (int i = 0; i <= 200; ++i) {
            const double z = -14.5 + 0.15 * std::min(i, 200 - i);
            text += std::to_string(i * 0.001) + ",0.1,-0.1," + std::to_string(z) + "\n";
        }
        put_bytes(*this / "t.csv", text);
    }
};

const char* two_layers = R"({"palpate_layers": 1, "units": "%", "layers": [
    {"name": "shell", "level": 20, "stiffness": 0.5, "puncture_force": 0.5},
    {"name": "core, inner", "level": 60, "stiffness": 1, "puncture_force": "inf"}]})";

struct Row {
    std::string layer, inside;
    double force = 0;
};

/// The last two columns and the force along z.
std::vector<Row> rows_of(const std::filesystem::path& path) {
    const std::string text = io::read_text(path), name = path.string();
    io::CsvReader csv(text, name);
    const auto layer = csv.column("layer"), inside = csv.column("inside"),
               force = csv.column("force_z");
    std::vector<Row> rows;
    while (csv.next()) {
        rows.push_back(
            {std::string(csv.cell(layer)), std::string(csv.cell(inside)), csv.number(force)});
    }
    return rows;
}

std::vector<std::string> story_of(const std::vector<Row>& rows) {
    std::vector<std::string> story;
    for (const Row& row : rows) {
        const std::string now = row.layer + "|" + row.inside;
        if (story.empty() || story.back() != now) story.push_back(now);
    }
    return story;
}

const std::string stroke = "replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv ";

TEST(LayersOption, names_in_a_trace_what_is_touched_and_what_the_hand_is_in) {
    const StrokeFolder folder;
    put_bytes(folder / "two.json", two_layers);
    succeeds(folder, stroke + "--layers two.json");
    const std::vector<Row> rows = rows_of(folder / "a.csv");
    const std::vector<std::string> begin{"|", "shell|", "|shell", "core_ inner|shell"};
    const std::vector<std::string> story = story_of(rows);
    ASSERT_GE(story.size(), 4U);
    EXPECT_TRUE(std::equal(begin.begin(), begin.end(), story.begin()));
    EXPECT_EQ(story.back(), "|") << "and out again";
    const auto most = std::ranges::max(
        rows, {}, [](const Row& r) { return r.layer == "shell" ? std::abs(r.force) : 0; });
    EXPECT_LT(std::abs(most.force), 0.5 + 1e-9);
    EXPECT_GT(std::abs(most.force), 0.4);
    // Readers of traces read these as well.
    EXPECT_EQ(io::read_trace(folder / "a.csv").size(), rows.size());
}

TEST(LayersOption, refuses_what_does_not_fit) {
    const StrokeFolder folder;
    put_bytes(folder / "two.json", two_layers);
    put_bytes(folder / "bad.json", "{\"palpate_layers\": 1, \"layers\": [{\"nam\": 1}]}");
    const auto expect = [&](const std::string& options, int status, const std::string& words) {
        const Outcome done = palpate(folder, stroke + options);
        EXPECT_EQ(done.status, status) << options << ": " << done.err;
        EXPECT_TRUE(contains(done.err, words)) << options << ": " << done.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
    };
    expect("--layers none-such", 3, "use one of ct-bone-drilling");
    expect("--layers bad.json", 3, "bad.json");
    expect("--layers two.json --isovalue 0.5", 2, "an isovalue does nothing with layers");
    expect("--layers two.json --penetrability threshold", 2, "penetrability does nothing");
    expect("--layers two.json --method paper", 2, "layers need the method exact");
    expect("--layers two.json --solid below", 2, "levels must fall");
    expect("--labels none.nrrd", 3, "none.nrrd");
}

TEST(LayersOption, warns_of_units_that_the_volume_does_not_have) {
    const StrokeFolder folder;
    const Outcome done = succeeds(folder, stroke + "--layers ct-needle");
    EXPECT_TRUE(contains(done.err, "the layers are in HU")) << done.err;
}

/// A slab of label 4 from z = -4 on, called "plate", as 3D Slicer writes it.
void put_segmentation(const ScratchFolder& folder) {
    std::string text =
        "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 12 12 12\n"
        "space directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (-12,-12,-12)\nencoding: raw\n"
        "Segment0_ID:=s\nSegment0_Name:=plate\nSegment0_LabelValue:=4\nSegment0_Layer:=0\n"
        "Segment0_Color:=0.2 0.4 0.6\n\n";
    for (int i = 0; i < 12 * 12 * 12; ++i) text += i / 144 >= 4 ? '\4' : '\0';
    put_bytes(folder / "s.seg.nrrd", text);
}

TEST(LabelsOption, feels_the_segments_of_a_segmentation_by_name) {
    const StrokeFolder folder;
    put_segmentation(folder);
    succeeds(folder, stroke + "--labels s.seg.nrrd");
    const std::vector<std::string> story = story_of(rows_of(folder / "a.csv"));
    ASSERT_GE(story.size(), 3U);
    EXPECT_EQ(story[1], "plate|");
    EXPECT_EQ(story[2], "|plate");
    put_bytes(folder / "named.json",
              "{\"palpate_layers\": 1, \"layers\": [{\"name\": \"plate\", \"level\": 0}]}");
    succeeds(folder, stroke + "--labels s.seg.nrrd --layers named.json");
    EXPECT_EQ(story_of(rows_of(folder / "a.csv")).size(), 3U)
        << "without a puncture force it holds";
    put_bytes(folder / "other.json",
              "{\"palpate_layers\": 1, \"layers\": [{\"name\": \"bolt\", \"level\": 0}]}");
    expect_failure(palpate(folder, stroke + "--labels s.seg.nrrd --layers other.json"), 2,
                   "has no label 'bolt'; it has plate");
}

/// The same place told by the index alone, in a file that has no orientation: z falls there.
void put_bare_labels(const ScratchFolder& folder) {
    std::string text =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 24 24\nspacings: 1 1 1\nencoding: "
        "raw\n\n";
    for (int i = 0; i < 24 * 24 * 24; ++i) text += i / 576 < 12 ? '\4' : '\0';
    put_bytes(folder / "bare.nrrd", text);
}

TEST(LabelsOption, lie_beside_a_volume_whose_orientation_is_given) {
    const ScratchFolder folder;
    put_bare_labels(folder);
    put_bytes(folder / "t.csv", "t,x,y,z\n0,-12,12,4\n0.1,-12,12,-1\n");
    const std::string felt =
        "replay bare.nrrd --trajectory t.csv -o a.csv --labels bare.nrrd --orientation ";
    const Outcome done = succeeds(folder, felt + "RPI");
    EXPECT_FALSE(contains(done.err, "warning")) << done.err;
    EXPECT_EQ(story_of(rows_of(folder / "a.csv")).at(1), "label 4|") << "below z = 0";
}

TEST(LabelsOption, warns_where_only_one_file_has_an_orientation) {
    const ScratchFolder folder;
    put_bare_labels(folder);
    put_segmentation(folder);
    put_bytes(folder / "t.csv", "t,x,y,z\n0,0,0,0\n0.1,1,1,1\n");
    for (const auto& [command, lacks] :
         {std::pair("replay s.seg.nrrd -o a.csv --trajectory t.csv", "bare.nrrd does not give"),
          std::pair("touch s.seg.nrrd --unpaced --seconds 0.1", "bare.nrrd does not give")}) {
        const Outcome done = succeeds(folder, std::string(command) + " --labels bare.nrrd");
        EXPECT_TRUE(contains(done.err, std::string(lacks) + " its orientation")) << done.err;
    }
    const Outcome other =
        palpate(folder, "replay bare.nrrd -o a.csv --trajectory t.csv --labels s.seg.nrrd");
    EXPECT_TRUE(contains(other.err, "bare.nrrd does not give its orientation")) << other.err;
    const Outcome both =
        palpate(folder, "replay bare.nrrd -o a.csv --trajectory t.csv --labels bare.nrrd");
    EXPECT_FALSE(contains(both.err, "orientation")) << both.err;
}

/// The levels of two.json and the label of s.seg.nrrd.
void put_mixed(const ScratchFolder& folder) {
    std::string text = two_layers;
    const auto end = text.rfind(']');
    text.insert(end, ", {\"name\": \"plate\", \"label\": 4, \"puncture_force\": 0.4}");
    put_bytes(folder / "mixed.json", text);
}

TEST(LabelsOption, count_in_the_memory_of_the_program) {
    const ScratchFolder folder;
    const std::string convert = "convert -q synthetic:sphere:";
    succeeds(folder, convert + "32x32x32 ball.zarr");
    succeeds(folder, convert + "230x220x220 large.nrrd --compress");
    succeeds(folder, convert + "230x220x220 large.zarr");
    const std::string touch =
        "touch ball.zarr --device simulated:hand=hold --unpaced --seconds 0.01 --memory 40MB ";
    for (const char* labels : {"large.nrrd", "large.zarr"}) {
        expect_failure(palpate(folder, touch + "--labels " + labels), 3, "allow more memory");
    }
}

TEST(LabelsOption, feels_levels_where_no_label_is_given) {
    const StrokeFolder folder;
    put_segmentation(folder);
    put_mixed(folder);
    expect_failure(palpate(folder, stroke + "--layers mixed.json"), 2, "name a label volume");
    succeeds(folder, stroke + "--labels s.seg.nrrd --layers mixed.json");
    const std::vector<std::string> story = story_of(rows_of(folder / "a.csv"));
    const auto has = [&](const char* what) { return std::ranges::count(story, what) > 0; };
    EXPECT_TRUE(has("shell|"));
    EXPECT_TRUE(has("|shell"));
    EXPECT_TRUE(has("|plate")) << "alone: labels do not nest";
    std::string all;
    for (const std::string& part : story) all += part + "\n";
    EXPECT_EQ(all.find("+plate"), std::string::npos) << all;
}

TEST(LayersOption, are_recorded_and_replayed_bit_for_bit) {
    const ScratchFolder folder;
    put_bytes(folder / "two.json", two_layers);
    put_segmentation(folder);
    put_mixed(folder);
    put_bytes(folder / "c.txt", "0.3 layers off\n0.5 layers microscopy\n0.9 layers two.json\n");
    for (const std::string from :
         {"--layers two.json", "--labels s.seg.nrrd", "--labels s.seg.nrrd --layers mixed.json"}) {
        succeeds(folder,
                 "touch synthetic:sphere:32x32x32 --unpaced --device simulated:hand=press "
                 "--seconds 1.5 --commands c.txt --record r.csv " +
                     from);
        const Outcome valid = succeeds(folder, "replay r.csv --validate");
        EXPECT_TRUE(contains(valid.out, "the same bit for bit")) << valid.out;
        std::filesystem::remove(folder / "r.csv");
    }
}

}  // namespace
}  // namespace palpate::app::test
