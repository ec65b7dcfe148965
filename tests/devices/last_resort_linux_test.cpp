// What a crash leaves behind: zero force, sent before the program ends. Each crash is a child
// process's; a file that it shares stands for the motors.
#include "palpate/devices/last_resort.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "devices/link.hpp"

namespace palpate::devices {
namespace {

using namespace std::chrono_literals;

/// A device with a thread of its own, as every backend has; the last force it sent is in memory
/// that outlives the process.
class Motor : public Device {
  public:
    explicit Motor(std::atomic<double>& sent, std::chrono::milliseconds period = 1ms)
        : sent_(sent), thread_([this, period](std::stop_token stop) {
              prepare_device_thread();
              while (!stop.stop_requested()) {
                  sent_ = link_.wrench().force.norm();
                  std::this_thread::sleep_for(period);
              }
          }) {}
    DeviceInfo info() const override { return {}; }
    DeviceReading read(double) noexcept override { return link_.read(); }
    void write(const Wrench& wrench, double) noexcept override { link_.write(wrench); }
    void stop() noexcept override { link_.stop(); }
    bool is_stopping() const noexcept override { return link_.stopping(); }

  private:
    std::atomic<double>& sent_;
    Link link_;
    std::jthread thread_;
};

struct Shared {
    std::atomic<double> sent{-1}, other{-1}, before{-1};  // by one motor and by a second one
};

/// Presses with 2 N from a thread that goes on and on, as a servo would, until `crash` happens in
/// another. Returns the child's status and the larger force that its two motors sent last.
template <class F>
std::pair<int, double> crashed(bool guarded, F&& crash, std::chrono::milliseconds period = 1ms) {
    void* memory =
        ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    auto* shared = new (memory) Shared;
    const pid_t child = ::fork();
    if (child == 0) {
        std::fclose(stderr);  // what terminate() has to say
        // Sanitizers have handlers of their own.
        for (const int s : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT}) std::signal(s, SIG_DFL);
        Motor motor(shared->sent), second(shared->other, period);
        std::optional<LastResort> last_resort, of_second;
        if (guarded) {
            last_resort.emplace(motor);
            of_second.emplace(second);
        }
        std::jthread servo([&](std::stop_token stop) {
            while (!stop.stop_requested()) {
                motor.write({Vec3(0, 0, 2), Vec3::Zero()}, 0);
                second.write({Vec3(0, 0, 2), Vec3::Zero()}, 0);
                std::this_thread::sleep_for(1ms);
            }
        });
        for (int i = 0; i < 10'000 && (shared->sent != 2 || shared->other != 2); ++i)
            std::this_thread::sleep_for(1ms);
        shared->before = shared->sent.load();
        crash();
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(shared->before, 2);
    const double sent = std::max<double>(shared->sent, shared->other);
    ::munmap(memory, sizeof(Shared));
    return {status, sent};
}

/// A loop without effects would be undefined, and clang leaves it out. The thread sanitizer hands
/// over signals at atomic operations only.
[[noreturn]] void compute_without_end() {
    for (volatile std::atomic<int> i = 0;;) i.fetch_add(1);
}

void expect_let_go(int signal, void (*crash)()) {
    const auto [status, sent] = crashed(true, crash);
    EXPECT_TRUE(WIFSIGNALED(status)) << status;
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(sent, 0);
}

TEST(LastResort, without_it_a_crash_leaves_the_force_on) {
    const auto [status, sent] = crashed(false, [] { std::raise(SIGSEGV); });
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(sent, 2);
}

TEST(LastResort, lets_go_before_a_wild_pointer_ends_the_program) {
    expect_let_go(SIGSEGV, [] {
        void* page = ::mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        *static_cast<volatile int*>(page) = 1;
    });
}

TEST(LastResort, waits_for_a_thread_that_seldom_gets_the_processor) {
    const auto [status, sent] = crashed(
        true, [] { std::raise(SIGSEGV); }, 400ms);
    EXPECT_TRUE(WIFSIGNALED(status)) << status;
    EXPECT_EQ(WTERMSIG(status), SIGSEGV);
    EXPECT_EQ(sent, 0);
}

TEST(LastResort, a_signal_that_comes_again_waits_for_the_zero) {
    for (const int signal : {SIGSYS, SIGUSR1, SIGALRM}) {
        const auto [status, sent] = crashed(
            true,
            [signal] {
                for (int i = 0; i < 5; ++i) {
                    ::kill(::getpid(), signal);
                    std::this_thread::sleep_for(2ms);
                }
                std::this_thread::sleep_for(5s);
            },
            250ms);
        EXPECT_TRUE(WIFSIGNALED(status)) << status;
        EXPECT_EQ(WTERMSIG(status), signal);
        EXPECT_EQ(sent, 0) << signal;
    }
}

TEST(LastResort,
     a_crash_signal_sent_to_the_device_s_thread_does_not_keep_it_from_sending_the_zero) {
    const auto [status, sent] = crashed(true, [] {
        sigset_t all, before;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before);  // so that the devices' threads get it
        ::kill(::getpid(), SIGSYS);
        std::this_thread::sleep_for(50ms);
        ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
        std::this_thread::sleep_for(5s);
    });
    EXPECT_TRUE(WIFSIGNALED(status)) << status;
    EXPECT_EQ(WTERMSIG(status), SIGSYS);
    EXPECT_EQ(sent, 0);
}

TEST(LastResort, lets_go_before_an_exception_that_nobody_catches_does) {
    expect_let_go(SIGABRT, [] {
        std::thread([] { throw std::runtime_error("nobody catches this"); }).join();
    });
}

TEST(LastResort, lets_go_at_every_kind_of_crash) {
    expect_let_go(SIGBUS, [] { std::raise(SIGBUS); });
    expect_let_go(SIGILL, [] { std::raise(SIGILL); });
    expect_let_go(SIGFPE, [] { std::raise(SIGFPE); });
    expect_let_go(SIGTRAP, [] { std::raise(SIGTRAP); });
    expect_let_go(SIGSYS, [] { std::raise(SIGSYS); });
    expect_let_go(SIGABRT, [] { std::abort(); });
}

/// Comes to the process, not to a thread, and is over when the process is.
template <int number>
void expect_let_go_at() {
    expect_let_go(number, [] {
        ::kill(::getpid(), number);
        std::this_thread::sleep_for(10s);
    });
}

TEST(LastResort, lets_go_at_every_signal_that_ends_a_program) {
    expect_let_go_at<SIGHUP>();
    expect_let_go_at<SIGINT>();
    expect_let_go_at<SIGQUIT>();
    expect_let_go_at<SIGTERM>();
    expect_let_go_at<SIGPIPE>();
    expect_let_go_at<SIGALRM>();
    expect_let_go_at<SIGVTALRM>();
    expect_let_go_at<SIGPROF>();
    expect_let_go_at<SIGUSR1>();
    expect_let_go_at<SIGUSR2>();
    expect_let_go_at<SIGXCPU>();
    expect_let_go_at<SIGXFSZ>();
    expect_let_go_at<SIGIO>();
    expect_let_go_at<SIGPWR>();
    expect_let_go_at<SIGSTKFLT>();
    expect_let_go_at<34>();  // the first and the last of the real-time signals
    expect_let_go_at<64>();
}

TEST(LastResort, lets_go_when_the_processor_time_is_used_up) {
    expect_let_go(SIGXCPU, [] {
        const rlimit one_second{1, 10};
        ::setrlimit(RLIMIT_CPU, &one_second);
        compute_without_end();
    });
}

TEST(LastResort, lets_go_when_a_real_time_thread_takes_too_long) {
    const auto [status, sent] = crashed(true, [] {
        const rlimit tenth{100'000, 10'000'000};
        sched_param parameter{};
        parameter.sched_priority = 1;
        ::setrlimit(RLIMIT_RTTIME, &tenth);
        if (::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameter) != 0) ::_exit(77);
        compute_without_end();
    });
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) {
        GTEST_SKIP() << "SCHED_FIFO is not granted here";
    }
    EXPECT_TRUE(WIFSIGNALED(status)) << status;
    EXPECT_EQ(WTERMSIG(status), SIGXCPU);
    EXPECT_EQ(sent, 0);
}

TEST(LastResort, the_thread_that_sends_the_zero_takes_no_signals) {
    static std::atomic<bool> handled = false;
    const auto before = std::signal(SIGUSR1, [](int) { handled = true; });
    std::jthread thread([] {
        prepare_device_thread();
        ::pthread_kill(::pthread_self(), SIGUSR1);
        EXPECT_FALSE(handled);
        sigset_t waiting;
        ::sigpending(&waiting);
        EXPECT_EQ(::sigismember(&waiting, SIGUSR1), 1);
        sigset_t blocked;
        ::pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
        EXPECT_EQ(::sigismember(&blocked, SIGSEGV), 0);
    });
    thread.join();
    std::signal(SIGUSR1, before);
}

TEST(LastResort, two_signals_at_once_wait_for_the_zero_as_one_does) {
    for (int round = 0; round < 10; ++round) {
        const auto [status, sent] = crashed(true, [] {
            std::array<std::jthread, 4> threads;
            const std::array numbers{SIGUSR1, SIGALRM, SIGTERM, SIGIO};
            for (std::size_t i = 0; i < threads.size(); ++i) {
                threads[i] = std::jthread([number = numbers[i]] { std::raise(number); });
            }
        });
        EXPECT_TRUE(WIFSIGNALED(status)) << status;
        EXPECT_EQ(sent, 0);
    }
}

TEST(LastResort, leaves_signals_alone_that_the_application_handles_or_ignores) {
    const auto usr1 = std::signal(SIGUSR1, [](int) {});
    const auto usr2 = std::signal(SIGUSR2, SIG_IGN);
    std::atomic<double> sent;
    Motor motor(sent);
    {
        const LastResort last_resort(motor);
        std::raise(SIGUSR1);
        std::raise(SIGUSR2);
        motor.write({Vec3(0, 0, 2), Vec3::Zero()}, 0);
    }
    EXPECT_NE(std::signal(SIGUSR1, usr1), SIG_DFL);
    EXPECT_EQ(std::signal(SIGUSR2, usr2), SIG_IGN);
    EXPECT_EQ(std::signal(SIGALRM, SIG_DFL), SIG_DFL);  // as it was before
}

// Not inlined, and not turned into a loop: it is the stack that has to run out.
[[gnu::noinline]] int endless(int depth) {  // NOLINT(misc-no-recursion)
    std::array<volatile char, 4096> page;
    page[0] = static_cast<char>(depth);
    return depth < 0 ? 0 : endless(depth + 1) + page[0];
}

TEST(LastResort, lets_go_when_the_stack_runs_out) {
    expect_let_go(SIGSEGV, [] { std::_Exit(endless(0)); });
}

TEST(LastResort, there_is_one_for_each_device) {
    std::atomic<double> sent;
    Motor motor(sent);
    {
        const LastResort first(motor);
        EXPECT_THROW(LastResort second(motor), std::logic_error);
    }
    EXPECT_NO_THROW(LastResort again(motor));
}

}  // namespace
}  // namespace palpate::devices
