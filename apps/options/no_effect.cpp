// Warns of options that change nothing.
#include "apps/options/no_effect.hpp"
#include "apps/options/say.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <vector>

namespace palpate::app {

bool is_given(const CLI::App& command, const std::string& option) {
    const CLI::Option* found = command.get_option_no_throw(option);
    return found != nullptr && found->count() > 0;
}

void warn_of_no_effect(const CLI::App& command, std::initializer_list<const char*> options,
                       const std::string& why) {
    std::vector<std::string> given;
    for (const char* option : options) {
        if (is_given(command, option)) given.emplace_back(option);
    }
    if (given.empty()) return;
    say("palpate: warning: {} {} nothing: {}\n", fmt::join(given, ", "),
        given.size() == 1 ? "does" : "do", why);
}

}  // namespace palpate::app
