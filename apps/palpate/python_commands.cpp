// Finds Python's part of Palpate, and goes on as one of its commands.
#include "apps/palpate/python_commands.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "io/process/helper_folders.hpp"

namespace palpate::app {
namespace {

/// The same names as in bindings/python/palpate/__main__.py, whose --help begins with `about`.
constexpr struct {
    std::string_view name, about;
} commands[]{
    {"evaluate", "Run experiments, each with a table, figures and checked claims"},
    {"study", "Find the least difference that people can feel, by trials of two touches"},
    {"ros", "Touch a volume with ROS: hand, proxy, force and status are topics"},
    {"distribute",
     "Write a store as multiscale OME-Zarr on the workers of a Dask cluster, as palpate convert "
     "writes it"}};

}  // namespace

void become_python(int argc, char** argv) {
    const auto is_first = [&](const auto& command) { return command.name == argv[1]; };
    if (argc < 2 || std::ranges::none_of(commands, is_first)) return;
    for (const auto& helpers : io::helper_folders()) {
        std::string package = (helpers / PALPATE_PACKAGE_FROM_LIBEXEC).lexically_normal();
        if (!std::filesystem::exists(package + "/__main__.py")) continue;
        std::string python = PALPATE_PYTHON_EXECUTABLE, without_files = "-B";
        std::vector<char*> words{python.data(), without_files.data(), package.data()};
        for (char** word = argv + 1; *word; ++word) words.push_back(*word);
        words.push_back(nullptr);
        // Signals wait until Python's part can handle them.
        sigset_t ends;
        sigemptyset(&ends);
        for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&ends, number);
        ::sigprocmask(SIG_BLOCK, &ends, nullptr);
        ::execv(python.c_str(), words.data());
    }
}

void add_missing_python(CLI::App& app) {
    for (const auto& [name, about] : commands) {
        CLI::App* command = app.add_subcommand(std::string(name), std::string(about));
        command->prefix_command();
        command->callback([command] {
            throw std::invalid_argument(
                "palpate " + command->get_name() +
                " needs " PALPATE_PYTHON_EXECUTABLE
                " and the Python module: build all targets, or apt install python3-palpate "
                "python3-scipy python3-matplotlib");
        });
    }
}

}  // namespace palpate::app
