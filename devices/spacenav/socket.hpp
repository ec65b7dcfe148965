// A stream socket of the UNIX domain whose reads never block.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace palpate::devices::spacenav {

class Socket {
  public:
    Socket() = default;
    ~Socket() { close(); }
    Socket(Socket&& other) noexcept;
    Socket& operator=(Socket&& other) noexcept;

    /// Returns why it failed; empty if it is connected.
    std::string connect(const std::string& path);
    void close() noexcept;
    bool is_open() const noexcept { return file_ >= 0; }

    /// Whether there is something to read, or the other side has gone, by this time [ns,
    /// monotonic].
    bool wait_until(std::int64_t time) const noexcept;
    /// Sends these few bytes, if there is room for them.
    void write(std::span<const unsigned char> bytes) noexcept;
    /// How many bytes were read; nothing if the other side has closed (then this is closed, too).
    std::optional<std::size_t> read(std::span<unsigned char> bytes) noexcept;

  private:
    int file_ = -1;
};

}  // namespace palpate::devices::spacenav
