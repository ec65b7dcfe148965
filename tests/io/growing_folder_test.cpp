// Removing never follows links; a folder that grows is locked, recognised, and put in place whole.
#include "io/system/growing_folder.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "io/path_json.hpp"
#include "io/process/helper_process.hpp"
#include "io/system/leftovers.hpp"
#include "io/system/open_file.hpp"
#include "io/system/own_names.hpp"
#include "io/system/removal.hpp"
#include "io/system/system.hpp"
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

TEST(OpenFile, opens_files_only_and_waits_for_no_pipe) {
    const ScratchFolder folder;
    put_bytes(folder / "file", "x");
    fs::create_symlink("file", folder / "link");
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const auto problem_of = [&](const fs::path& path, bool follows) {
        errno = 0;
        const Descriptor file(follows ? open_to_read(path) : open_file_in(AT_FDCWD, path.string()));
        return file.number() >= 0 ? 0 : errno;
    };
    for (const bool follows : {true, false}) {
        EXPECT_EQ(problem_of(folder / "file", follows), 0);
        EXPECT_EQ(problem_of(folder / "pipe", follows), ENXIO);
        EXPECT_EQ(problem_of(folder.path(), follows), EISDIR);
        EXPECT_EQ(problem_of("/dev/zero", follows), ENXIO);
        EXPECT_EQ(problem_of(folder / "nothing", follows), ENOENT);
        EXPECT_EQ(problem_of(folder / "link", follows), follows ? 0 : ELOOP);
    }
}

/// Runs work() in a process with mounts of its own, in which `at` shows what is in `from`. False if
/// this system has no such mounts.
bool with_mount(const fs::path& from, const fs::path& at, const std::function<void()>& work) {
    constexpr int no_mounts = 77;
    const pid_t child = ::fork();
    if (child == 0) {
        const bool mounted =
            (::unshare(CLONE_NEWNS) == 0 || ::unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) &&
            ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
            ::mount(from.c_str(), at.c_str(), nullptr, MS_BIND, nullptr) == 0;
        if (mounted) work();
        ::_exit(mounted ? 0 : no_mounts);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status) == 0;
}

TEST(Removal, leaves_what_is_mounted_from_elsewhere_on_the_same_device) {
    const ScratchFolder folder;
    const fs::path precious = folder / "precious", tree = folder / "tree", image = folder / "image";
    fs::create_directories(tree / "a/b");
    fs::create_directories(image / "0");
    fs::create_directory(precious);
    put_bytes(precious / "zarr.json", "years");  // called as we would call it
    put_bytes(tree / "a/file", "x");
    if (!with_mount(precious, tree / "a/b", [&] { (void)remove_tree(tree); })) {
        GTEST_SKIP() << "this system mounts nothing for this user";
    }
    EXPECT_FALSE(fs::exists(tree / "a/file"));
    EXPECT_TRUE(with_mount(precious, image / "0", [&] {
        put_bytes(folder / "unknown", unknown_below(image, OwnFolder::image));
        put_bytes(folder / "left", remove_known(image, OwnFolder::image));
    }));
    EXPECT_EQ(bytes_of(precious / "zarr.json"), "years");
    EXPECT_EQ(bytes_of(folder / "unknown"), "0");
    EXPECT_EQ(bytes_of(folder / "left"), "0");
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

TEST(GrowingFolder, looks_again_where_another_process_replaced_what_it_looked_at) {
    const ScratchFolder folder;
    const fs::path out = folder / "o", other = folder / "other";
    int looks = 0;
    const auto replaced_once = [&](const fs::path&) {
        if (++looks % 2 == 0) return;
        fs::create_directory(other);
        fs::rename(out, folder / ("before" + std::to_string(looks)));
        fs::rename(other, out);
        throw OutputError("half of it was there");
    };
    fs::create_directory(out);
    check_in_place(out, replaced_once);
    EXPECT_EQ(looks, 2);
    GrowingFolder alone = GrowingFolder::alone(out);
    put_bytes(alone.result() / ".zgroup", "new");
    alone.put_in_place([&](const fs::path& at) {
        if (at == out) replaced_once(at);
    });
    EXPECT_EQ(looks, 4);
    EXPECT_EQ(bytes_of(out / ".zgroup"), "new");
}

TEST(GrowingFolder, knows_its_own_names_and_does_not_guess_what_it_cannot_read) {
    const ScratchFolder folder;
    const fs::path image = folder / "i.zarr";
    fs::create_directories(image / "0/c/3/2");
    fs::create_directories(image / "1/4/5");
    for (const char* name :
         {"zarr.json", ".zgroup", "palpate-edits.json", "0/zarr.json", "0/c/3/2/1",
          "0/c/3/2/7.part", "0/c/3/2/8.part-host-1-2", "1/.zarray", "1/4/5/6"}) {
        put_bytes(image / name, "ours");
    }
    put_bytes(image / ".palpate-12-3.part", "");  // killed before it was signed
    put_bytes(image / ".palpate-12-4.part", "ours");
    (void)signed_temporary(image / ".palpate-12-4.part");
    EXPECT_EQ(unknown_below(image, OwnFolder::image), "");
    for (const char* name : {"0/c/3/2/01", "0/c/3/x", "0/c/5", "64", "notes", "1/4/5/6.txt",
                             ".palpate-12-5.part", ".palpate-12-5-1.part"}) {
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
