// Options and arguments that are given, but empty or not a number.
#pragma once

#include <CLI/CLI.hpp>

namespace palpate::app {

/// '' is what a script gives for a variable that is not set: taken for "not given", --save '' would
/// lose what was to be saved; and --save= would take the word that follows. So every option of
/// `command` and of the commands below it refuses it. Call it once all of them are added, before
/// they are parsed. Throws CLI::ValidationError for the second kind. Numbers refuse NaN, which no
/// check of a range does.
void refuse_impossible_values(CLI::App& command, int argc, const char* const* argv);

}  // namespace palpate::app
