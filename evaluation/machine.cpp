// Reads the machine's description from the system.
#include "evaluation/machine.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <thread>

namespace palpate::evaluation {
namespace {

/// The value of the first line "KEY...: VALUE" or KEY="VALUE".
std::string value_in(const char* file, const std::string& key, char separator) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(key)) continue;
        std::string value = line.substr(std::min(line.size(), line.find(separator) + 1));
        const auto begin = value.find_first_not_of(" \t\"");
        const auto end = value.find_last_not_of(" \t\"");
        if (begin != std::string::npos) return value.substr(begin, end - begin + 1);
    }
    return "unknown " + key;
}

}  // namespace

std::string machine_and_date() {
#ifdef __clang__
    const std::string compiler = "clang++ " __clang_version__;
#else
    const std::string compiler = "g++ " __VERSION__;
#endif
    const std::time_t now = std::time(nullptr);
    return fmt::format("{:%Y-%m-%d}, {}, {} ({} processors), {}, Palpate {}", fmt::gmtime(now),
                       value_in("/etc/os-release", "PRETTY_NAME", '='),
                       value_in("/proc/cpuinfo", "model name", ':'),
                       std::thread::hardware_concurrency(), compiler, PALPATE_VERSION);
}

}  // namespace palpate::evaluation
