// A crash sends zero force before the program ends. Each crash is a child
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

/// A device whose last sent force is in memory that outlives the process.
class Motor : public Device {
  public:
    /// Sends every `period` milliseconds of its own time.
    explicit Motor(std::atomic<double>& sent, int period = 1) : sent_(sent), period_(period) {}
    DeviceInfo info() const override { return {}; }
    DeviceReading read(double) noexcept override { return link_.read(now()); }
    void write(const Wrench& wrench, double) noexcept override { link_.write(wrench, now()); }
    void stop() noexcept override { link_.stop(); }
    bool is_stopping() const noexcept override { return link_.stopping(); }

    void step() noexcept {
        if (++time_ % period_ == 0) sent_ = link_.wrench(now()).force.norm();
    }
    std::int64_t steps() const noexcept { return time_; }

  private:
    std::int64_t now() const noexcept { return time_ * 1'000'000; }

    std::atomic<double>& sent_;
    const int period_;
    std::atomic<std::int64_t> time_{0};  // [ms]
    Link link_;
};

struct Shared {
    std::atomic<double> sent{-1}, other{-1}, before{-1};  // by one motor and by a second one
    std::atomic<int> waited{0};                           // [ms] by the handler
};

/// State of the child process.
struct Child {
    Shared* shared;
    Motor first, second;

    Child(Shared* outside, int period)
        : shared(outside), first(outside->sent), second(outside->other, period) {}
    /// A servo that goes on pressing with 2 N whatever happens, and the motors.
    void step() noexcept {
        for (Motor* motor : {&first, &second}) {
            motor->write({Vec3(0, 0, 2), Vec3::Zero()}, 0);
            motor->step();
        }
    }
};
Child* child = nullptr;

/// Time passes for the child only while its handler waits.
void let_time_pass(int milliseconds) noexcept {
    child->shared->waited += milliseconds;
    for (int i = 0; i < milliseconds; ++i) child->step();
}

/// The same if the motors have a thread: time passes as they step, however seldom that is.
void let_thread_step(int milliseconds) noexcept {
    constexpr int patience = 1000;  // so that a thread that no longer steps fails the test
    const std::int64_t wanted = child->first.steps() + milliseconds;
    for (int i = 0; child->first.steps() < wanted && i < patience; ++i) {
        std::this_thread::sleep_for(1ms);
    }
}

/// Steps on a thread of its own, as in every backend.
struct MotorThread {
    std::jthread thread{[](std::stop_token stop) {
        prepare_device_thread();
        while (!stop.stop_requested()) {
            child->step();
            std::this_thread::sleep_for(1ms);
        }
    }};
};

enum class Motors : std::uint8_t { stepped, threaded };

/// Presses until `crash` happens. Returns the child's status, the larger force that its two motors
/// sent last, and how long the handler waited in virtual time [ms].
struct Crashed {
    int status = 0;
    double sent = -1;
    int waited = 0;
};
template <class F>
Crashed crashed(bool guarded, F&& crash, int period = 1, Motors motors = Motors::stepped) {
    void* memory =
        ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    auto* shared = new (memory) Shared;
    const pid_t process = ::fork();
    if (process == 0) {
        std::fclose(stderr);  // what terminate() has to say
        // Sanitizers have handlers of their own, and shells ignore some signals for `ctest &`.
        for (const int s : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGINT, SIGQUIT, SIGHUP}) {
            std::signal(s, SIG_DFL);
        }
        Child here(shared, period);
        child = &here;
        std::optional<MotorThread> thread;
        if (motors == Motors::threaded) thread.emplace();
        std::optional<LastResort> last_resort, of_second;
        if (guarded) {
            const auto pause = thread ? &let_thread_step : &let_time_pass;
            last_resort.emplace(here.first, pause);
            of_second.emplace(here.second, pause);
        }
        while (shared->sent != 2 || shared->other != 2) {
            if (thread) std::this_thread::sleep_for(1ms);
            if (!thread) here.step();
        }
        shared->before = shared->sent.load();
        crash();
        ::_exit(0);
    }
    Crashed result;
    ::waitpid(process, &result.status, 0);
    EXPECT_EQ(shared->before, 2);
    result.sent = std::max<double>(shared->sent, shared->other);
    result.waited = shared->waited;
    ::munmap(memory, sizeof(Shared));
    return result;
}

/// A loop without effects would be undefined, and clang leaves it out. The thread sanitizer hands
/// over signals at atomic operations only.
[[noreturn]] void compute_without_end() {
    for (volatile std::atomic<int> i = 0;;) i.fetch_add(1);
}

void expect_let_go(int signal, void (*crash)()) {
    const auto [status, sent, waited] = crashed(true, crash);
    EXPECT_TRUE(WIFSIGNALED(status)) << status;
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(sent, 0);
    EXPECT_EQ(waited, 100);  // for devices that cannot tell
}

TEST(LastResort, without_it_a_crash_leaves_the_force_on) {
    const auto [status, sent, waited] = crashed(false, [] { std::raise(SIGSEGV); });
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(sent, 2);
    EXPECT_EQ(waited, 0);
}

TEST(LastResort, lets_go_before_a_wild_pointer_ends_the_program) {
    expect_let_go(SIGSEGV, [] {
        void* page = ::mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        *static_cast<volatile int*>(page) = 1;
    });
}

TEST(LastResort, waits_for_a_thread_that_seldom_gets_the_processor) {
    // It is back from sending the zero when it asks for a force again: after two periods.
    for (const int period : {10, 60, 400, 499}) {
        const auto [status, sent, waited] = crashed(
            true, [] { std::raise(SIGSEGV); }, period);
        EXPECT_TRUE(WIFSIGNALED(status)) << status;
        EXPECT_EQ(WTERMSIG(status), SIGSEGV);
        EXPECT_EQ(sent, 0);
        EXPECT_EQ(waited, std::max(100, (2 * period + 4) / 5 * 5)) << period;
    }
    const auto [status, sent, waited] = crashed(
        true, [] { std::raise(SIGSEGV); }, 5000);
    EXPECT_EQ(WTERMSIG(status), SIGSEGV);
    EXPECT_EQ(sent, 2);  // for no longer than a second
    EXPECT_EQ(waited, 1000);
}

TEST(LastResort, a_signal_that_comes_again_waits_for_the_zero) {
    for (const int signal : {SIGSYS, SIGUSR1, SIGALRM}) {
        const auto [status, sent, waited] = crashed(
            true,
            [signal] {
                for (int i = 0; i < 5; ++i) {
                    ::kill(::getpid(), signal);
                    std::this_thread::sleep_for(2ms);
                }
                std::this_thread::sleep_for(5s);
            },
            120, Motors::threaded);
        EXPECT_TRUE(WIFSIGNALED(status)) << status;
        EXPECT_EQ(WTERMSIG(status), signal);
        EXPECT_EQ(sent, 0) << signal;
    }
}

TEST(LastResort,
     a_crash_signal_sent_to_the_device_s_thread_does_not_keep_it_from_sending_the_zero) {
    const auto [status, sent, waited] = crashed(
        true,
        [] {
            sigset_t all, before;
            ::sigfillset(&all);
            ::pthread_sigmask(SIG_SETMASK, &all, &before);  // so that the devices' threads get it
            ::kill(::getpid(), SIGSYS);
            std::this_thread::sleep_for(50ms);
            ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
            std::this_thread::sleep_for(5s);
        },
        1, Motors::threaded);
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
    const auto [status, sent, waited] = crashed(true, [] {
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
        const auto [status, sent, waited] = crashed(
            true,
            [] {
                std::array<std::jthread, 4> threads;
                const std::array numbers{SIGUSR1, SIGALRM, SIGTERM, SIGIO};
                for (std::size_t i = 0; i < threads.size(); ++i) {
                    threads[i] = std::jthread([number = numbers[i]] { std::raise(number); });
                }
            },
            1, Motors::threaded);
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

TEST(LastResort, gives_crashes_back_to_what_handled_them_before) {
    const auto own = [](int) {};
    const auto before = std::signal(SIGFPE, own);
    std::atomic<double> sent, other_sent;
    Motor motor(sent), other(other_sent);
    {
        const LastResort last_resort(motor);
        const LastResort second(other);
        EXPECT_NE(std::signal(SIGALRM, SIG_DFL), SIG_DFL) << "handled here";
    }
    EXPECT_EQ(std::signal(SIGFPE, before), static_cast<void (*)(int)>(own));
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
