// Connects to a socket of the UNIX domain, waits for it and reads from it.
#include "devices/spacenav/socket.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>
#include <utility>

#include "devices/link.hpp"

namespace palpate::devices::spacenav {

Socket::Socket(Socket&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

Socket& Socket::operator=(Socket&& other) noexcept {
    if (this == &other) return *this;
    close();
    file_ = std::exchange(other.file_, -1);
    return *this;
}

std::string Socket::connect(const std::string& path) {
    close();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) return "the path is too long for a socket";
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    file_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (file_ >= 0 &&
        ::connect(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
        return {};
    }
    const std::string error = std::generic_category().message(errno);
    close();
    return error;
}

void Socket::close() noexcept {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
}

bool Socket::wait_until(std::int64_t time) const noexcept {
    const std::int64_t left = std::max<std::int64_t>(0, time - monotonic_ns());
    const timespec wait{static_cast<time_t>(left / 1'000'000'000),
                        static_cast<long>(left % 1'000'000'000)};
    pollfd file{file_, POLLIN, 0};  // a negative file waits for nothing but the time
    return ::ppoll(&file, 1, &wait, nullptr) > 0;
}

void Socket::write(std::span<const unsigned char> bytes) noexcept {
    // Whether it is gone shows when it is read.
    static_cast<void>(::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

std::optional<std::size_t> Socket::read(std::span<unsigned char> bytes) noexcept {
    const ssize_t got = ::read(file_, bytes.data(), bytes.size());
    if (got > 0) return static_cast<std::size_t>(got);
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return 0;
    close();
    return std::nullopt;
}

}  // namespace palpate::devices::spacenav
