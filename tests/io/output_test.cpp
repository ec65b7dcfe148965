// Output is whole or not there.
#include "palpate/io/output.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <functional>
#include <thread>

#include "io/system/system.hpp"
#include "palpate/io/volume_file.hpp"
#include "support/edits.hpp"
#include "support/eventually.hpp"
#include "support/fields.hpp"
#include "support/scratch_folder.hpp"
#include "support/traced_process.hpp"

using namespace palpate::io;
using namespace palpate::support;

namespace {

using Names = std::vector<std::string>;

std::string failure(const std::filesystem::path& target) {
    return message_of<OutputError>([&] {
        PendingFile file(target);
        file.write("text");
        file.commit();
    });
}

}  // namespace

TEST(Output, appears_only_when_committed) {
    const ScratchFolder folder;
    PendingFile file(folder / "a.csv");
    file.write("one ");
    file.write("two");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
    file.commit();
    EXPECT_EQ(bytes_of(folder / "a.csv"), "one two");
    EXPECT_EQ(folder.names(), Names{"a.csv"});
}

TEST(Output, leaves_nothing_behind_and_the_old_file_whole_without_a_commit) {
    const ScratchFolder folder;
    put_bytes(folder / "a.csv", "old");
    {
        PendingFile file(folder / "a.csv");
        file.write(std::string(5 << 20, 'x'));
        EXPECT_EQ(folder.names().size(), 2U);
    }
    EXPECT_EQ(folder.names(), Names{"a.csv"});
    EXPECT_EQ(bytes_of(folder / "a.csv"), "old");
    try {
        PendingFile file(folder / "b.csv");
        throw std::runtime_error("interrupted");
    } catch (const std::runtime_error&) {
    }
    EXPECT_EQ(folder.names(), Names{"a.csv"});
}

TEST(Output, replaces_a_file_and_keeps_its_mode) {
    const ScratchFolder folder;
    put_bytes(folder / "a.csv", "old");
    std::filesystem::permissions(folder / "a.csv", std::filesystem::perms{0640});
    PendingFile file(folder / "a.csv");
    file.write("new");
    file.commit();
    EXPECT_EQ(bytes_of(folder / "a.csv"), "new");
    EXPECT_EQ(std::filesystem::status(folder / "a.csv").permissions(),
              std::filesystem::perms{0640});
}

TEST(Output, replaces_a_file_where_there_are_no_modes) {
    const ScratchFolder folder;
    const auto write_twice = [&] {
        deny_modes();
        const palpate::Volume volume = noise_of(palpate::SampleType::uint8, grid({4, 4, 4}), 1);
        for (int i = 0; i < 2; ++i) {
            write_file(folder / "a.csv", "text");
            write_volume(volume, folder / "a.nrrd");
        }
    };
    EXPECT_EQ(end_of(start_process(write_twice)), 0);
    EXPECT_EQ(folder.names(), (Names{"a.csv", "a.nrrd"}));
}

TEST(Output, has_the_mode_of_any_new_file) {
    const ScratchFolder folder;
    const mode_t before = ::umask(027);
    PendingFile file(folder / "a.csv");
    file.commit();
    ::umask(before);
    EXPECT_EQ(std::filesystem::status(folder / "a.csv").permissions(),
              std::filesystem::perms{0640});
}

TEST(Output, larger_than_its_buffer_is_whole) {
    const ScratchFolder folder;
    std::string expected;
    PendingFile file(folder / "a.bin");
    for (int i = 0; i < 300; ++i) {
        const std::string part(static_cast<std::size_t>(i * 97), static_cast<char>(i));
        expected += part;
        file.write(part);
    }
    const std::string large(3'000'001, 'l');
    file.write(large);
    file.commit();
    EXPECT_EQ(bytes_of(folder / "a.bin"), expected + large);
}

TEST(Output, into_two_files_of_one_folder_at_once_keeps_them_apart) {
    const ScratchFolder folder;
    PendingFile a(folder / "same.csv");
    PendingFile b(folder / "same.csv");
    a.write("a");
    b.write("b");
    b.commit();
    a.commit();
    EXPECT_EQ(bytes_of(folder / "same.csv"), "a");
    EXPECT_EQ(folder.names(), Names{"same.csv"});
}

TEST(Output, to_a_folder_or_into_one_that_is_missing_says_so_in_one_line) {
    const ScratchFolder folder;
    put_bytes(folder / "file", "");
    const std::string is_folder = failure(folder.path());
    EXPECT_TRUE(contains(is_folder, "is a folder")) << is_folder;
    EXPECT_TRUE(contains(failure(folder.path() / ""), "is a folder"));
    const std::string missing = failure(folder / "none" / "a.csv");
    EXPECT_TRUE(contains(missing, "the folder " + (folder / "none").string() + " does not exist"))
        << missing;
    const std::string through_file = failure(folder / "file" / "a.csv");
    EXPECT_TRUE(contains(through_file, "ot a")) << through_file;
    EXPECT_TRUE(contains(failure(folder / std::string(300, 'n')), "a shorter name"));
    for (const auto& message : {is_folder, missing, through_file, failure("")}) {
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
    EXPECT_EQ(folder.names(), Names{"file"});
}

TEST(Output, to_a_full_disk_is_an_error_and_leaves_the_device_alone) {
    const ScratchFolder folder;
    std::filesystem::create_symlink("/dev/full", folder / "full.csv");
    const std::string message = failure(folder / "full.csv");
    EXPECT_TRUE(contains(message, "No space left")) << message;
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "full.csv"));
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

/// Limits how large a file may grow while it lives: a full disk, as far as writers can tell.
class SmallDisk {
  public:
    explicit SmallDisk(rlim_t bytes) : old_action_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit small{bytes, old_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &small);
    }
    ~SmallDisk() {
        ::setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, old_action_);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

  private:
    rlimit old_{};
    void (*old_action_)(int);
};

void expect_together_or_not_at_all() {
    const ScratchFolder folder;
    put_bytes(folder / "a.csv", "old");
    const auto commit_with = [&](std::size_t bytes_of_the_second, bool blocked) {
        PendingFile first(folder / "a.csv"), second(folder / "b.csv"), third(folder / "c.csv");
        first.write("new");
        second.write(std::string(bytes_of_the_second, 'x'));
        third.write("third");
        if (blocked) std::filesystem::create_directory(folder / "c.csv");
        PendingFile::commit_together({&first, &second, &third});
    };
    const auto expect_nothing_new = [&](const Names& names) {
        EXPECT_EQ(bytes_of(folder / "a.csv"), "old");
        EXPECT_EQ(folder.names(), names);
    };
    {
        const SmallDisk disk(1000);
        EXPECT_TRUE(contains(message_of<OutputError>([&] { commit_with(2000, false); }),
                             "b.csv: could not be written: File too large"));
    }
    expect_nothing_new({"a.csv"});
    EXPECT_TRUE(contains(message_of<OutputError>([&] { commit_with(1, true); }),
                         "c.csv: could not be put in place"));
    expect_nothing_new({"a.csv", "c.csv"});
    std::filesystem::remove(folder / "c.csv");
    commit_with(1, false);
    EXPECT_EQ(bytes_of(folder / "a.csv"), "new");
    EXPECT_EQ(folder.names(), (Names{"a.csv", "b.csv", "c.csv"}));
}

TEST(Output, of_several_files_appears_together_or_not_at_all) {
    expect_together_or_not_at_all();
}

TEST(Output, of_several_files_appears_together_also_where_names_cannot_be_exchanged) {
    EXPECT_EQ(end_of(start_process([] {
                  deny_exchange();
                  expect_together_or_not_at_all();
                  if (testing::Test::HasFailure()) throw std::runtime_error("see above");
              })),
              0);
}

/// Calls wait() while signals come that restart what they interrupt. The first one may come before
/// the wait, and does not end it.
void among_signals(const std::function<void()>& wait) {
    const auto before = std::signal(SIGUSR1, [](int) {});
    const pthread_t waiting = ::pthread_self();
    std::atomic<bool> ended{false};
    std::thread sender([&] {
        while (!ended) {
            ::pthread_kill(waiting, SIGUSR1);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    });
    wait();
    ended = true;
    sender.join();
    std::signal(SIGUSR1, before);
}

TEST(Output, to_a_pipe_that_nobody_reads_is_waited_for_until_a_signal_comes) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    among_signals([&] {
        EXPECT_TRUE(contains(message_of<WaitEnded>([&] { PendingFile file(folder / "pipe"); }),
                             "start the reader first"));
    });
    EXPECT_EQ(folder.names(), Names{"pipe"});
}

TEST(Output, to_a_pipe_whose_reader_does_not_read_on_is_waited_for_until_a_signal_comes) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const int reader = ::open((folder / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
    among_signals([&] {
        const std::string message = message_of<WaitEnded>([&] {
            PendingFile file(folder / "pipe");
            file.write(std::string(10'000'000, 'x'));  // more than a pipe holds
        });
        EXPECT_TRUE(contains(message, "let its reader read on")) << message;
    });
    ::close(reader);
    EXPECT_EQ(folder.names(), Names{"pipe"});
}

TEST(Output, to_a_pipe_that_is_full_ends_when_the_caller_does_not_wait_for_it) {
    struct Enough {};
    const auto wait = [] { throw Enough{}; };
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    EXPECT_TRUE(write_all(ends[1], "text", wait));
    EXPECT_THROW(write_all(ends[1], std::string(10'000'000, 'x'), wait), Enough);
    ::close(ends[0]);
    ::close(ends[1]);
}

TEST(Output, to_a_pipe_whose_reader_has_gone_does_not_end_the_program) {
    const auto before = std::signal(SIGPIPE, SIG_DFL);
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    ::close(ends[0]);
    EXPECT_FALSE(write_all(ends[1], "text"));
    EXPECT_EQ(errno, EPIPE);
    ::close(ends[1]);
    std::signal(SIGPIPE, before);
}

TEST(Output, that_waits_for_the_others_of_its_run_is_still_locked) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::string received;
    bool locked = false;
    std::thread reader([&] {
        std::ifstream pipe(folder / "pipe");
        received += static_cast<char>(pipe.get());  // the first output is complete by now
        const int temporary = ::open((folder / folder.names().at(0)).c_str(), O_RDONLY);
        locked = temporary >= 0 && ::flock(temporary, LOCK_EX | LOCK_NB) != 0;
        ::close(temporary);
        received.append(std::istreambuf_iterator<char>(pipe), {});
    });
    PendingFile second(folder / "pipe"), first(folder / "a.csv");
    first.write("x");
    second.write(std::string(500'000, 'x'));  // more than a pipe holds
    PendingFile::commit_together({&first, &second});
    reader.join();
    EXPECT_EQ(received.size(), 500'000U);
    EXPECT_TRUE(locked);
    EXPECT_EQ(folder.names(), (Names{"a.csv", "pipe"}));
}

TEST(Output, past_the_limit_of_a_file_is_an_error_and_leaves_nothing_behind) {
    const ScratchFolder folder;
    const SmallDisk disk(1 << 20);
    const std::string message = message_of<OutputError>([&] {
        PendingFile file(folder / "a.bin");
        for (int i = 0; i < 100; ++i) file.write(std::string(100'000, 'x'));
        file.commit();
    });
    EXPECT_TRUE(contains(message, "File too large")) << message;
    EXPECT_TRUE(folder.names().empty());
}

TEST(Output, follows_a_symbolic_link_to_the_file_it_names) {
    const ScratchFolder folder;
    put_bytes(folder / "real.csv", "old");
    std::filesystem::create_symlink("real.csv", folder / "link.csv");
    PendingFile file(folder / "link.csv");
    file.write("new");
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.csv"));
    EXPECT_EQ(bytes_of(folder / "real.csv"), "new");
}

TEST(Output, follows_links_to_a_file_that_is_not_there_yet) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "in");
    std::filesystem::create_symlink("in/next", folder / "link.csv");
    std::filesystem::create_symlink("new.csv", folder / "in/next");
    EXPECT_TRUE(is_same_file(folder / "link.csv", folder / "in/new.csv"));
    PendingFile file(folder / "link.csv");
    file.write("new");
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.csv"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "in/next"));
    EXPECT_EQ(bytes_of(folder / "in/new.csv"), "new");
}

TEST(Output, goes_straight_into_a_pipe) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = bytes_of(folder / "pipe"); });
    {
        PendingFile file(folder / "pipe");
        file.write("through");
        file.commit();
    }
    reader.join();
    EXPECT_EQ(received, "through");
    EXPECT_EQ(folder.names(), Names{"pipe"});
}

TEST(Output, to_a_dash_is_standard_output) {
    testing::internal::CaptureStdout();
    PendingFile file("-");
    file.write("to the terminal\n");
    file.commit();
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "to the terminal\n");
    EXPECT_FALSE(std::filesystem::exists("-"));
}
