// Tasks on a thread of their own.
#include "apps/viewer/model/worker.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>

#include "support/eventually.hpp"

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

}  // namespace
}  // namespace palpate::viewer
