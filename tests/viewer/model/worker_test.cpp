// Tasks on a thread of their own.
#include <gtest/gtest.h>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>

#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/model/worker.hpp"
#include "support/eventually.hpp"
#include "support/silent_server.hpp"

namespace palpate::viewer {
namespace {

using namespace std::chrono_literals;

void wait_for(const Worker& worker) {
    ASSERT_TRUE(support::comes_true([&] { return worker.ended(); }));
}

TEST(Worker, result_is_there_once_it_has_ended) {
    int result = 0;
    Worker worker([&](const io::Progress&) { result = 7; }, [] {});
    wait_for(worker);
    EXPECT_TRUE(worker.finish());
    EXPECT_EQ(result, 7);
}

TEST(Worker, what_the_task_throws_comes_out_of_finish) {
    Worker worker([](const io::Progress&) { throw std::runtime_error("no such file"); }, [] {});
    wait_for(worker);
    EXPECT_THROW((void)worker.finish(), std::runtime_error);
}

TEST(Worker, a_cancelled_task_stops_at_its_next_progress_and_is_not_done) {
    std::atomic<bool> begun{false};
    Worker worker(
        [&](const io::Progress& progress) {
            for (;;) {
                begun = true;
                progress(0.5);
                std::this_thread::sleep_for(1ms);
            }
        },
        [] {});
    ASSERT_TRUE(support::comes_true([&] { return begun.load(); }));
    worker.cancel();
    wait_for(worker);
    EXPECT_FALSE(worker.finish());
}

TEST(Worker, owner_is_woken_for_each_percent_at_most_and_at_the_end) {
    std::atomic<int> woken{0};
    Worker worker(
        [](const io::Progress& progress) {
            for (int i = 0; i <= 100'000; ++i) progress(i / 100'000.0);
        },
        [&] { ++woken; });
    wait_for(worker);
    EXPECT_EQ(worker.progress(), 1);
    // The last wake comes after ended() is seen.
    EXPECT_TRUE(support::comes_true([&] { return woken >= 50; }));
    EXPECT_LE(woken, 105);
}

TEST(Worker, destroying_it_cancels_the_task) {
    std::atomic<int> turns{0};
    std::atomic<bool> left{false};
    struct Leaves {
        std::atomic<bool>& left;
        ~Leaves() { left = true; }
    };
    {
        const Worker worker(
            [&](const io::Progress& progress) {
                const Leaves leaves{left};
                for (;; ++turns) {
                    progress(0);
                    std::this_thread::sleep_for(1ms);
                }
            },
            [] {});
        ASSERT_TRUE(support::comes_true([&] { return turns >= 3; }));
        EXPECT_FALSE(left);
    }
    EXPECT_TRUE(left);
}

TEST(NewestWorker, waits_for_no_earlier_task_that_notices_late_that_it_was_cancelled) {
    std::atomic<bool> hangs{true}, begun{false};
    std::atomic<int> ended{0};
    {
        NewestWorker worker;
        const auto hang = [&](const io::Progress&) {
            begun = true;
            while (hangs) std::this_thread::sleep_for(1ms);
            ++ended;
        };
        worker.start(hang, [] {});
        ASSERT_TRUE(support::comes_true([&] { return begun.load(); }));
        worker.start([](const io::Progress&) {}, [] {});
        EXPECT_TRUE(support::comes_true([&] { return worker.ended(); }));
        worker.start(hang, [] {});
        worker.cancel();
        EXPECT_FALSE(worker.ended());
        EXPECT_EQ(ended, 0);
        hangs = false;
    }
    EXPECT_GE(ended, 1) << "the first; the second may have been cancelled before it began";
}

TEST(Worker, one_that_opens_a_volume_of_a_silent_server_ends_when_it_is_cancelled) {
    const support::SilentServer server;
    const run::Source source = run::source_from({{"volume", server.address()}});
    Worker worker([&](const io::Progress& progress) { (void)open(source, progress); }, [] {});
    ASSERT_TRUE(support::comes_true([&] { return server.is_asked(); }));
    const auto begin = std::chrono::steady_clock::now();
    worker.cancel();
    wait_for(worker);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 40s) << "of 50; usually 0.03";
    EXPECT_FALSE(worker.finish());
}

using namespace palpate::support;

}  // namespace
}  // namespace palpate::viewer
