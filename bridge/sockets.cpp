// Opens sockets.
#include "bridge/sockets.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>

namespace palpate::bridge {
namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses addresses_of(const std::string& host, int port, int flags) {
    addrinfo wanted{};
    wanted.ai_family = AF_UNSPEC;
    wanted.ai_socktype = SOCK_STREAM;
    wanted.ai_flags = flags | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found);
    if (error != 0) {
        throw std::runtime_error("OpenIGTLink: there is no host '" + host + "' (" +
                                 gai_strerror(error) + ")");
    }
    return {found, &freeaddrinfo};
}

int socket_for(const addrinfo& address) {
    return ::socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC,
                    address.ai_protocol);
}

int port_of(int socket) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.ss_family == AF_INET6
                     ? reinterpret_cast<const sockaddr_in6*>(&address)->sin6_port
                     : reinterpret_cast<const sockaddr_in*>(&address)->sin_port);
}

}  // namespace

Listening listen_at(const std::string& host, int port) {
    const Addresses addresses = addresses_of(host, port, AI_PASSIVE);
    const int socket = socket_for(*addresses);
    const int yes = 1;
    if (socket >= 0) {
        setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        if (::bind(socket, addresses->ai_addr, addresses->ai_addrlen) == 0 &&
            ::listen(socket, SOMAXCONN) == 0) {
            return {socket, port_of(socket)};
        }
    }
    const std::string why = std::strerror(errno);
    if (socket >= 0) ::close(socket);
    throw std::runtime_error("OpenIGTLink: cannot listen at " + host + ":" + std::to_string(port) +
                             " (" + why + "): choose another port");
}

int connect_to(const std::string& host, int port) {
    const Addresses addresses = addresses_of(host, port, 0);
    const int socket = socket_for(*addresses);
    if (socket < 0) return -1;
    if (::connect(socket, addresses->ai_addr, addresses->ai_addrlen) == 0 || errno == EINPROGRESS) {
        return socket;
    }
    ::close(socket);
    return -1;
}

bool is_connected(int socket) {
    int error = 0;
    socklen_t size = sizeof error;
    return getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
}

int accept_from(int listening) {
    return ::accept4(listening, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
}

void set_prompt(int socket) {
    const int yes = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

bool is_loopback(const std::string& host) {
    const Addresses addresses = addresses_of(host, 1, 0);
    for (const addrinfo* at = addresses.get(); at; at = at->ai_next) {
        if (at->ai_family == AF_INET) {
            const auto& in = *reinterpret_cast<const sockaddr_in*>(at->ai_addr);
            if (ntohl(in.sin_addr.s_addr) >> 24 != 127) return false;
        } else if (at->ai_family == AF_INET6) {
            const auto& in = *reinterpret_cast<const sockaddr_in6*>(at->ai_addr);
            if (!IN6_IS_ADDR_LOOPBACK(&in.sin6_addr)) return false;
        }
    }
    return true;
}

}  // namespace palpate::bridge
