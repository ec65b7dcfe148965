// Opens sockets.
#include "bridge/sockets.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

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

/// -1, keeping the errno that says why.
int refused(int socket) {
    const int error = errno;
    ::close(socket);
    errno = error;
    return -1;
}

/// -1, with an errno, if there can be none.
int listening_socket(const addrinfo& address) {
    const int socket = socket_for(address);
    if (socket < 0) return -1;
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    const bool listens = ::bind(socket, address.ai_addr, address.ai_addrlen) == 0 &&
                         ::listen(socket, SOMAXCONN) == 0;
    return listens ? socket : refused(socket);
}

bool lacks_address(int error) {
    return error == EADDRNOTAVAIL || error == EAFNOSUPPORT;
}

void set_port(sockaddr& address, int port) {
    auto& its_port = address.sa_family == AF_INET6
                         ? reinterpret_cast<sockaddr_in6&>(address).sin6_port
                         : reinterpret_cast<sockaddr_in&>(address).sin_port;
    its_port = htons(static_cast<std::uint16_t>(port));
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
    Listening listening{{}, port};
    int error = 0;
    // With port 0, the first address gets any port, and the others get the same one.
    const Addresses addresses = addresses_of(host, port, AI_PASSIVE);
    for (addrinfo* at = addresses.get(); at; at = at->ai_next) {
        set_port(*at->ai_addr, listening.port);
        const int socket = listening_socket(*at);
        if (socket >= 0) {
            listening.sockets.push_back(socket);
            listening.port = port_of(socket);
        } else if (error == 0 || !lacks_address(errno)) {
            error = errno;
        }
    }
    // A machine without IPv6 may still know ::1 by name.
    if (!listening.sockets.empty() && (error == 0 || lacks_address(error))) return listening;
    for (const int socket : listening.sockets) ::close(socket);
    throw std::runtime_error("OpenIGTLink: cannot listen at " + host + ":" + std::to_string(port) +
                             " (" + std::strerror(error) + "): choose another port");
}

int connect_to(const std::string& host, int port, int attempt) {
    const Addresses addresses = addresses_of(host, port, 0);
    std::vector<const addrinfo*> all;
    for (const addrinfo* at = addresses.get(); at; at = at->ai_next) all.push_back(at);
    const addrinfo& address = *all[static_cast<std::size_t>(attempt) % all.size()];
    const int socket = socket_for(address);
    if (socket < 0) return -1;
    const bool connects =
        ::connect(socket, address.ai_addr, address.ai_addrlen) == 0 || errno == EINPROGRESS;
    return connects ? socket : refused(socket);
}

int connection_error(int socket) {
    int error = 0;
    socklen_t size = sizeof error;
    return getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
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
