// Whether a thread could run or waits, and how much CPU time it had: what the watchdog asks Linux.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "src/servo/clocks.hpp"
#include "support/eventually.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// A thread that computes until it is told to wait, and then waits.
class Thread {
  public:
    ThreadId id() const { return id_; }
    void wait() { computes_ = false; }
    ~Thread() {
        computes_ = false;
        done_ = true;
        done_.notify_all();
    }
    Thread() {
        thread_ = std::jthread([this] {
            id_ = calling_thread();
            known_ = true;
            known_.notify_all();
            while (computes_) {
            }
            done_.wait(false);
        });
        known_.wait(false);
    }

  private:
    ThreadId id_;
    std::atomic<bool> known_{false}, computes_{true}, done_{false};
    std::jthread thread_;
};

TEST(Clocks, a_thread_that_computes_could_run_and_uses_cpu_time) {
    const Thread thread;
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(is_runnable(thread.id()));
    const std::int64_t before = cpu_ns(thread.id());
    EXPECT_TRUE(comes_true([&] { return cpu_ns(thread.id()) > before + 1'000'000; }));
}

TEST(Clocks, a_thread_that_waits_could_not_run_and_uses_none) {
    Thread thread;
    thread.wait();
    ASSERT_TRUE(comes_true([&] { return !is_runnable(thread.id()); }));
    const std::int64_t before = cpu_ns(thread.id());
    for (int i = 0; i < 1000; ++i) ASSERT_FALSE(is_runnable(thread.id()));
    EXPECT_EQ(cpu_ns(thread.id()), before);
}

}  // namespace
