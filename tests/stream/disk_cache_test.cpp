// The disk cache in folders that hold other files, or that cannot be read.
#include "stream/objects/disk_cache.hpp"

#include <dirent.h>
#include <dlfcn.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <functional>

#include "stream/store_support.hpp"
#include "support/eventually.hpp"

namespace palpate::stream::test {
namespace {

std::atomic<ino_t> unreadable{0};  // the number of a folder, 0: none

}  // namespace

/// Takes the place of the system's function: one folder has a read error.
extern "C" dirent* readdir(DIR* folder) {
    struct stat about {};
    if (unreadable != 0 && ::fstat(::dirfd(folder), &about) == 0 && about.st_ino == unreadable) {
        errno = EIO;
        return nullptr;
    }
    static const auto system =
        reinterpret_cast<decltype(&::readdir)>(::dlsym(RTLD_NEXT, "readdir"));
    return system(folder);
}

namespace {

namespace fs = std::filesystem;
using support::put_bytes;
using support::ScratchFolder;
using namespace std::chrono_literals;

TEST(DiskCache, removes_no_file_that_it_did_not_write) {
    const ScratchFolder folder, precious;
    const std::string name(30, 'a');
    const std::vector<fs::path> foreign = {folder / "thesis.txt", folder / "ab/notes.txt",
                                           folder / "ab" / name, precious / name};
    fs::create_directory(folder / "ab");
    fs::create_directory_symlink(precious.path(), folder / "cd");
    for (const fs::path& file : foreign) {
        put_bytes(file, std::string(200'000, 'x'));
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1000));
    }
    const DiskCache cache(folder.path(), 400'000);
    const Bytes bytes(40'000);
    for (int i = 0; i < 40; ++i) cache.put("piece " + std::to_string(i), bytes);
    for (const fs::path& file : foreign) EXPECT_EQ(fs::file_size(file), 200'000U) << file;
    EXPECT_FALSE(cache.find("piece 0")) << "the oldest entries went";
    EXPECT_TRUE(cache.find("piece 39"));
}

TEST(DiskCache, stays_within_its_bound_although_one_of_its_folders_cannot_be_read) {
    const ScratchFolder folder;
    constexpr std::uint64_t bound = 400'000;
    const DiskCache cache(folder.path(), bound);
    const Bytes bytes(4'000);
    const auto put = [&](int first, int end) {
        for (int i = first; i < end; ++i) cache.put("piece " + std::to_string(i), bytes);
    };
    put(0, 60);
    const fs::path broken = fs::directory_iterator(folder.path())->path();
    const std::uint64_t before = bytes_in(broken);
    ASSERT_GT(before, 0U);
    struct stat about {};
    ASSERT_EQ(::stat(broken.c_str(), &about), 0);
    unreadable = about.st_ino;
    put(60, 400);
    unreadable = 0;
    EXPECT_EQ(bytes_in(broken), before);
    EXPECT_LE(bytes_in(folder.path()), bound);
    EXPECT_TRUE(cache.find("piece 399"));
    put(400, 800);
    EXPECT_LE(bytes_in(folder.path()), bound);
    EXPECT_NE(bytes_in(broken), before) << "it is used again once it can be read";
}

TEST(DiskCache, a_lower_bound_acts_at_once_and_the_newest_entries_stay) {
    const ScratchFolder folder;
    const Bytes bytes(4'000);
    {
        const DiskCache large(folder.path(), 400'000);
        for (int i = 0; i < 60; ++i) large.put("piece " + std::to_string(i), bytes);
    }
    ASSERT_GT(bytes_in(folder.path()), 200'000U);
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
        if (entry.is_regular_file()) fs::last_write_time(entry, entry.last_write_time() - 1h);
    }
    {
        const DiskCache newer(folder.path(), 400'000);
        newer.put("newest", bytes);
    }
    const DiskCache small(folder.path(), 100'000);  // from which nothing is read
    const auto is_small = [&] {
        try {
            return bytes_in(folder.path()) <= 100'000;
        } catch (const fs::filesystem_error&) {  // a file went while it was counted
            return false;
        }
    };
    EXPECT_TRUE(support::comes_true(is_small));
    EXPECT_TRUE(small.find("newest"));
}

/// The one entry of a cache.
fs::path only_entry(const fs::path& cache) {
    for (const auto& entry : fs::recursive_directory_iterator(cache)) {
        if (entry.is_regular_file()) return entry.path();
    }
    return {};
}

TEST(DiskCache, an_entry_whose_bytes_did_not_reach_the_disk_is_never_returned) {
    const ScratchFolder folder;
    const DiskCache cache(folder.path(), 400'000);
    Bytes bytes(20'000);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 + 1);
    const std::size_t page = 4096;
    const auto after_power_cut = [&](const std::function<void(std::string&)>& lose) {
        cache.put("piece", bytes);
        const fs::path entry = only_entry(folder.path());
        std::string held = support::bytes_of(entry);
        lose(held);
        put_bytes(entry, held);
        EXPECT_FALSE(cache.find("piece"));
        EXPECT_FALSE(fs::exists(entry)) << "it takes room for ever";
    };
    for (std::size_t at = 0; at < bytes.size(); at += page) {
        after_power_cut([&](std::string& held) { held.resize(at); });
        if (at == 0) continue;  // without its beginning, a file is nobody's entry
        after_power_cut([&](std::string& held) {
            std::fill_n(held.begin() + static_cast<std::ptrdiff_t>(at),
                        std::min(page, held.size() - at), '\0');
        });
    }
    after_power_cut([](std::string& held) { std::ranges::fill(held, '\0'); });
    cache.put("piece", bytes);
    EXPECT_EQ(cache.find("piece"), bytes);
}

TEST(DiskCache, entries_of_zeros_go_like_others_when_it_is_full) {
    const ScratchFolder folder;
    constexpr std::uint64_t bound = 400'000;
    const DiskCache cache(folder.path(), bound);
    const auto put = [&](int first, int end) {
        for (int i = first; i < end; ++i) cache.put("piece " + std::to_string(i), Bytes(40'000));
    };
    put(0, 8);
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
        if (!entry.is_regular_file()) continue;
        put_bytes(entry.path(), std::string(entry.file_size(), '\0'));
        fs::last_write_time(entry, fs::file_time_type::clock::now() - 1h);
    }
    put(8, 40);
    EXPECT_LE(bytes_in(folder.path()), bound);
}

}  // namespace
}  // namespace palpate::stream::test
