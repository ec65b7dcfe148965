// Sends the helper program's messages to its caller; protocol.hpp describes them. Header only, as
// child.hpp.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <exception>

#include "io/helper/protocol.hpp"

namespace palpate::io {

inline void report(const nlohmann::json& what) {
    const std::string line = line_from(what);
    std::size_t sent = 0;
    while (sent < line.size()) {
        const ssize_t written = write(report_descriptor, line.data() + sent, line.size() - sent);
        if (written <= 0) return;  // the caller is gone: there is nobody to tell
        sent += static_cast<std::size_t>(written);
    }
}

/// The exit status of a helper program. It reports what `work` returns, or words_of(exception).
/// `understood`: the arguments are those of the protocol.
template <class Work, class Words>
int helper_status(const char* program, bool understood, Work&& work, Words&& words_of) {
    if (!understood) {
        std::fprintf(stderr, "%s is started by palpate; there is nothing to do by hand\n", program);
        return 2;
    }
    try {
        report({{"done", work()}});
        return 0;
    } catch (const std::exception& e) {
        report({{"error", words_of(e)}});
    }
    return 1;
}

}  // namespace palpate::io
