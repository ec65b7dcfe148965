// gnuplot as a child process, fed through a pipe.
#include "apps/palpate/plot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

namespace palpate::app {
namespace {

/// In gnuplot's single-quoted strings a quote is written twice.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
    return out + "'";
}

}  // namespace

bool plot(const std::string& script, const std::filesystem::path& figure) {
    const bool svg = figure.extension() == ".svg";
    const std::filesystem::path part = figure.string() + ".part";
    const std::string head =
        fmt::format("set terminal {}\nset output {}\n",
                    svg ? "svg size 900,700 dynamic background rgb 'white' font 'Helvetica,14'"
                        : "pngcairo size 1100,850 font 'Helvetica,13'",
                    quoted(part.string()));
    const auto old = std::signal(SIGPIPE, SIG_IGN);  // gnuplot may end before it has read all
    bool good = false;
    if (FILE* pipe = ::popen("exec gnuplot 2>/dev/null", "w")) {
        std::fputs(head.c_str(), pipe);
        std::fputs(script.c_str(), pipe);
        const int status = ::pclose(pipe);
        good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    }
    std::signal(SIGPIPE, old);
    std::error_code ignored;
    if (good && std::filesystem::exists(part, ignored)) {
        std::filesystem::rename(part, figure, ignored);
        return !ignored;
    }
    std::filesystem::remove(part, ignored);
    return false;
}

}  // namespace palpate::app
