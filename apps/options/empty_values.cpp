// Refuses empty option values.
#include "apps/options/empty_values.hpp"

namespace palpate::app {
namespace {

constexpr const char* complaint = "the value is empty";

void refuse_in(CLI::App& command) {
    for (CLI::Option* option : command.get_options()) {
        if (option->get_items_expected_max() == 0) continue;  // a flag
        option->check(
            [](const std::string& value) { return value.empty() ? complaint : std::string(); });
    }
    for (CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
        refuse_in(*below);
    }
}

}  // namespace

void refuse_empty_values(CLI::App& command, int argc, const char* const* argv) {
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
