// The parts that the programs named `palpate` share: signals, the command line, failures.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace palpate::app {

/// Reads the command line with the commands that are added, and runs the one that is given. The
/// program's exit status.
int run_program(int argc, char** argv, const std::function<void(CLI::App&)>& add_commands);

}  // namespace palpate::app
