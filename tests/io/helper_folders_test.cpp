// The folders in which helper programs are searched for, and the message if there is none.
#include "io/process/helper_folders.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "io/process/helper_process.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

TEST(HelperFolders, begin_beside_the_program_are_absolute_and_none_is_there_twice) {
    const std::vector<fs::path> folders = helper_folders();
    ASSERT_FALSE(folders.empty());
    EXPECT_EQ(folders.front(), fs::read_symlink("/proc/self/exe").parent_path());
    EXPECT_TRUE(std::ranges::all_of(folders, [](const fs::path& f) { return f.is_absolute(); }));
    EXPECT_EQ(std::set(folders.begin(), folders.end()).size(), folders.size());
}

TEST(HelperFolders, hold_the_helper_of_this_build_tree) {
    EXPECT_TRUE(std::ranges::any_of(helper_folders(), [](const fs::path& folder) {
        return ::access((folder / "palpate-io-helper").c_str(), X_OK) == 0;
    }));
}

TEST(HelperFolders, are_all_named_if_none_has_the_helper) {
    const HelperProgram program{"palpate-no-helper", "nobody", "nothing", "nothing", "nothing"};
    const std::string failure = run_helper({program, {}, {}, nullptr, {}, 1}).failure;
    for (const fs::path& folder : helper_folders()) {
        EXPECT_NE(failure.find(folder.string()), std::string::npos) << failure;
    }
    EXPECT_NE(failure.find("PALPATE_NO_HELPER"), std::string::npos) << failure;
    EXPECT_EQ(failure.find('\n'), std::string::npos) << failure;
}

}  // namespace
}  // namespace palpate::io
