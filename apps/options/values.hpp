// Checks of the values of options. Each names the accepted values in --help, where completion finds
// them, and refuses others with a hint at the right ones.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/names.hpp"

namespace palpate::app {

/// One of these words.
CLI::Validator one_of(std::vector<std::string> names);
/// Adds an option whose words are the names of an enumeration.
template <HasNames E>
CLI::Option* add_named(CLI::App& command, const std::string& option, E& value,
                       const std::string& help) {
    const auto read = [&value](const std::string& text) { value = named<E>(text); };
    return command.add_option_function<std::string>(option, read, help)
        ->check(one_of(all_names<E>()))
        ->default_str(enum_name(value));
}
/// A number from `low` to `high`.
CLI::Validator from_to(double low, double high);
/// A finite number above 0.
CLI::Validator above_zero();
/// A finite number from 0.
CLI::Validator from_zero();
/// A whole number from 0, for text that is converted later.
CLI::Validator count(std::uint64_t most = std::numeric_limits<std::int32_t>::max());
constexpr std::uint64_t largest_count = std::numeric_limits<std::uint64_t>::max();
/// Replaces "512MB" or "1.5g" by the number of bytes; a kB has 1024. For Option::transform().
CLI::Validator size_in_bytes();

/// What --help shows for the name of a file with one of these endings, which completion offers:
/// "FILE.{ply,stl}" for {".ply", ".stl"}.
std::string file_of(std::span<const std::string_view> endings);

/// '' is what a script gives for a variable that is not set. Taken for "not given", --save '' would
/// lose what was to be saved, and --save= would take the word that follows. So every option of
/// `app` and of its commands refuses it, and numbers refuse what is none: NaN, 1,5, or 1e400. Call
/// it once all options are added, before they are parsed.
void refuse_impossible_values(CLI::App& app, int argc, const char* const* argv);

/// What is wrong with the command line, in one line without "palpate: ". Names a word that is
/// unknown, and the command or option that was probably meant.
std::string complaint(const CLI::App& app, const CLI::ParseError& error);

}  // namespace palpate::app
