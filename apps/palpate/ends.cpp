// Signals that end the program, and closed streams; see the header. Linux.
#include "apps/palpate/ends.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace palpate::app {

void handle_ends(void (*on_signal)(int)) {
    // A closed terminal and Ctrl-\ too.
    for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(s, on_signal);
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

void occupy_closed_streams() {
    for (int number = 0; number < 3; ++number) {
        if (::fcntl(number, F_GETFD) >= 0) continue;
        (void)::open("/dev/null", number == 0 ? O_WRONLY : O_RDONLY);  // takes the lowest number
    }
}

bool reader_has_gone() {
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    return ::poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

}  // namespace palpate::app
