// The bridge's thread and its peers, without a run.
#include "bridge/bridge.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "bridge/sockets.hpp"
#include "support/allocation_counter.hpp"
#include "support/eventually.hpp"
#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::bridge {
namespace {

using support::comes_true;
using support::contains;

Settings at_port(int port) {
    Settings settings;
    settings.port = port;
    return settings;
}

TEST(BridgeSettings, are_a_host_and_a_port) {
    EXPECT_EQ(settings_from("18944", false).host, "127.0.0.1");
    EXPECT_EQ(settings_from("slicer.local:5000", true).port, 5000);
    EXPECT_EQ(settings_from("[::1]:5000", false).host, "::1");
    EXPECT_TRUE(is_local(settings_from("localhost:1", false)));
    EXPECT_FALSE(is_local(settings_from("0.0.0.0:1", false)));
    for (const char* wrong : {"", "x", "-1", "65536", ":5", "127.0.0.1:", "1 "}) {
        EXPECT_THROW(settings_from(wrong, false), std::invalid_argument) << wrong;
    }
    EXPECT_THROW(settings_from("0", true), std::invalid_argument);
}

TEST(Bridge, a_port_that_is_taken_is_an_error_that_says_so) {
    const Bridge first(at_port(0));
    EXPECT_GT(first.port(), 0);
    try {
        const Bridge second(at_port(first.port()));
        FAIL();
    } catch (const std::runtime_error& e) {
        EXPECT_TRUE(contains(e.what(), "choose another port")) << e.what();
    }
}

/// A bridge whose time the test moves on. What crosses a socket takes a moment of the machine's.
struct Stepped {
    Bridge bridge;
    std::chrono::steady_clock::time_point now{std::chrono::hours(1)};

    explicit Stepped(const Settings& settings) : bridge(settings, Pace::by_steps) {}
    void step(std::chrono::milliseconds passed = {}) { bridge.step(now += passed); }
    template <class Condition>
    bool until(Condition&& holds) {
        return comes_true([&] {
            step();
            return holds();
        });
    }
    bool asks() {
        return until([&] { return !bridge.requests().empty(); });
    }
    bool has_noted(const std::string& text) {
        for (const std::string& note : bridge.notes()) told += note + '\n';
        return contains(told, text);
    }
    bool notes(const std::string& text) {
        return until([&] { return has_noted(text); });
    }

    std::string told;
};

/// A socket to a bridge that never waits.
class Plug {
  public:
    explicit Plug(int port) : socket_(connect_to("127.0.0.1", port)) {}
    ~Plug() { ::close(socket_); }
    Plug(const Plug&) = delete;
    Plug& operator=(const Plug&) = delete;
    /// The system takes no more than a few kilobytes that nobody has read.
    void keep_little() const {
        const int bytes = 4096;
        ASSERT_EQ(::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes), 0);
    }
    void say(const std::string& bytes) const {
        ASSERT_TRUE(comes_true([&] { return connection_error(socket_) == 0; }));
        ASSERT_TRUE(comes_true([&] {
            return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
                   ssize_t(bytes.size());
        }));
    }
    void try_to_say(const std::string& bytes) const {
        (void)::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    }

  private:
    int socket_;
};

TEST(Bridge, requests_that_are_too_many_are_refused_and_those_taken_keep_their_order) {
    Stepped s(at_port(0));
    const Plug plug(s.bridge.port());
    std::string all;
    for (int i = 0; i < 200; ++i) {
        all += message("STRING", "", string_body("isovalue " + std::to_string(i)), 0);
    }
    plug.say(all + message("GET_POLYDATA", "", "", 0));
    // While nobody takes them.
    EXPECT_TRUE(s.notes("is connected"));
    std::vector<Request> requests;
    EXPECT_TRUE(s.until([&] {
        for (Request& one : s.bridge.requests()) requests.push_back(std::move(one));
        return requests.size() >= Bridge::most_requests;
    }));
    int last = -1;
    for (const Request& one : requests) {
        const auto* words = std::get_if<WordsAsked>(&one.what);
        if (!words) continue;
        const int number = std::stoi(words->text.substr(9));
        EXPECT_GT(number, last);
        last = number;
    }
}

TEST(Bridge, a_peer_that_sends_garbage_is_disconnected_and_the_others_are_served) {
    Stepped s(at_port(0));
    const Plug good(s.bridge.port());
    const Plug bad(s.bridge.port());
    bad.say(std::string(100, 'x'));
    EXPECT_TRUE(s.notes("was disconnected: it sent"));
    good.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(s.asks());
}

TEST(Bridge, a_peer_that_reads_nothing_holds_nobody_up_and_is_disconnected_after_ten_seconds) {
    Stepped s(at_port(0));
    const Plug deaf(s.bridge.port());
    deaf.keep_little();
    EXPECT_TRUE(s.notes("is connected"));
    // Far more than the system keeps for it.
    for (int i = 0; i < 20'000; ++i) {
        s.bridge.show({}, false);
        s.step();
    }
    constexpr const char* reason = "it took nothing for 10 s";
    s.step(std::chrono::milliseconds(9900));
    EXPECT_FALSE(s.has_noted(reason)) << "too early";
    s.step(std::chrono::milliseconds(200));
    EXPECT_TRUE(s.has_noted(reason));
    const Plug good(s.bridge.port());
    good.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(s.asks());
}

TEST(Bridge, a_client_tries_again_each_second_until_there_is_a_server) {
    // A port that nobody listens at: that of a server that has gone.
    const int port = Bridge(at_port(0), Pace::by_steps).port();
    Stepped client(settings_from(std::to_string(port), true));
    client.step();
    Stepped server(at_port(port));
    for (int i = 0; i < 20; ++i) {
        client.step();
        server.step();
    }
    EXPECT_FALSE(server.has_noted("is connected")) << "only after a second";
    client.step(std::chrono::milliseconds(1000));
    EXPECT_TRUE(server.notes("is connected"));
    EXPECT_TRUE(client.notes("is connected"));
}

TEST(Bridge, many_peers_that_come_and_go_leave_it_working) {
    Stepped s(at_port(0));
    for (int round = 0; round < 30; ++round) {
        const Plug one(s.bridge.port()), other(s.bridge.port());
        one.say(message("STRING", "", string_body("freeze on"), 0).substr(0, 30 + round % 20));
        s.step();
        s.bridge.show({}, false);
        s.bridge.reply(round, "gone already");
        s.step();
    }
    const Plug last(s.bridge.port());
    last.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(s.asks());
}

/// The beginning of an IMAGE with a body of so many bytes.
std::string image_of(std::size_t body, std::size_t sent) {
    return message("IMAGE", "", std::string(body, 'x'), 0).substr(0, header_bytes + sent);
}

TEST(Bridge, peers_together_hold_no_more_than_the_bound_and_the_largest_goes_first) {
    Settings settings = at_port(0);
    settings.limits.image = 400'000;
    settings.limits.together = 550'000;
    Stepped s(settings);
    const Plug small(s.bridge.port()), large(s.bridge.port()), late(s.bridge.port());
    EXPECT_TRUE(s.notes("client 3 is connected"));
    small.say(image_of(100'000, 60'000));
    large.say(image_of(400'000, 20'000));
    for (int i = 0; i < 18; ++i) {
        large.say(std::string(20'000, 'x'));
        s.step();
    }
    EXPECT_FALSE(s.has_noted("was disconnected"));
    late.say(image_of(100'000, 60'000));
    EXPECT_TRUE(s.notes("was disconnected: all clients together may send 550000 bytes")) << s.told;
    EXPECT_TRUE(contains(s.told, "client 2 was disconnected")) << s.told;
    EXPECT_FALSE(contains(s.told, "client 1 was disconnected")) << s.told;
}

/// Exits with 0 if a peer that sends too much is disconnected and another one is served.
[[noreturn]] void serve_in_little_memory() {
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t most = pages * 4096 + (rlim_t{48} << 20);
    const rlimit limit{most, most};
    ::setrlimit(RLIMIT_AS, &limit);
    Stepped s(at_port(0));
    const Plug bad(s.bridge.port()), good(s.bridge.port());
    std::string header = message("IMAGE", "", "", 0);
    header.replace(42, 8, std::string("\0\0\0\0\x20\0\0\0", 8));  // of 512 MiB
    bad.say(header);
    const std::string piece(1 << 16, 'x');
    for (int i = 0; i < 3000 && !s.has_noted("memory does not suffice"); ++i) {
        bad.try_to_say(piece);
        s.step();
    }
    const bool is_dropped = s.has_noted("memory does not suffice");
    good.say(message("STRING", "", string_body("freeze on"), 0));
    std::_Exit(is_dropped && s.asks() ? 0 : 1);
}

TEST(Bridge, a_peer_that_sends_more_than_there_is_memory_for_goes_and_others_are_served) {
    if (support::is_slow_build) GTEST_SKIP() << "sanitizers reserve terabytes of addresses";
    EXPECT_EXIT(serve_in_little_memory(), testing::ExitedWithCode(0), "");
}

TEST(Bridge, a_peer_for_which_there_is_no_memory_goes_without_a_word) {
    Stepped s(at_port(0));
    const Plug bad(s.bridge.port()), good(s.bridge.port());
    EXPECT_TRUE(s.notes("client 2 is connected"));
    bad.say(std::string(100, 'x'));
    {
        const support::DeniedAllocations denied(65, 1 << 20);  // not what poll() needs
        for (int i = 0; i < 100; ++i) {  // what was said takes a moment to arrive
            s.step();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    good.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(s.asks());
}

TEST(PacedBridge, serves_peers_by_itself) {
    Bridge bridge(at_port(0));
    const Plug plug(bridge.port());
    plug.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(comes_true([&] { return !bridge.requests().empty(); }));
}

}  // namespace
}  // namespace palpate::bridge
