// Signals that end the program; see ends.hpp. Windows.
#include "apps/palpate/ends.hpp"

#include <fcntl.h>
#include <io.h>

#include <csignal>
#include <initializer_list>

namespace palpate::app {

void handle_ends(void (*on_signal)(int)) {
    for (const int s : {SIGINT, SIGTERM, SIGBREAK}) std::signal(s, on_signal);
}

/// The C library there gives numbers from 3 on. Text goes out as it is elsewhere, without CR.
void occupy_closed_streams() {
    for (const int stream : {0, 1, 2}) ::_setmode(stream, _O_BINARY);
}

bool reader_has_gone() {
    return false;
}

}  // namespace palpate::app
