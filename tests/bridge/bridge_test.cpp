// The bridge's thread and its peers, without a run.
#include "bridge/bridge.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

#include "bridge/sockets.hpp"
#include "support/eventually.hpp"
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

/// A socket to a bridge that never waits.
class Plug {
  public:
    explicit Plug(int port) : socket_(connect_to("127.0.0.1", port)) {}
    ~Plug() { ::close(socket_); }
    Plug(const Plug&) = delete;
    Plug& operator=(const Plug&) = delete;
    void say(const std::string& bytes) const {
        ASSERT_TRUE(comes_true([&] { return is_connected(socket_); }));
        ASSERT_TRUE(comes_true([&] {
            return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
                   ssize_t(bytes.size());
        }));
    }

  private:
    int socket_;
};

bool is_noted(Bridge& bridge, const std::string& text) {
    return comes_true([&] {
        for (const std::string& note : bridge.notes()) {
            if (contains(note, text)) return true;
        }
        return false;
    });
}

TEST(Bridge, requests_that_are_too_many_are_refused_and_those_taken_keep_their_order) {
    Bridge bridge(at_port(0));
    const Plug plug(bridge.port());
    std::string all;
    for (int i = 0; i < 200; ++i) {
        all += message("STRING", "", string_body("isovalue " + std::to_string(i)), 0);
    }
    plug.say(all + message("GET_POLYDATA", "", "", 0));
    // While nobody takes them.
    EXPECT_TRUE(is_noted(bridge, "is connected"));
    std::vector<Request> requests;
    EXPECT_TRUE(comes_true([&] {
        for (Request& one : bridge.requests()) requests.push_back(std::move(one));
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
    Bridge bridge(at_port(0));
    const Plug good(bridge.port());
    const Plug bad(bridge.port());
    bad.say(std::string(100, 'x'));
    EXPECT_TRUE(is_noted(bridge, "was disconnected: it sent"));
    good.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(comes_true([&] { return !bridge.requests().empty(); }));
}

TEST(Bridge, a_peer_that_reads_nothing_holds_nobody_up) {
    Bridge bridge(at_port(0));
    const Plug deaf(bridge.port());
    EXPECT_TRUE(is_noted(bridge, "is connected"));
    const Snapshot state;
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 20'000; ++i) bridge.show(state, false);
    // By far less than a servo's tick each, whatever the network does.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
    const Plug good(bridge.port());
    good.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(comes_true([&] { return !bridge.requests().empty(); }));
}

TEST(Bridge, many_peers_that_come_and_go_leave_it_working) {
    Bridge bridge(at_port(0));
    for (int round = 0; round < 30; ++round) {
        const Plug one(bridge.port()), other(bridge.port());
        one.say(message("STRING", "", string_body("freeze on"), 0).substr(0, 30 + round % 20));
        bridge.show({}, false);
        bridge.reply(round, "gone already");
    }
    const Plug last(bridge.port());
    last.say(message("STRING", "", string_body("freeze on"), 0));
    EXPECT_TRUE(comes_true([&] { return !bridge.requests().empty(); }));
}

}  // namespace
}  // namespace palpate::bridge
