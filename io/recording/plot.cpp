// Runs gnuplot as a child process, with the script in a file without a name.
#include "io/recording/plot.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "io/system/leftovers.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// In gnuplot's single-quoted strings a quote is written twice.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
    return out + "'";
}

std::string terminal(bool svg, const PlotSize& size) {
    const std::string pixels = std::to_string(size.width) + "," + std::to_string(size.height);
    return svg ? "set terminal svg size " + pixels +
                     " dynamic background rgb 'white' font 'Helvetica,14'\n"
               : "set terminal pngcairo size " + pixels + " font 'Helvetica,12'\n";
}

/// The first line that is not blank.
std::string complaint_in(const std::string& said) {
    std::size_t begin = 0;
    while (begin < said.size()) {
        const std::size_t end = std::min(said.find('\n', begin), said.size());
        const std::string line = said.substr(begin, end - begin);
        if (line.find_first_not_of(" \t^") != std::string::npos) return line;
        begin = end + 1;
    }
    return "gnuplot failed without a word";
}

}  // namespace

bool can_plot() {
    const int status = std::system("command -v gnuplot >/dev/null 2>&1");
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string plot(const std::string& script, const fs::path& figure, const PlotSize& size) {
    const fs::path part =
        temporary_in(figure.has_parent_path() ? figure.parent_path() : fs::path("."));
    const auto close = [](std::FILE* file) { std::fclose(file); };
    const std::unique_ptr<std::FILE, decltype(close)> in(std::tmpfile(), close);
    if (!in) return "no temporary file could be made";
    const std::string whole = terminal(figure.extension() == ".svg", size) + "set output " +
                              quoted(part.string()) + "\n" + script + "\n";
    std::fputs(whole.c_str(), in.get());
    std::fflush(in.get());
    // By number: the shell opens it anew from its start.
    const std::string command = "exec gnuplot /proc/" + std::to_string(::getpid()) + "/fd/" +
                                std::to_string(::fileno(in.get())) + " 2>&1";
    std::FILE* const out = ::popen(command.c_str(), "r");
    if (!out) return "gnuplot could not be started";
    std::string said;
    for (int c; (c = std::fgetc(out)) != EOF;) said += static_cast<char>(c);
    const int status = ::pclose(out);
    std::error_code error;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && fs::exists(part, error)) {
        if (replace_synced(part, figure)) return "";
        const int problem = errno;
        fs::remove(part, error);
        return reason(problem);
    }
    fs::remove(part, error);
    return complaint_in(said);
}

}  // namespace palpate::io
