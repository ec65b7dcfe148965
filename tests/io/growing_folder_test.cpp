// Removing never follows links; a folder that grows is locked, recognised, and put in place whole.
#include "io/growing_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/own_names.hpp"
#include "io/path_json.hpp"
#include "io/removal.hpp"
#include "palpate/io/error.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;
using Names = std::vector<std::string>;

TEST(Removal, takes_all_below_a_folder_and_nothing_that_a_link_points_to) {
    const ScratchFolder folder, precious;
    put_bytes(precious / "thesis.txt", "years");
    const fs::path tree = folder / "tree";
    fs::create_directories(tree / "a/b/c");
    put_bytes(tree / "a/b/c/file", "x");
    ASSERT_EQ(::mkfifo((tree / "a/pipe").c_str(), 0600), 0);
    fs::create_directory_symlink(precious.path(), tree / "a/b/link");
    fs::create_symlink("/nowhere", tree / "broken");
    fs::create_directory_symlink(precious.path(), folder / "link");
    EXPECT_TRUE(remove_tree(tree));
    EXPECT_TRUE(remove_tree(folder / "link"));
    EXPECT_TRUE(remove_tree(folder / "not there"));
    EXPECT_EQ(folder.names(), Names{});
    EXPECT_EQ(bytes_of(precious / "thesis.txt"), "years");
}

TEST(GrowingFolder, of_one_job_is_locked_continued_and_put_in_place) {
    const ScratchFolder folder;
    const fs::path out = folder / "o";
    {
        const GrowingFolder first = GrowingFolder::resumable(out, "a job");
        put_bytes(first.result() / "zarr.json", "done");
        const std::string busy =
            message_of<OutputError>([&] { (void)GrowingFolder::resumable(out, "a job"); });
        EXPECT_TRUE(contains(busy, "another process is writing it")) << busy;
        const std::string other =
            message_of<OutputError>([&] { (void)GrowingFolder::resumable(out, "other"); });
        EXPECT_TRUE(contains(other, "another process is writing it")) << other;
    }
    GrowingFolder again = GrowingFolder::resumable(out, "a job");
    EXPECT_TRUE(again.is_continued());
    EXPECT_EQ(bytes_of(again.result() / "zarr.json"), "done");
    fs::create_directory(again.work());
    again.put_in_place();
    EXPECT_EQ(bytes_of(out / "zarr.json"), "done");
}

TEST(GrowingFolder, leaves_nothing_else_and_begins_anew_for_another_job) {
    const ScratchFolder folder;
    const fs::path out = folder / "o";
    put_bytes(GrowingFolder::resumable(out, "a job").result() / "zarr.json", "done");
    {
        GrowingFolder anew = GrowingFolder::resumable(out, "another job");
        EXPECT_FALSE(anew.is_continued());
        EXPECT_TRUE(contains(anew.note(), "begun anew"));
        EXPECT_TRUE(fs::is_empty(anew.result()));
        anew.put_in_place();
    }
    EXPECT_EQ(folder.names(), Names{"o"});
    { const GrowingFolder alone = GrowingFolder::alone(out); }
    EXPECT_EQ(folder.names(), Names{"o"});
}

TEST(GrowingFolder, replaces_what_it_may_and_keeps_its_result_where_it_may_not) {
    const ScratchFolder folder;
    const fs::path out = folder / "o";
    fs::create_directory(out);
    put_bytes(out / ".zattrs", "old");
    {
        GrowingFolder alone = GrowingFolder::alone(out);
        put_bytes(alone.result() / ".zgroup", "new");
        const std::string message = message_of<OutputError>(
            [&] { alone.put_in_place([](const fs::path&) { throw OutputError("precious"); }); });
        EXPECT_TRUE(contains(message, "precious; the result is kept as ")) << message;
    }
    EXPECT_EQ(bytes_of(out / ".zattrs"), "old");
    EXPECT_EQ(bytes_of(folder / "o.rescued/.zgroup"), "new");
    EXPECT_EQ(folder.names(), (Names{"o", "o.rescued"}));
    {
        GrowingFolder alone = GrowingFolder::alone(out);
        put_bytes(alone.result() / ".zgroup", "newer");
        alone.put_in_place([](const fs::path&) {});
    }
    EXPECT_EQ(bytes_of(out / ".zgroup"), "newer");
    EXPECT_EQ(folder.names(), (Names{"o", "o.rescued"}));
}

TEST(GrowingFolder, knows_its_own_names_and_does_not_guess_what_it_cannot_read) {
    const ScratchFolder folder;
    const fs::path image = folder / "i.zarr";
    fs::create_directories(image / "0/c/3/2");
    fs::create_directories(image / "1/4/5");
    for (const char* name : {"zarr.json", ".zgroup", "palpate-edits.json", "0/zarr.json",
                             "0/c/3/2/1", "0/c/3/2/7.part", "0/c/3/2/8.part-host-1-2", "1/.zarray",
                             "1/4/5/6", ".palpate-12-3.part"}) {
        put_bytes(image / name, "ours");
    }
    EXPECT_EQ(unknown_below(image, OwnFolder::image), "");
    for (const char* name : {"0/c/3/2/01", "0/c/3/x", "0/c/5", "64", "notes", "1/4/5/6.txt"}) {
        put_bytes(image / name, "years");
        EXPECT_EQ(unknown_below(image, OwnFolder::image), name);
        EXPECT_EQ(bytes_of(image / name), "years");
        fs::remove(image / name);
    }
    put_bytes(image / "1/4/notes", "years");
    EXPECT_EQ(remove_known(image, OwnFolder::image), "1/4/notes");
    EXPECT_EQ(bytes_of(image / "1/4/notes"), "years");
    EXPECT_FALSE(fs::exists(image / "0"));
    put_bytes(folder / "file", "x");
    EXPECT_THROW((void)unknown_below(folder / "file", OwnFolder::image), OutputError);
}

TEST(PathJson, has_every_path_and_refuses_what_is_none) {
    for (const std::string path : {"", "/a b/caf\xc3\xa9", "\xff", "a/\xe9\xc3/\"b"}) {
        const nlohmann::json json = nlohmann::json::parse(json_of_path(path).dump());
        EXPECT_EQ(path_from_json(json).string(), path);
        EXPECT_EQ(json.is_string(),
                  path.find('\xff') == path.npos && path.find('\xe9') == path.npos);
    }
    for (const char* json :
         {"1", "{}", R"({"bytes":1})", R"({"bytes":"abc"})", R"({"bytes":"gg"})"})
        EXPECT_THROW((void)path_from_json(nlohmann::json::parse(json)), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::io
