// The helper process that looks into a file of chunks: one for all questions, it gets no more of a
// file elsewhere than it may, and whatever it does is one line.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <latch>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "io/process/located_chunks.hpp"
#include "stream/formats/located_file.hpp"
#include "stream/store_support.hpp"
#include "stream/written_files.hpp"
#include "support/eventually.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using support::contains;
using support::message_of;
using support::ScratchFolder;

/// The children of this process.
std::set<pid_t> children() {
    std::set<pid_t> all;
    for (const auto& task : fs::directory_iterator("/proc/self/task")) {
        std::ifstream list(task.path() / "children");
        for (pid_t child = 0; list >> child;) all.insert(child);
    }
    return all;
}

/// A file in memory that notes what is read of it.
struct FarFile {
    std::string bytes = support::bytes_of(written_by("hdf5") / "image.ims");
    std::mutex mutex = {};
    std::vector<std::pair<std::uint64_t, std::uint64_t>> read = {};
    std::function<void()> before = {};  ///< what happens while it is read

    io::ChunkFile file() {
        return {"image.ims", bytes.size(),
                [this](std::uint64_t offset, std::uint64_t length, const std::stop_token&) {
                    if (before) before();
                    const std::scoped_lock lock(mutex);
                    read.emplace_back(offset, length);
                    const auto* const from =
                        reinterpret_cast<const std::byte*>(bytes.data()) + offset;
                    return std::vector<std::byte>(from, from + length);
                }};
    }
};

/// Runs a shell script in the helper's place.
class HelperScript {
  public:
    explicit HelperScript(const std::string& commands) {
        const fs::path path = folder_ / "helper";
        support::put_bytes(path, "#!/bin/bash\n" + commands + "\n");
        fs::permissions(path, fs::perms::owner_all);
        ::setenv("PALPATE_IO_HELPER", path.c_str(), 1);
    }
    ~HelperScript() { ::unsetenv("PALPATE_IO_HELPER"); }
    HelperScript(const HelperScript&) = delete;
    HelperScript& operator=(const HelperScript&) = delete;

  private:
    ScratchFolder folder_;
};

std::string refusal_of_far(const std::string& commands) {
    const HelperScript helper(commands);
    FarFile far;
    const std::string message =
        message_of<io::InputError>([&] { (void)far.file().describe(0, 0); });
    EXPECT_TRUE(message.starts_with("image.ims: ")) << message;
    EXPECT_FALSE(contains(message, "\n")) << message;
    EXPECT_TRUE(children().empty());
    return message;
}

void expect_same_places(const std::vector<io::ChunkPlace>& a,
                        const std::vector<io::ChunkPlace>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].offset, b[i].offset);
        EXPECT_EQ(a[i].length, b[i].length);
        EXPECT_EQ(a[i].skipped, b[i].skipped);
    }
}

std::array<std::int64_t, 3> chunks_of(const io::ImageArray& array) {
    std::array<std::int64_t, 3> count{};
    for (std::size_t a = 0; a < 3; ++a) count[a] = (array.shape[a] - 1) / array.chunk[a] + 1;
    return count;
}

/// PyTorch's loaders, for one, fork with stores open.
TEST(LocatedFile, a_fork_has_a_helper_of_its_own_and_leaves_that_of_its_parent) {
    auto file = std::make_unique<io::ChunkFile>(written_by("hdf5") / "image.ims");
    const io::ChunkedImage image = file->describe(0, 0);
    const std::set<pid_t> helper = children();
    ASSERT_EQ(helper.size(), 1U);
    const pid_t fork = ::fork();
    if (fork == 0) {
        // The child's own helper is a child of the child.
        const bool answers = file->describe(0, 0).levels.size() == image.levels.size();
        const std::set<pid_t> own = children();
        file.reset();  // as at the child's end
        ::_exit(answers && own.size() == 1 && own != helper ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(::waitpid(fork, &status, 0), fork);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(file->describe(0, 0).levels.size(), image.levels.size());
    EXPECT_EQ(children(), helper) << "the parent's helper goes on";
}

TEST(LocatedFile, one_helper_answers_all_questions_and_gets_each_page_once) {
    FarFile far;
    io::ChunkFile there = far.file();
    io::ChunkFile here(written_by("hdf5") / "image.ims");
    std::set<pid_t> helpers;
    {
        // In a thread that ends, as opening does.
        io::ChunkedImage image;
        std::thread([&] { image = there.describe(0, 0); }).join();
        helpers = children();
        ASSERT_EQ(helpers.size(), 1U);
        ASSERT_FALSE(image.levels.empty());
        for (const io::ImageArray& level : image.levels) {
            expect_same_places(there.locate(level.id, {0, 0, 0}, chunks_of(level)),
                               here.locate(level.id, {0, 0, 0}, chunks_of(level)));
        }
    }
    std::set<pid_t> now = children();
    EXPECT_TRUE(std::ranges::includes(now, helpers)) << "no other one took its place";
    EXPECT_EQ(now.size(), 2U);
    std::set<std::uint64_t> pages;
    for (const auto& [offset, length] : far.read) {
        EXPECT_TRUE(pages.insert(offset).second) << offset;
        EXPECT_EQ(offset % (256 << 10), 0U);
        EXPECT_LE(offset + length, far.bytes.size());
    }
    EXPECT_GT(pages.size(), 0U);
}

TEST(LocatedFile, a_helper_that_the_system_has_ended_is_replaced) {
    const auto store = open_store((written_by("hdf5") / "image.ims").string());
    const std::set<pid_t> helpers = children();
    ASSERT_EQ(helpers.size(), 1U);
    ASSERT_EQ(::kill(*helpers.begin(), SIGKILL), 0);
    const auto again = open_store((written_by("hdf5") / "image.ims").string());
    EXPECT_EQ(volume_of(*store).maximum(), volume_of(*again).maximum());
    EXPECT_FALSE(children().contains(*helpers.begin()));
}

TEST(LocatedFile, what_a_helper_must_not_do_is_one_line) {
    EXPECT_TRUE(contains(refusal_of_far("kill -SEGV $$"), "crashed"));
    EXPECT_TRUE(contains(refusal_of_far("exec 1>&- 2>&- 4>&-\nexec sleep 1000000"), "killed"));
    EXPECT_TRUE(contains(refusal_of_far("read -u 3 question; exit 0"), "without an answer"));
    EXPECT_TRUE(contains(refusal_of_far("echo '{\"error\":\"is odd\"}' >&4; exec sleep 1000000"),
                         "is odd"));
    EXPECT_TRUE(
        contains(refusal_of_far("echo '{\"done\":{}}' >&4; exec sleep 1000000"), "sensible"));
    for (const char* part :
         {"[0,0]", "[0,262145]", "[999999999999,1]", "[-1,5]", "[18446744073709551615,2]"}) {
        const std::string asks =
            "echo '{\"read\":" + std::string(part) + "}' >&4; exec sleep 1000000";
        EXPECT_TRUE(contains(refusal_of_far(asks), "outside the file")) << part;
    }
    EXPECT_TRUE(
        contains(refusal_of_far("echo '{\"read\":\"much\"}' >&4; exec sleep 1000000"), "sensible"));
    // It never ends to ask, for the whole of what it may have.
    FarFile far;
    far.bytes.resize(1 << 18);
    const HelperScript helper(
        "cat <&3 >/dev/null 4>&- &\nwhile echo '{\"read\":[0,262144]}' >&4; do :; done");
    io::ChunkFile file = far.file();
    EXPECT_TRUE(contains(message_of<io::InputError>([&] { (void)file.describe(0, 0); }),
                         "too large to be read"));
    EXPECT_EQ(far.read.size(), 2048U);
}

TEST(LocatedFile, a_helper_that_hangs_and_one_that_does_not_listen_are_left_when_asked_to) {
    for (const bool asks : {false, true}) {
        const std::string line = "{\"read\":[0,262144]}\n";  // three of them at once
        const std::string question = "cat >&4 <<E\n" + line + line + line + "E\n";
        const HelperScript helper((asks ? question : "") + "exec sleep 1000000");
        FarFile far;
        far.bytes.resize(1 << 18);
        std::atomic<int> reads{0};
        far.before = [&] { ++reads; };
        io::ChunkFile file = far.file();
        std::stop_source stop;
        std::jthread stopper([&] {
            EXPECT_TRUE(
                support::comes_true([&] { return asks ? reads.load() > 0 : !children().empty(); }));
            stop.request_stop();
        });
        EXPECT_THROW((void)file.describe(0, 0, stop.get_token()), Cancelled);
        EXPECT_TRUE(children().empty());
        EXPECT_LE(far.read.size(), 1U) << "a part is sent before the next one is heard";
    }
}

TEST(LocatedFile, who_is_stopped_while_a_part_is_fetched_asks_no_more_and_the_next_one_gets_all) {
    FarFile far;
    io::ChunkFile file = far.file();
    std::stop_source stop;
    far.before = [&] { stop.request_stop(); };
    EXPECT_THROW((void)file.describe(0, 0, stop.get_token()), Cancelled);
    EXPECT_EQ(far.read.size(), 1U);
    EXPECT_TRUE(children().empty());
    far.before = {};
    EXPECT_FALSE(file.describe(0, 0).levels.empty());
}

TEST(LocatedFile, who_waits_for_its_turn_stops_while_another_one_still_reads) {
    FarFile far;
    const auto located = std::make_shared<LocatedFile>(far.file(), "image.ims");
    const auto objects = folder_objects(written_by("hdf5"));
    const ChunkedArray array = located_volume(located->file.describe(0, 0), located, {}).arrays[0];
    ASSERT_EQ(::kill(*children().begin(), SIGKILL), 0);  // the next one reads all anew
    const ChunkReader one(objects, array), other(objects, array);
    std::latch reads(1), go_on(1);
    std::once_flag first;
    far.before = [&] {
        std::call_once(first, [&] {
            reads.count_down();
            go_on.wait();
        });
    };
    const std::array<std::int64_t, 3> chunk{};
    std::jthread reader([&] { EXPECT_TRUE(one.chunk(chunk, {})); });
    reads.wait();
    std::stop_source stop;
    std::jthread waiter(
        [&] { EXPECT_THROW((void)other.chunk(chunk, stop.get_token()), Cancelled); });
    stop.request_stop();
    waiter.join();
    go_on.count_down();
}

TEST(LocatedFile, threads_share_the_turns_of_a_file_and_the_stop_of_one_is_not_that_of_others) {
    FarFile far;
    const auto located = std::make_shared<LocatedFile>(far.file(), "image.ims");
    std::vector<std::unique_ptr<ChunkReader>> readers;
    std::vector<std::optional<Bytes>> right;
    constexpr std::array<std::int64_t, 3> chunk{};
    for (const auto& array : located_volume(located->file.describe(0, 0), located, {}).arrays) {
        const auto objects = folder_objects(written_by("hdf5"));
        right.push_back(ChunkReader(objects, array).chunk(chunk, {}));
        readers.push_back(std::make_unique<ChunkReader>(objects, array));
    }
    std::atomic<int> found{0};
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) {
        threads.emplace_back([&, i] {
            const bool stops = i % 2 == 1;
            std::stop_source stop;
            const std::jthread stopper([&] {
                if (stops) stop.request_stop();
            });
            for (std::size_t l = 0; l < readers.size(); ++l) {
                try {
                    const auto samples = readers[l]->chunk(chunk, stop.get_token());
                    ASSERT_TRUE(samples);
                    EXPECT_EQ(samples, right[l]);
                    ++found;
                } catch (const Cancelled&) {
                    EXPECT_TRUE(stops);
                }
            }
        });
    }
    threads.clear();
    EXPECT_GE(found, 4 * static_cast<int>(readers.size()));
}

TEST(LocatedFile, a_helper_ends_with_its_caller) {
    int pipe[2];
    ASSERT_EQ(::pipe2(pipe, O_CLOEXEC), 0);
    const pid_t caller = ::fork();
    if (caller == 0) {
        io::ChunkFile file(written_by("hdf5") / "image.ims");
        (void)file.describe(0, 0);
        const pid_t helper = *children().begin();
        (void)!::write(pipe[1], &helper, sizeof helper);
        ::kill(::getpid(), SIGKILL);
    }
    pid_t helper = 0;
    ASSERT_EQ(::read(pipe[0], &helper, sizeof helper), static_cast<ssize_t>(sizeof helper));
    ::waitpid(caller, nullptr, 0);
    for (const int end : pipe) ::close(end);
    EXPECT_TRUE(support::comes_true([&] {
        std::string name, state;
        std::ifstream("/proc/" + std::to_string(helper) + "/stat") >> state >> name >> state;
        return state.empty() || state == "Z" || state == "X";
    }));
}

}  // namespace
}  // namespace palpate::stream::test
