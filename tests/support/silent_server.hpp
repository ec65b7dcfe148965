// A server that takes connections and never answers.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

namespace palpate::support {

class SilentServer {
  public:
    SilentServer() {
        at_.sin_family = AF_INET;
        at_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t length = sizeof(at_);
        auto* const address = reinterpret_cast<sockaddr*>(&at_);
        EXPECT_EQ(::bind(socket_, address, length), 0);
        EXPECT_EQ(::getsockname(socket_, address, &length), 0);
        EXPECT_EQ(::listen(socket_, 8), 0);
    }
    ~SilentServer() {
        if (client_ >= 0) ::close(client_);
        ::close(socket_);
    }
    SilentServer(const SilentServer&) = delete;
    SilentServer& operator=(const SilentServer&) = delete;

    std::string address() const {
        return "http://127.0.0.1:" + std::to_string(ntohs(at_.sin_port)) + "/v.zarr";
    }
    bool is_asked() const {
        pollfd asked{socket_, POLLIN, 0};
        return ::poll(&asked, 1, 0) == 1;
    }
    /// Whether the first client that asked has closed its connection.
    bool is_left() {
        if (client_ < 0) client_ = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
        std::array<char, 4096> request;
        ssize_t got = 1;
        while (got > 0) got = ::recv(client_, request.data(), request.size(), MSG_DONTWAIT);
        return got == 0;
    }

  private:
    int socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    int client_ = -1;
    sockaddr_in at_{};
};

}  // namespace palpate::support
