// Text from files, pipes and devices: every wait ends, and so does every stream.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <thread>

#include "palpate/io/csv.hpp"
#include "support/eventually.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate::io;
using namespace palpate::support;

namespace {

std::string refusal_of_text(const std::filesystem::path& path) {
    const std::string message = message_of<InputError>([&] { (void)read_text(path); });
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    EXPECT_FALSE(contains(message, "\n")) << message;
    return message;
}

}  // namespace

TEST(Text, from_a_device_without_end_is_refused_where_it_is_no_text) {
    EXPECT_TRUE(contains(refusal_of_text("/dev/zero"), "is not a text file"));
    EXPECT_TRUE(contains(refusal_of_text("/dev/urandom"), "is not a text file"));
}

TEST(Text, with_a_line_that_is_too_long_names_the_line) {
    const ScratchFolder folder;
    put_bytes(folder / "a.csv", "t,x\n\n" + std::string(17 << 20, '1') + "\n2,3\n");
    EXPECT_TRUE(contains(refusal_of_text(folder / "a.csv"), "line 3 is longer"));
    std::string fits;  // longer than that, but in lines that are not
    for (int i = 0; i < 3; ++i) fits += std::string(15 << 20, '1') + "\n";
    put_bytes(folder / "a.csv", fits);
    EXPECT_EQ(read_text(folder / "a.csv"), fits);
}

TEST(Text, larger_than_the_limit_is_refused_before_it_is_read) {
    const ScratchFolder folder;
    put_bytes(folder / "a.csv", "t,x\n");
    std::filesystem::resize_file(folder / "a.csv", std::uintmax_t{1} << 40);  // a hole
    EXPECT_TRUE(contains(refusal_of_text(folder / "a.csv"), "up to 4 GiB"));
}

TEST(Text, of_a_pipe_without_a_writer_is_waited_for_until_the_caller_cancels) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    int calls = 0;
    EXPECT_THROW((void)read_text(folder / "pipe",
                                 [&](double) {
                                     if (++calls == 3) throw Cancelled();
                                 }),
                 Cancelled);
}

/// Whether a thread of this process waits for something.
bool is_waiting(pid_t thread) {
    std::ifstream status("/proc/self/task/" + std::to_string(thread) + "/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("State:")) return contains(line, "S (sleeping)");
    }
    return false;
}

TEST(Text, without_a_caller_to_ask_a_signal_ends_the_wait) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const auto before = std::signal(SIGUSR1, [](int) {});  // restarts what it interrupts
    const pthread_t reader = ::pthread_self();
    std::atomic<bool> ended{false};
    std::thread sender([&] {  // one that comes before the wait does not end it
        while (!ended) {
            ::pthread_kill(reader, SIGUSR1);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    });
    EXPECT_TRUE(contains(refusal_of_text(folder / "pipe"), "interrupted"));
    ended = true;
    sender.join();
    std::signal(SIGUSR1, before);
}

TEST(Text, comes_whole_through_a_pipe_whose_writer_takes_its_time) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const pid_t reader = ::gettid();
    const auto reader_waits = [&] { EXPECT_TRUE(comes_true([&] { return is_waiting(reader); })); };
    std::thread writer([&] {
        reader_waits();
        std::ofstream pipe(folder / "pipe", std::ios::binary);
        for (int i = 0; i < 3; ++i) {
            pipe << "\xEF\xBB\xBF" << i << '\n' << std::flush;
            reader_waits();
        }
    });
    // Only the mark at the beginning is one.
    EXPECT_EQ(read_text(folder / "pipe"),
              "0\n\xEF\xBB\xBF"
              "1\n\xEF\xBB\xBF"
              "2\n");
    writer.join();
}

TEST(Text, of_a_message_that_is_too_long_keeps_whole_characters_of_its_beginning_and_end) {
    for (const std::size_t shift : {0, 1, 2}) {
        std::string middle;
        for (int i = 0; i < 1000; ++i) middle += "\u20ac";  // three bytes each
        const std::string text = std::string(shift, 'a') + middle + std::string(shift, 'z');
        const std::string line = one_line(text);
        const std::size_t gap = line.find(" ... ");
        ASSERT_NE(gap, std::string::npos) << line;
        EXPECT_EQ((gap - shift) % 3, 0U) << line;
        EXPECT_EQ((line.size() - shift - (gap + 5)) % 3, 0U) << line;
        EXPECT_GT(line.size(), 885U);
        EXPECT_LE(line.size(), 895U);
    }
    EXPECT_EQ(one_line("a\n\x7f"), "a  ");
    EXPECT_GT(one_line(std::string(2000, '\xbf')).size(), 885U);  // not UTF-8 at all
}
