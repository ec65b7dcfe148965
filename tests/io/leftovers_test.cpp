// Leftovers of killed processes are removed by the next one, and nothing else.
#include "io/system/leftovers.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <functional>

#include "io/system/system.hpp"
#include "palpate/io/output.hpp"
#include "support/eventually.hpp"
#include "support/fields.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate::io;
using namespace palpate::support;

namespace {

using Names = std::vector<std::string>;

}  // namespace

/// The work of another run that writes in the folder: a process of its own, which looks for
/// leftovers once.
void write_in_another_process(const ScratchFolder& folder,
                              const std::function<void()>& between = {}) {
    const pid_t child = ::fork();
    if (child == 0) {
        { PendingFile file(folder / "b.csv"); }
        if (between) between();
        { PendingFile file(folder / "b.csv"); }
        ::_exit(0);
    }
    int status = 1;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
}

/// The number of a process that has ended, as a word.
std::string dead_process() {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ::waitpid(child, nullptr, 0);
    return std::to_string(child);
}

TEST(Leftovers, of_a_killed_process_are_removed_by_the_next_and_those_of_a_living_one_stay) {
    const ScratchFolder folder;
    const pid_t child = ::fork();
    if (child == 0) {
        PendingFile file(folder / "a.csv");
        ::pause();
    }
    // Its name gets the number of the file, which is only known when the file is there.
    EXPECT_TRUE(comes_true([&] {
        const Names names = folder.names();
        return !names.empty() && std::ranges::count(*names.begin(), '-') == 3;
    }));
    const Names unfinished = folder.names();
    ASSERT_EQ(unfinished.size(), 1U);
    write_in_another_process(folder);
    EXPECT_EQ(folder.names(), unfinished);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    EXPECT_EQ(folder.names(), unfinished);
    put_bytes(folder / ".palpate-notes.part", "of somebody else");
    write_in_another_process(folder);
    EXPECT_EQ(folder.names(), Names{".palpate-notes.part"});
}

/// Gives what lies at a path the name that Palpate gives what it makes.
void sign(const std::filesystem::path& path) {
    struct stat about {};
    ASSERT_EQ(::lstat(path.c_str(), &about), 0);
    std::filesystem::path to = path;
    to.replace_extension();
    std::filesystem::rename(path, to += "-" + std::to_string(about.st_ino) + ".part");
}

TEST(Leftovers, folders_of_killed_processes_are_removed_with_all_that_is_in_them) {
    const ScratchFolder folder, elsewhere;
    put_bytes(elsewhere / "precious", "kept");
    const std::string dead = ".palpate-" + dead_process();
    for (const std::string& name : {dead + "-0.part", dead + "-12-34.part"}) {
        std::filesystem::create_directories(folder / (name + "/inner"));
        put_bytes(folder / (name + "/.palpate-temporary"), std::string(temporary_marker_text));
        put_bytes(folder / (name + "/inner/half.raw"), "half");
        std::filesystem::create_directory_symlink(elsewhere.path(), folder / (name + "/link"));
    }
    put_bytes(folder / "results.csv", "of a run that ended");
    write_in_another_process(folder);
    EXPECT_EQ(folder.names(), Names{"results.csv"});
    EXPECT_EQ(bytes_of(elsewhere / "precious"), "kept");
}

TEST(Leftovers, what_only_resembles_a_leftover_stays) {
    const ScratchFolder folder, elsewhere;
    put_bytes(elsewhere / "precious", "kept");
    const std::string dead = ".palpate-" + dead_process();
    Names names{dead,
                dead + "-",
                dead + "-1.part~",
                dead + "-x.part",
                dead + "-1-2.part",
                dead + ".p",
                "x" + dead,
                dead + "x.part",
                dead + "-+1",
                dead + "-1.part.part",
                ".palpate--1",
                ".palpate-0.part",
                ".palpate-" + std::to_string(::getpid()) + "-9.part"};
    for (const std::string& name : names) std::filesystem::create_directory(folder / name);
    const auto add = [&](const std::string& end) {
        names.push_back(dead + end);
        return folder / names.back();
    };
    std::filesystem::create_directory_symlink(elsewhere.path(), add("-1.part"));
    std::filesystem::create_symlink(elsewhere / "precious", add("-2.part"));
    ASSERT_EQ(::mkfifo(add("-3.part").c_str(), 0600), 0);
    if (::geteuid() == 0) {  // nobody else can give files away
        const auto of_somebody = add("-4.part");
        std::filesystem::create_directory(of_somebody);
        ASSERT_EQ(::chown(of_somebody.c_str(), 65534, 65534), 0);
    }
    const auto in_use = add("-5.part");  // by a process that cannot be seen from here
    std::filesystem::create_directory(in_use);
    const int lock = lock_temporary(in_use);
    const auto of_a_user = add("-6.part"), with_a_link = add("-7.part");
    std::filesystem::create_directories(of_a_user / "result");
    put_bytes(of_a_user / "result/thesis.txt", "kept");
    std::filesystem::create_directory(with_a_link);
    std::filesystem::create_symlink(elsewhere / "precious", with_a_link / ".palpate-temporary");
    write_in_another_process(folder);
    ::close(lock);
    EXPECT_EQ(bytes_of(of_a_user / "result/thesis.txt"), "kept");
    std::sort(names.begin(), names.end());
    EXPECT_EQ(folder.names(), names);
    EXPECT_EQ(bytes_of(elsewhere / "precious"), "kept");
}

TEST(Leftovers, files_and_folders_that_palpate_did_not_make_stay_whatever_their_names) {
    const ScratchFolder folder;
    const std::string dead = ".palpate-" + dead_process();
    const auto data = [&](const std::string& name) {
        std::filesystem::create_directories((folder / name).parent_path());
        put_bytes(folder / name, "precious");
    };
    data(dead + "-1.part");
    data(dead + "-2-3.part");
    data(dead + ".part");
    data(dead + "-4");
    for (const char* text : {"", "Palpate made this folder"}) {
        const std::string name = dead + "-5" + std::to_string(std::strlen(text)) + ".part";
        data(name + "/thesis.txt");
        put_bytes(folder / (name + "/.palpate-temporary"), text);
    }
    data(dead + "-6.part/result/0/c/0/0/0");  // as Palpate would write it
    data("signed");
    data(dead + "-8.part");
    sign(folder / (dead + "-8.part"));  // ours; its name is taken by another file
    const auto names = folder.names();
    const auto ours = std::ranges::find_if(
        names, [&](const std::string& name) { return name.starts_with(dead + "-8-"); });
    ASSERT_NE(ours, names.end());
    std::filesystem::rename(folder / "signed", folder / *ours);
    const Names before = folder.names();
    write_in_another_process(folder);
    EXPECT_EQ(folder.names(), before);
    EXPECT_EQ(bytes_of(folder / (dead + "-6.part/result/0/c/0/0/0")), "precious");
}

TEST(Leftovers, what_was_made_but_not_yet_signed_is_removed_because_it_is_empty) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / (".palpate-" + dead_process() + "-1.part"));
    put_bytes(folder / (".palpate-" + dead_process() + "-0.part"), "");
    put_bytes(folder / (".palpate-" + dead_process() + "-0.part"), "x");
    write_in_another_process(folder);
    EXPECT_EQ(folder.names().size(), 1U);
    EXPECT_EQ(bytes_of(folder / folder.names().front()), "x");
}

TEST(Leftovers, a_process_looks_for_leftovers_once_in_a_folder) {
    const ScratchFolder folder;
    const std::string name = ".palpate-" + dead_process() + "-0.part";
    write_in_another_process(folder, [&] {
        put_bytes(folder / name, "half");
        sign(folder / name);
    });
    EXPECT_EQ(folder.names().size(), 1U);
    write_in_another_process(folder);
    EXPECT_EQ(folder.names(), Names{});
}
