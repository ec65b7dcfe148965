// TCP sockets that never wait. POSIX.
#pragma once

#include <string>
#include <vector>

namespace palpate::bridge {

/// Sockets that listen, one for each address of the host, and their port. Throws
/// std::runtime_error with what is wrong.
struct Listening {
    std::vector<int> sockets;
    int port;
};
Listening listen_at(const std::string& host, int port);

/// A socket that is connecting; -1 with an errno if that cannot even begin. A host may have several
/// addresses, which take turns: `attempt` counts from 0. Throws std::runtime_error for a host that
/// there is not.
int connect_to(const std::string& host, int port, int attempt = 0);
/// Once it can be written to: 0 if it is connected, otherwise the errno that says why not.
int connection_error(int socket);

/// The next one that came, ready for use; -1 if there is none.
int accept_from(int listening);
/// Sends small messages at once.
void set_prompt(int socket);

/// Whether every address of this host is one of this machine's own (127.0.0.1, ::1).
bool is_loopback(const std::string& host);

}  // namespace palpate::bridge
