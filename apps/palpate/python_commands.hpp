// The commands that are parts of the Python package palpate.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate::app {

/// Goes on as Python, if the first word is such a command. Returns if it is not, or if Python or
/// the package is not there.
void become_python(int argc, char** argv);

/// Stand for these commands in the list of all, and say what is missing where they are called.
void add_missing_python(CLI::App& app);

}  // namespace palpate::app
