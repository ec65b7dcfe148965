// A connection that carries messages, and the one over a WebSocket: every call comes back by its
// deadline, whatever the other side does. No JSON here, and no Boost in this header.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::devices::haply {

using Clock = std::chrono::steady_clock;

/// Where a service listens. Numeric addresses, so that connecting again asks no name server.
struct Address {
    std::string host;
    std::uint16_t port = 0;
    std::vector<std::string> numeric;
};
/// Looks the host up, which may take as long as the system's resolver does. No `numeric` address
/// if there is none.
Address look_up(const std::string& host, std::uint16_t port);

struct Received {
    enum class What : std::uint8_t {
        message,
        nothing,  ///< until the deadline
        closed,   ///< the connection is gone; error() says why
    };
    What what = What::nothing;
    bool binary = false;
    std::string_view message;  ///< valid until the next receive()
};

/// Used by one thread at a time. Throws nothing but std::bad_alloc.
class Channel {
  public:
    virtual ~Channel() = default;

    /// Connects and shakes hands. False if that did not work; error() says why.
    virtual bool connect(const Address& address, Clock::time_point deadline) = 0;
    /// Sends a text message; allocates nothing (from the second message on). False if it could not
    /// be handed to the system by the deadline: then the connection is closed.
    virtual bool send(std::string_view message, Clock::time_point deadline) = 0;
    virtual Received receive(Clock::time_point deadline) = 0;
    /// Says goodbye, waiting for the answer until the deadline, and closes.
    virtual void close(Clock::time_point deadline) = 0;
    /// Closes without a word.
    virtual void drop() noexcept = 0;
    /// In words; empty if nothing went wrong.
    virtual const std::string& error() const = 0;
};

/// The real one. Its deadlines are times of the machine's clock.
class Socket final : public Channel {
  public:
    /// A message of more than `longest_message` bytes closes the connection.
    explicit Socket(std::size_t longest_message);
    ~Socket() override;

    bool connect(const Address& address, Clock::time_point deadline) override;
    bool send(std::string_view message, Clock::time_point deadline) override;
    Received receive(Clock::time_point deadline) override;
    void close(Clock::time_point deadline) override;
    void drop() noexcept override;
    const std::string& error() const override { return error_; }

  private:
    struct Connection;
    void fail(const std::string& what);

    std::size_t longest_message_;
    std::string error_;
    std::unique_ptr<Connection> connection_;
};

}  // namespace palpate::devices::haply
