// Options that were given although they change nothing.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "palpate/run/no_effect.hpp"

namespace palpate::app {

/// True if the option was given; false also where the command has no such option.
bool is_given(const CLI::App& command, const std::string& option);

/// Prints a warning on standard error, in one line, that names those of the options that were given
/// and says why they do nothing: "palpate: warning: --playback does nothing: head.nrrd is not a
/// sequence". Silent if none was given.
void warn_of_no_effect(const CLI::App& command, const std::vector<std::string>& options,
                       const std::string& why);
/// The same for each of these, whose options have underscores in place of hyphens.
void warn_of_no_effect(const CLI::App& command, const std::vector<run::NoEffect>& all);

}  // namespace palpate::app
