// TCP sockets that never wait. POSIX.
#pragma once

#include <string>

namespace palpate::bridge {

/// A socket that listens, and its port. Throws std::runtime_error with what is wrong.
struct Listening {
    int socket;
    int port;
};
Listening listen_at(const std::string& host, int port);

/// A socket that is connecting; -1 if that cannot even begin. Throws std::runtime_error for a host
/// that there is not.
int connect_to(const std::string& host, int port);
/// Once it can be written to: whether it is connected.
bool is_connected(int socket);

/// The next one that came, ready for use; -1 if there is none.
int accept_from(int listening);
/// Sends small messages at once.
void set_prompt(int socket);

/// Whether every address of this host is one of this machine's own (127.0.0.1, ::1).
bool is_loopback(const std::string& host);

}  // namespace palpate::bridge
