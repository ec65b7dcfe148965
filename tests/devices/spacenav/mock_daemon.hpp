// A stand-in for spacenavd: its socket, served by the test itself.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include "support/scratch_folder.hpp"

namespace palpate::support {

class MockDaemon {
  public:
    using Event = std::array<std::int32_t, 8>;

    MockDaemon() : path_((folder_ / "spnav.sock").string()) { listen(); }
    ~MockDaemon() { go_away(); }
    MockDaemon(const MockDaemon&) = delete;
    MockDaemon& operator=(const MockDaemon&) = delete;

    const std::string& path() const { return path_; }

    void listen() {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, path_.c_str(), path_.size() + 1);
        server_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
        if (::bind(server_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
            ::listen(server_, 8) != 0) {
            throw std::runtime_error("no socket");
        }
    }
    /// Waits for a client, at most 10 s.
    bool accept() {
        pollfd file{server_, POLLIN, 0};
        if (::poll(&file, 1, 10'000) <= 0) return false;
        client_ = ::accept(server_, nullptr, nullptr);
        return client_ >= 0;
    }
    void say(const Event& event) { say_bytes(event.data(), sizeof event); }
    void say_bytes(const void* bytes, std::size_t count) {
        EXPECT_EQ(::send(client_, bytes, count, MSG_NOSIGNAL), static_cast<ssize_t>(count));
    }
    /// What the client has said meanwhile.
    std::size_t heard() {
        std::array<char, 256> bytes{};
        const ssize_t got = ::recv(client_, bytes.data(), bytes.size(), MSG_DONTWAIT);
        return got > 0 ? static_cast<std::size_t>(got) : 0;
    }
    void hang_up() { close(client_); }
    /// The place to connect to goes first: a client that is hung up on connects again at once.
    void go_away() {
        ::unlink(path_.c_str());
        close(server_);
        hang_up();
    }

  private:
    static void close(int& file) {
        if (file >= 0) ::close(file);
        file = -1;
    }

    ScratchFolder folder_;
    const std::string path_;
    int server_ = -1, client_ = -1;
};

}  // namespace palpate::support
