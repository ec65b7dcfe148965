// However a live session ends, the device that it talked to is left without force: the program
// against a stand-in for Haply's service, which sees what arrives.
#include <atomic>

#include "apps/program.hpp"
#include "devices/haply/messages.hpp"
#include "devices/haply/mock_service.hpp"

namespace palpate::app::test {
namespace {

using support::MockService;

/// A hand that comes down onto the sphere's top and stays 4 mm inside, wherever messages are asked
/// for. Service axes [m]: z is up; the device's workspace is centred at (-0.007, -0.068, 0.13).
class PressedSphere {
  public:
    explicit PressedSphere(MockService& service) : service_(service) {
        service.greet(support::snapshot({support::whole_device("049D", position(0))}));
        service.answer([this](const std::string&) {
            return MockService::Reply{support::moved("049D", position(++asked_))};
        });
    }
    Words words() const {
        return words_of(
            "touch synthetic:sphere:32x32x32 --scale 0.5 --device "
            "haply:host=127.0.0.1,port=" +
            std::to_string(service_.port()));
    }
    /// True once forces arrive that push out of the sphere.
    bool is_felt() const {
        return comes_true([&] {
            const auto forces = service_.forces();
            return !forces.empty() && forces.back()[2] > 0.5;
        });
    }

  private:
    static Vec3 position(std::int64_t asked) {
        // Out and in again, should the machine have stalled: forces wait for a hand to withdraw.
        const double depth = std::min(0.06, 2e-5 * static_cast<double>(asked % 10000));
        return {-0.007, -0.068, 0.13 + 0.08 - depth};
    }

    MockService& service_;
    std::atomic<std::int64_t> asked_{0};
};

/// Signals that the program handles itself: it completes its files. All others end it as they would
/// without a session.
int expected_status(int signal) {
    const bool handled =
        signal == SIGINT || signal == SIGTERM || signal == SIGHUP || signal == SIGQUIT;
    return handled ? 128 + signal : 1000 + signal;
}

class EndOfSession : public testing::TestWithParam<int> {};

TEST_P(EndOfSession, leaves_no_force_on_the_device) {
    const ScratchFolder folder;
    MockService service;
    PressedSphere sphere(service);
    Running running(sphere.words() + Words{"--record", "r.csv"}, folder.path());
    ASSERT_TRUE(sphere.is_felt()) << running.finish(SIGINT).err;
    const Outcome end = running.finish(GetParam());
    EXPECT_EQ(end.status, expected_status(GetParam())) << end.err;
    ASSERT_TRUE(comes_true([&] { return service.forces().back().isZero(0); }));
    succeeds(folder, "replay r.csv --validate");
}

INSTANTIATE_TEST_SUITE_P(Signals, EndOfSession,
                         testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGSEGV, SIGABRT,
                                         SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU, SIGVTALRM, SIGPROF,
                                         SIGIO, SIGSYS, SIGTRAP, SIGPWR, SIGSTKFLT, 34, 64));

TEST(Touch, cannot_be_suspended_while_there_is_force) {
    const ScratchFolder folder;
    MockService service;
    PressedSphere sphere(service);
    Running running(sphere.words(), folder.path());
    ASSERT_TRUE(sphere.is_felt());
    for (const int s : {SIGTSTP, SIGTTIN, SIGTTOU, SIGPIPE, SIGXFSZ}) running.signal(s);
    const auto messages = service.messages();
    EXPECT_TRUE(comes_true([&] { return service.messages() > messages + 200; }));
    EXPECT_EQ(running.finish(SIGINT).status, 130);
}

TEST(Touch, can_be_interrupted_while_a_driver_opens_its_device_for_ever) {
    const ScratchFolder folder;
    support::put_bytes(folder / "seen", "");
    Running running(
        {"-c", "MOCK_DHD_HANGS=seen exec " PALPATE_PROGRAM
               " touch synthetic:sphere:32x32x32 --device forcedimension:library=" MOCK_DRD},
        folder.path(), Stdout::captured, "/bin/sh");
    const std::filesystem::path seen = std::filesystem::canonical(folder / "seen");
    ASSERT_TRUE(comes_true([&] { return running.waits_with(seen); }));
    running.signal(SIGINT);
    ASSERT_TRUE(comes_true([&] { return running.has_ended(); }));
    EXPECT_EQ(running.finish().status, 130);
}

TEST(Touch, waits_for_a_service_that_goes_away_while_pressing_and_goes_on) {
    const ScratchFolder folder;
    MockService service;
    PressedSphere sphere(service);
    Running running(sphere.words() + Words{"--record", "r.csv"}, folder.path());
    ASSERT_TRUE(sphere.is_felt());
    const int before = service.connections();
    service.hang(true);  // stays away until the loss is told
    service.drop();
    EXPECT_TRUE(comes_true([&] { return running.has_said("device haply: lost"); }));
    service.hang(false);
    EXPECT_TRUE(comes_true([&] { return service.connections() > before; }));
    EXPECT_TRUE(comes_true([&] { return service.forces().back().isZero(0); }));
    EXPECT_EQ(running.finish(SIGINT).status, 130);
    succeeds(folder, "replay r.csv --validate");
}

}  // namespace
}  // namespace palpate::app::test
