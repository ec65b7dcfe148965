// A stand-in for Haply's Inverse Service on the loopback: a real WebSocket server that answers each
// message with one. No Boost in this header; FakeService is one without a socket.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::support {

class MockService {
  public:
    struct Reply {
        std::string text;
        bool binary = false;
    };
    /// One reply to a message, or none.
    using Answer = std::function<std::optional<Reply>(const std::string& message)>;

    /// Listens on an ephemeral port of 127.0.0.1.
    MockService();
    ~MockService();
    MockService(const MockService&) = delete;
    MockService& operator=(const MockService&) = delete;

    std::uint16_t port() const;

    // How it behaves from now on. Any thread.
    void greet(std::string snapshot);  ///< first message on each new connection
    void answer(Answer answer);
    void answer(std::string text);  ///< always this
    void hang(bool on);             ///< neither reads nor writes nor shakes hands
    void speak_http(bool on);       ///< no WebSocket: refuses handshakes
    void drop();                    ///< closes the connection

    // What it saw. Any thread.
    int connections() const;  ///< that shook hands
    bool closed_politely() const;
    std::size_t messages() const;
    /// Forces of all the commands, oldest first [N, service axes].
    std::vector<Vec3> forces() const;

  private:
    struct Server;
    std::unique_ptr<Server> server_;
};

}  // namespace palpate::support
