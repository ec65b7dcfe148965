// Refuses option values that are empty, and numbers that are none.
#include "apps/options/impossible_values.hpp"

#include <cmath>

namespace palpate::app {
namespace {

constexpr const char* complaint = "the value is empty";

/// CLI11's checks of a range let NaN pass, for it is neither below nor above.
std::string complain_of_nan(const std::string& value) {
    double number = 0;
    const bool is_nan = CLI::detail::lexical_cast(value, number) && std::isnan(number);
    return is_nan ? "'" + value + "' is not a number" : std::string();
}

void refuse_in(CLI::App& command) {
    for (CLI::Option* option : command.get_options()) {
        if (option->get_items_expected_max() == 0) continue;  // a flag
        option->check(
            [](const std::string& value) { return value.empty() ? complaint : std::string(); });
        if (option->get_type_name().starts_with("FLOAT")) option->check(&complain_of_nan);
    }
    for (CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
        refuse_in(*below);
    }
}

}  // namespace

void refuse_impossible_values(CLI::App& command, int argc, const char* const* argv) {
    refuse_in(command);
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == "--") return;
        if (word.starts_with("--") && word.ends_with("=")) {
            throw CLI::ValidationError(std::string(word.substr(0, word.size() - 1)), complaint);
        }
    }
}

}  // namespace palpate::app
