// A bridge at a host that has several addresses. The name service of this program knows one more
// host than the system's.
#include <dlfcn.h>
#include <netdb.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <cstring>

#include "bridge/bridge.hpp"
#include "bridge/sockets.hpp"
#include "support/eventually.hpp"
#include "support/scratch_folder.hpp"

/// `both.test` has ::1 and 127.0.0.1, in this order.
extern "C" int getaddrinfo(const char* host, const char* service, const addrinfo* wanted,
                           addrinfo** found) {
    const auto next = reinterpret_cast<decltype(&getaddrinfo)>(dlsym(RTLD_NEXT, "getaddrinfo"));
    if (!host || std::strcmp(host, "both.test") != 0) return next(host, service, wanted, found);
    addrinfo* second = nullptr;
    const int error = next("127.0.0.1", service, wanted, &second);
    if (error != 0) return error;
    const int other_error = next("::1", service, wanted, found);
    if (other_error != 0) {
        freeaddrinfo(second);
        return other_error;
    }
    addrinfo* last = *found;
    while (last->ai_next) last = last->ai_next;
    last->ai_next = second;  // freeaddrinfo() frees the whole list
    return 0;
}

namespace palpate::bridge {
namespace {

constexpr std::chrono::seconds one_second{1};

Settings at_host(const std::string& host, int port, bool client = false) {
    Settings settings;
    settings.host = host;
    settings.port = port;
    settings.client = client;
    return settings;
}

struct AtTimes {
    Bridge bridge;
    std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
    std::string told = {};

    void step(std::chrono::seconds passed = {}) {
        bridge.step(now += passed);
        for (const std::string& note : bridge.notes()) told += note + '\n';
    }
    bool tells(const std::string& text) const { return support::contains(told, text); }
};

TEST(BridgeAddresses, a_client_tries_one_after_the_other_and_notes_the_first_failure) {
    AtTimes server{Bridge(at_host("127.0.0.1", 0), Pace::by_steps)};
    AtTimes client{Bridge(at_host("both.test", server.bridge.port(), true), Pace::by_steps)};
    EXPECT_TRUE(support::comes_true([&] {
        client.step();
        return client.tells("no server answers at both.test");
    })) << client.told;
    for (int i = 0; i < 3; ++i) client.step(one_second);
    EXPECT_TRUE(support::comes_true([&] {
        client.step();
        server.step();
        return client.tells("is connected") && server.tells("is connected");
    })) << client.told;
}

TEST(BridgeAddresses, a_server_listens_at_all_of_them) {
    AtTimes server{Bridge(at_host("both.test", 0), Pace::by_steps)};
    const int socket = connect_to("127.0.0.1", server.bridge.port());
    ASSERT_GE(socket, 0);
    EXPECT_TRUE(support::comes_true([&] {
        server.step();
        return server.tells("client 1 is connected");
    }));
    const int other = connect_to("::1", server.bridge.port());
    if (other >= 0) {  // otherwise this machine has no IPv6
        EXPECT_TRUE(support::comes_true([&] {
            server.step();
            return server.tells("client 2 is connected");
        }));
        ::close(other);
    }
    ::close(socket);
}

TEST(BridgeAddresses, one_that_is_taken_is_an_error) {
    const Bridge first(at_host("127.0.0.1", 0), Pace::by_steps);
    EXPECT_THROW(Bridge(at_host("both.test", first.port()), Pace::by_steps), std::runtime_error);
}

}  // namespace
}  // namespace palpate::bridge
