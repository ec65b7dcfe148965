// Pieces of work on several threads.
#include "filters/parallel.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

namespace palpate::filters {
namespace {

TEST(Parallel, does_each_piece_once_on_any_number_of_threads) {
    for (const int threads : {0, 1, 2, 5}) {
        for (const int count : {0, 1, 2, 1000}) {
            std::vector<int> done(std::size_t(count), 0);
            in_parallel(threads)(count, [&](int i) { ++done[std::size_t(i)]; });
            EXPECT_EQ(done, std::vector<int>(std::size_t(count), 1)) << threads;
        }
    }
}

TEST(Parallel, throws_what_a_piece_has_thrown_on_another_thread) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "there is one processor";
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> thrown{false};
    const auto work = [&](int) {
        if (std::this_thread::get_id() == caller) return thrown.wait(false);
        thrown = true;
        thrown.notify_all();
        throw std::runtime_error("no memory");
    };
    EXPECT_THROW(in_parallel(2)(100, work), std::runtime_error);
}

#ifdef __linux__
TEST(Parallel, needs_no_more_threads_than_the_system_gives) {
    pthread_attr_t usual, too_large;
    ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
    ASSERT_EQ(pthread_getattr_default_np(&too_large), 0);
    ASSERT_EQ(pthread_attr_setstacksize(&too_large, std::size_t{1} << 50), 0);
    ASSERT_EQ(pthread_setattr_default_np(&too_large), 0);
    std::atomic<int> done{0};
    EXPECT_NO_THROW(in_parallel(2)(100, [&](int) { ++done; }));
    EXPECT_THROW(std::thread([] {}).join(), std::system_error);
    EXPECT_EQ(pthread_setattr_default_np(&usual), 0);
    EXPECT_EQ(done, 100);
}
#endif

}  // namespace
}  // namespace palpate::filters
