// Finds Python's part of Palpate, and goes on as its experiments.
#include "apps/palpate/evaluation.hpp"

#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/process/helper_folders.hpp"

namespace palpate::app {

void become_evaluation(char** argv) {
    for (const auto& helpers : io::helper_folders()) {
        std::string experiments = (helpers / PALPATE_EXPERIMENTS_FROM_LIBEXEC).lexically_normal();
        if (!std::filesystem::exists(experiments + "/__main__.py")) continue;
        std::string python = PALPATE_PYTHON_EXECUTABLE, without_files = "-B";
        std::vector<char*> words{python.data(), without_files.data(), experiments.data()};
        for (char** word = argv + 2; *word; ++word) words.push_back(*word);
        words.push_back(nullptr);
        // Signals wait until Python's part can handle them.
        sigset_t ends;
        sigemptyset(&ends);
        for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&ends, number);
        ::sigprocmask(SIG_BLOCK, &ends, nullptr);
        ::execv(python.c_str(), words.data());
    }
}

void add_missing_evaluation(CLI::App& app) {
    CLI::App* command = app.add_subcommand(std::string(evaluation_command), evaluation_description);
    command->prefix_command();
    command->callback([] {
        throw std::invalid_argument(
            "palpate evaluate needs " PALPATE_PYTHON_EXECUTABLE
            " and the Python module: build all targets, or apt install python3-palpate "
            "python3-scipy python3-matplotlib");
    });
}

}  // namespace palpate::app
