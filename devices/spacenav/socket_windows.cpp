// spacenavd is a program for UNIX: on Windows there is none to connect to.
#include <utility>

#include "devices/spacenav/socket.hpp"

namespace palpate::devices::spacenav {

Socket::Socket(Socket&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

Socket& Socket::operator=(Socket&& other) noexcept {
    file_ = std::exchange(other.file_, -1);
    return *this;
}

std::string Socket::connect(const std::string&) {
    return "there is no spacenavd on Windows";
}

void Socket::close() noexcept {}

bool Socket::wait_until(std::int64_t) const noexcept {
    return false;
}

void Socket::write(std::span<const unsigned char>) noexcept {}

std::optional<std::size_t> Socket::read(std::span<unsigned char>) noexcept {
    return std::nullopt;
}

}  // namespace palpate::devices::spacenav
