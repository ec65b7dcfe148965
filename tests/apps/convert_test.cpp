// palpate convert: to OME-Zarr and back, choices, a run that was ended continued, and refusals.
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "palpate/io/volume_file.hpp"

namespace palpate::app::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::bytes_of;
using support::put_bytes;

constexpr const char* small = "synthetic:shepp-logan:24x20x16";
constexpr const char* large = "synthetic:sphere:144x144x144";  // 5832 chunks of 8^3

void expect_done(const Outcome& outcome) {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
}

Volume volume_at(const fs::path& path) {
    return io::read_volume(path).volume;
}

void expect_same(const Volume& one, const Volume& other) {
    ASSERT_TRUE(one.geometry() == other.geometry());
    ASSERT_EQ(one.type(), other.type());
    EXPECT_EQ(std::memcmp(one.data(), other.data(), one.bytes()), 0);
}

/// Regular files in a folder and below.
int files_in(const fs::path& folder) {
    std::error_code error;
    int count = 0;
    for (fs::recursive_directory_iterator entry(folder, error), end; entry != end && !error;
         entry.increment(error)) {
        count += entry->is_regular_file(error) ? 1 : 0;
    }
    return count;
}

TEST(Convert, to_ome_zarr_and_back_gives_the_same_file_in_either_version_and_compression) {
    const ScratchFolder folder;
    expect_done(palpate(folder, std::string("convert -q ") + small + " direct.nrrd"));
    const Volume direct = volume_at(folder / "direct.nrrd");
    for (const std::string options :
         {"--ome-version 0.4 --compression none", "--ome-version 0.4 --compression blosc",
          "--ome-version 0.5 --compression gzip", "--chunk 8 --threads 3"}) {
        SCOPED_TRACE(options);
        expect_done(palpate(folder, "convert -q direct.nrrd a.zarr " + options));
        expect_done(palpate(folder, "convert -q a.zarr back.nrrd"));
        expect_same(volume_at(folder / "back.nrrd"), direct);
        fs::remove_all(folder / "a.zarr");
        fs::remove(folder / "back.nrrd");
    }
}

TEST(Convert, a_summary_is_printed_as_text_or_json_and_nothing_when_quiet) {
    const ScratchFolder folder;
    const Outcome as_json =
        palpate(folder, std::string("convert --json --chunk 8 ") + small + " a.zarr");
    expect_done(as_json);
    const json summary = json::parse(as_json.out);
    EXPECT_EQ(summary.at("format"), "OME-Zarr 0.5");
    EXPECT_EQ(summary.at("levels"), 3);
    EXPECT_EQ(summary.at("kept"), 0);
    EXPECT_EQ(summary.at("chunks"), 3 * 3 * 2 + 2 * 2 * 1 + 1);
    const Outcome line = palpate(folder, "convert a.zarr b.nrrd --level 1");
    expect_done(line);
    EXPECT_EQ(line.out, "b.nrrd: 12 x 10 x 8 samples\n");
    const Outcome quiet = palpate(folder, "convert -q a.zarr c.nrrd");
    expect_done(quiet);
    EXPECT_EQ(quiet.out + quiet.err, "");
    EXPECT_FALSE(fs::exists(folder / "a.zarr.partial"));
    const Outcome one = palpate(folder, "convert a.zarr d.zarr --level 2");
    expect_done(one);
    EXPECT_TRUE(contains(one.out, ", 1 level, 1 chunk (")) << one.out;
}

/// Starts a conversion of `large` and ends it when it has written some chunks.
Outcome ended_by(int signal, const ScratchFolder& folder) {
    Running run(words_of(std::string("convert --chunk 8 --threads 1 ") + large + " a.zarr"),
                folder.path());
    EXPECT_TRUE(comes_true([&] { return files_in(folder / "a.zarr.partial") > 40; }));
    return run.finish(signal);
}

TEST(Convert, what_the_output_lacks_is_said_unless_it_was_chosen) {
    const ScratchFolder folder;
    const std::string head = "NRRD0004\ntype: uint8\nencoding: raw\n";
    put_bytes(folder / "beat.nrrd",
              head + "dimension: 4\nsizes: 4 4 4 3\nkinds: domain domain domain time\n\n" +
                  std::string(192, 'x'));
    put_bytes(folder / "l.seg.nrrd", head +
                                         "dimension: 3\nspace: left-posterior-superior\n"
                                         "sizes: 4 4 4\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                                         "space origin: (0,0,0)\nSegment0_Name:=liver\n"
                                         "Segment0_LabelValue:=1\nSegment0_Layer:=0\n\n" +
                                         std::string(64, '\1'));
    const auto said = [&](const std::string& words, const std::string& note) {
        const Outcome outcome = palpate(folder, "convert " + words);
        expect_done(outcome);
        return outcome.err.find(note) != std::string::npos;
    };
    const char* const frames = "only the first of its 3 frames is converted";
    const char* const axes = "its orientation is not known, which NIfTI cannot say";
    EXPECT_TRUE(said("beat.nrrd a.nrrd", frames));
    EXPECT_TRUE(said("beat.nrrd a.zarr", frames));
    EXPECT_FALSE(said("beat.nrrd a.mha --time-step 0", frames));
    EXPECT_TRUE(said("beat.nrrd a.nii", axes));
    EXPECT_FALSE(said("beat.nrrd b.nii --orientation LPS", axes));
    EXPECT_FALSE(said("beat.nrrd c.mha", axes));
    EXPECT_TRUE(said("l.seg.nrrd d.nrrd", "names and colours of its segments are not"));
    EXPECT_TRUE(palpate(folder, "convert -q l.seg.nrrd e.nrrd").err.empty());
}

TEST(Convert, a_run_that_is_killed_is_continued_and_gives_what_one_run_gives) {
    const ScratchFolder folder;
    EXPECT_EQ(ended_by(SIGKILL, folder).status, 1000 + SIGKILL);
    EXPECT_FALSE(fs::exists(folder / "a.zarr"));
    ASSERT_TRUE(fs::exists(folder / "a.zarr.partial"));
    const std::string again = std::string("convert --json --chunk 8 ") + large;
    const Outcome continued = palpate(folder, again + " a.zarr");
    expect_done(continued);
    const json summary = json::parse(continued.out);
    EXPECT_GT(summary.at("kept").get<int>(), 30);
    EXPECT_LT(summary.at("kept").get<int>(), summary.at("chunks").get<int>());
    EXPECT_FALSE(fs::exists(folder / "a.zarr.partial"));
    const Outcome fresh = palpate(folder, again + " b.zarr");
    expect_done(fresh);
    EXPECT_EQ(json::parse(fresh.out).at("kept"), 0);
    EXPECT_EQ(files_in(folder / "a.zarr"), files_in(folder / "b.zarr"));
    expect_done(palpate(folder, "convert -q a.zarr a.nrrd"));
    expect_done(palpate(folder, "convert -q b.zarr b.nrrd"));
    expect_same(volume_at(folder / "a.nrrd"), volume_at(folder / "b.nrrd"));
}

TEST(Convert, an_interruption_exits_with_130_and_other_options_begin_anew) {
    const ScratchFolder folder;
    const Outcome outcome = ended_by(SIGINT, folder);
    EXPECT_EQ(outcome.status, 130);
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(fs::exists(folder / "a.zarr"));
    const Outcome other =
        palpate(folder, std::string("convert --json --chunk 32 ") + large + " a.zarr");
    expect_done(other);
    EXPECT_EQ(json::parse(other.out).at("kept"), 0);
    EXPECT_EQ(json::parse(other.out).at("chunks"), 125 + 27 + 8 + 1);
}

TEST(Convert, other_work_begins_anew_and_says_so) {
    const ScratchFolder folder;
    EXPECT_EQ(ended_by(SIGINT, folder).status, 130);
    // The name of the source is the same; its samples are not.
    const Outcome other =
        palpate(folder, std::string("convert --json --chunk 8 --smooth 1 ") + large + " a.zarr");
    expect_done(other);
    EXPECT_TRUE(contains(other.err, "begun anew")) << other.err;
    EXPECT_EQ(json::parse(other.out).at("kept"), 0);
    expect_done(palpate(folder, std::string("convert -q --smooth 1 ") + large + " b.nrrd"));
    expect_done(palpate(folder, "convert -q a.zarr a.nrrd"));
    expect_same(volume_at(folder / "a.nrrd"), volume_at(folder / "b.nrrd"));
}

TEST(Convert, a_folder_of_somebody_else_where_it_would_grow_is_refused_and_stays) {
    const ScratchFolder folder, precious;
    put_bytes(precious / "thesis.txt", "years");
    fs::create_directory_symlink(precious.path(), folder / "a.zarr.partial");
    fs::create_directory(folder / "b.zarr.partial");
    put_bytes(folder / "b.zarr.partial/thesis.txt", "years");
    for (const std::string out : {"a.zarr", "b.zarr"}) {
        expect_failure(palpate(folder, std::string("convert ") + small + " " + out), 5,
                       out + ".partial: is a");
        EXPECT_EQ(bytes_of(folder / (out + ".partial/thesis.txt")), "years");
    }
}

TEST(Convert, a_slash_after_the_folder_changes_nothing) {
    const ScratchFolder folder;
    expect_done(palpate(folder, std::string("convert -q ") + small + " a.zarr/"));
    EXPECT_TRUE(fs::exists(folder / "a.zarr/zarr.json"));
    expect_failure(palpate(folder, std::string("convert -q ") + small + " a.zarr/"), 5,
                   "is there already");
}

TEST(Convert, wrong_use_bad_input_and_outputs_that_cannot_be_leave_nothing_behind) {
    const ScratchFolder folder;
    expect_done(palpate(folder, std::string("convert -q ") + small + " a.zarr"));
    put_bytes(folder / "file.zarr", "x");
    fs::create_directory(folder / "empty.zarr");
    struct Wrong {
        const char* words;
        int status;
        const char* reason;
    };
    for (const Wrong& wrong : {Wrong{"", 2, "VOLUME"},
                               {"a.zarr", 2, "OUT"},
                               {"a.zarr out.zarr --chunk 4", 2, "--chunk"},
                               {"a.zarr out.zarr --threads 0", 2, "--threads"},
                               {"a.zarr out.zarr --ome-version 0.3", 2, "--ome-version"},
                               {"a.zarr out.zarr --compression lzma", 2, "--compression"},
                               {"a.zarr out.zarr --level 9", 2, "no level 9: it has 1 level, 0"},
                               {"a.zarr out.zarr --channel 2", 3, "no channel 2"},
                               {"a.zarr out.zarr --time-step 2", 3, "no time 2"},
                               {"absent.nrrd out.zarr", 3, "does not exist"},
                               {"empty.zarr out.zarr", 3, "no metadata of Zarr"},
                               {"a.zarr out.xyz", 2, ".raw, .zarr"},
                               {"a.zarr none/out.zarr", 5, "choose another folder"},
                               {"a.zarr none/out.nrrd", 5, "create it first"},
                               {"a.zarr file.zarr", 5, "is there already"},
                               {"a.zarr a.zarr", 5, "is there already"}}) {
        SCOPED_TRACE(wrong.words);
        expect_failure(palpate(folder, std::string("convert ") + wrong.words), wrong.status,
                       wrong.reason);
    }
    EXPECT_EQ(bytes_of(folder / "file.zarr"), "x");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 3);
}

TEST(Convert, a_damaged_chunk_is_one_line_and_no_file) {
    const ScratchFolder folder;
    expect_done(palpate(folder, std::string("convert -q --chunk 8 ") + small + " a.zarr"));
    std::vector<fs::path> chunks;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "a.zarr")) {
        if (entry.is_regular_file() && entry.path().extension() != ".json") {
            chunks.push_back(entry.path());
        }
    }
    std::ranges::sort(chunks);
    ASSERT_FALSE(chunks.empty());
    const std::string good = bytes_of(chunks[0]);
    put_bytes(chunks[0], good.substr(0, good.size() / 2));
    for (const char* out : {"b.nrrd", "b.nii", "b.zarr"}) {
        SCOPED_TRACE(out);
        expect_failure(palpate(folder, std::string("convert -q a.zarr ") + out), 3, "damaged");
        EXPECT_FALSE(fs::exists(folder / out));
    }
    fs::remove_all(folder / "b.zarr.partial");  // which the next run would continue
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(Convert, a_chunk_that_does_not_fit_into_half_of_the_memory_is_refused_by_name) {
    const ScratchFolder folder;
    fs::create_directory(folder / "bomb.zarr");
    put_bytes(folder / "bomb.zarr/.zarray",
              R"({"zarr_format":2,"shape":[1024,1024,1024],"chunks":[1024,1024,1024],)"
              R"("dtype":"|u1","compressor":{"id":"gzip"},"fill_value":0,"order":"C",)"
              R"("filters":null})");
    put_bytes(folder / "bomb.zarr/0.0.0", "no gzip");
    for (const std::string out : {"o.zarr", "o.raw"}) {
        expect_failure(palpate(folder, "convert -q bomb.zarr --memory 256MB " + out), 3,
                       "a chunk of level 0 takes 2148 MB to be read, and 134 MB may be used");
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"bomb.zarr"});
}

}  // namespace
}  // namespace palpate::app::test
