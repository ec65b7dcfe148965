// palpate evaluate is the Python package palpate.evaluate.
#pragma once

#include <CLI/CLI.hpp>
#include <string_view>

namespace palpate::app {

inline constexpr std::string_view evaluation_command = "evaluate";
inline constexpr const char* evaluation_description =
    "Run experiments, each with a table, figures and checked claims";

/// Goes on as Python, with the words behind the command. Returns if Python or the package is not
/// there.
void become_evaluation(char** argv);

/// Stands for the command in the list of all, and says what is missing where it is called.
void add_missing_evaluation(CLI::App& app);

}  // namespace palpate::app
