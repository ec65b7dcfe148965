// Warns of options that change nothing.
#include "apps/options/no_effect.hpp"

#include <algorithm>

#include "apps/options/say.hpp"

namespace palpate::app {

bool is_given(const CLI::App& command, const std::string& option) {
    const CLI::Option* found = command.get_option_no_throw(option);
    return found != nullptr && found->count() > 0;
}

void warn_of_no_effect(const CLI::App& command, const std::vector<std::string>& options,
                       const std::string& why) {
    std::vector<std::string> given;
    for (const std::string& option : options) {
        if (is_given(command, option)) given.push_back(option);
    }
    if (!given.empty()) say("palpate: warning: {}\n", run::no_effect_text(given, why));
}

void warn_of_no_effect(const CLI::App& command, const std::vector<run::NoEffect>& all) {
    for (const auto& [names, why] : all) {
        std::vector<std::string> options;
        for (std::string name : names) {
            std::ranges::replace(name, '_', '-');
            options.push_back("--" + name);
        }
        warn_of_no_effect(command, options, why);
    }
}

}  // namespace palpate::app
