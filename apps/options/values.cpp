// Checks values of options, and says what is wrong with a command line.
#include "apps/options/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "apps/options/exit_status.hpp"
#include "io/system/number.hpp"
#include "palpate/names.hpp"

namespace palpate::app {
namespace {

constexpr const char* empty_value = "the value is empty";

/// Why a text is no T; empty if it is one.
template <class T>
std::string flaw_in(const std::string& text) {
    if (text.empty()) return empty_value;
    const auto number = io::number_from<T>(text);
    if constexpr (std::floating_point<T>) {
        if (number && !std::isnan(*number)) return {};
    } else {
        if (number) return {};
        const auto real = io::number_from<double>(text);
        if (real && std::floor(*real) == *real) {
            const std::int64_t least = std::signed_integral<T> ? std::numeric_limits<T>::min() : 0;
            return fmt::format("{} is not a whole number from {} to {}", text, least,
                               std::numeric_limits<T>::max());
        }
        if (real) return text + " is not a whole number";
    }
    const bool has_digit = text.find_first_of("0123456789") != std::string::npos;
    if (has_digit && text.find(',') != std::string::npos) {
        return "'" + text + "' is not a number: its decimals follow a point, as in 1.5";
    }
    const bool only_too_large =
        has_digit && text.find_first_not_of("+-.0123456789eE") == std::string::npos;
    return "'" + text + (only_too_large ? "' is not a number that fits" : "' is not a number");
}

CLI::Validator finite(std::string words, bool (*accepts)(double)) {
    return {[words, accepts](const std::string& text) {
                std::string flaw = flaw_in<double>(text);
                if (flaw.empty() && !accepts(*io::number_from<double>(text))) {
                    flaw = text + " is not " + words;
                }
                return flaw;
            },
            words};
}

/// The factor of a unit of memory; nothing: there is no such unit.
std::optional<double> factor_of(std::string unit) {
    std::erase(unit, ' ');
    for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (unit.ends_with('b')) unit.pop_back();
    if (unit.ends_with('i')) unit.pop_back();
    if (unit.empty()) return 1;
    const auto power = std::string_view("kmgtpe").find(unit);
    if (unit.size() != 1 || power == std::string_view::npos) return std::nullopt;
    return std::pow(1024.0, static_cast<double>(power) + 1);
}

void refuse_in(CLI::App& command) {
    for (CLI::Option* option : command.get_options()) {
        if (option->get_items_expected_max() == 0) continue;  // a flag
        option->check(
            [](const std::string& value) { return value.empty() ? empty_value : std::string(); });
        const std::string type = option->get_type_name();
        if (type.starts_with("FLOAT")) option->check(&flaw_in<double>);
        if (type.starts_with("INT")) option->check(&flaw_in<std::int32_t>);
        if (type.starts_with("UINT")) option->check(&flaw_in<std::uint64_t>);
    }
    for (CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
        refuse_in(*below);
    }
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    return names;
}

/// Empty if none is near, and for a word of hyphens.
std::string near_to(const std::string& word, const std::vector<std::string>& names) {
    return word.find_first_not_of('-') == std::string::npos ? "" : nearest_name(word, names);
}

std::string meant(const std::string& word, const std::vector<std::string>& names) {
    const std::string near = near_to(word, names);
    return near.empty() ? near : ": did you mean " + near + "?";
}

/// For an option that only other commands have.
std::string of_others(const std::string& word, const CLI::App& app) {
    std::vector<std::string> all, having;
    const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::App* command : commands) {
        std::ranges::copy(option_names(*command), std::back_inserter(all));
    }
    const std::string near = near_to(word, all);
    // Among so many options, one is always near.
    if (near.empty() || !(near.starts_with(word) || word.starts_with(near))) return {};
    for (const CLI::App* command : commands) {
        if (command->get_option_no_throw(near)) having.push_back(command->get_name());
    }
    return having.empty() ? ""
                          : fmt::format(": {} is an option of {}", near, fmt::join(having, ", "));
}

/// For an option without its value, or with more than one.
std::string wrong_count(const CLI::App& command, const std::string& text) {
    const std::string name = text.substr(0, text.find(':'));
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_name() != name) continue;
        if (option->count() > 1) return name + ": it is given more than once";
        const std::string help = option->get_description();
        return name + " needs a value" + (help.empty() ? "" : ": " + help);
    }
    return text;
}

}  // namespace

CLI::Validator one_of(std::vector<std::string> names) {
    const std::string shown = fmt::format("{{{}}}", fmt::join(names, ","));
    return {[names = std::move(names)](const std::string& word) {
                if (std::ranges::find(names, word) != names.end()) return std::string();
                if (word.empty()) return std::string(empty_value);
                return "there is no '" + word + "': " + use_one_of(names, word);
            },
            shown};
}

CLI::Validator from_to(double low, double high) {
    const std::string words = fmt::format("{} to {}", low, high);
    return {[low, high, words](const std::string& text) {
                std::string flaw = flaw_in<double>(text);
                if (!flaw.empty()) return flaw;
                const double value = *io::number_from<double>(text);
                return low <= value && value <= high ? flaw : text + " is not from " + words;
            },
            words};
}

CLI::Validator above_zero() {
    return finite("a number above 0", [](double x) { return x > 0 && std::isfinite(x); });
}

CLI::Validator from_zero() {
    return finite("a number from 0", [](double x) { return x >= 0 && std::isfinite(x); });
}

CLI::Validator count(std::uint64_t most) {
    return {[most](const std::string& text) {
                if (text.empty()) return std::string(empty_value);
                const auto number = io::number_from<std::uint64_t>(text);
                if (number && *number <= most) return std::string();
                const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
                return text + " is not a whole number from 0" +
                       (digits ? fmt::format(" to {}", most) : "");
            },
            ""};
}

CLI::Validator size_in_bytes() {
    return {[](std::string& text) {
                if (text.empty()) return std::string(empty_value);
                const auto end = text.find_last_of("0123456789.") + 1;
                const auto number = io::number_from<double>(text.substr(0, end));
                const auto factor = factor_of(text.substr(end));
                const double bytes = number && factor ? *number * *factor : -1;
                if (!(bytes >= 0 && bytes < 0x1p63)) {
                    return "'" + text + "' is not an amount of memory: write one like 512MB or 4GB";
                }
                text = fmt::format("{}", static_cast<std::uint64_t>(bytes));
                return std::string();
            },
            ""};
}

std::string file_of(std::span<const std::string_view> endings) {
    std::string all;
    for (const std::string_view ending : endings) {
        all.append(all.empty() ? "" : ",").append(ending.substr(1));
    }
    return endings.size() == 1 ? "FILE." + all : "FILE.{" + all + "}";
}

void refuse_impossible_values(CLI::App& app, int argc, const char* const* argv) {
    refuse_in(app);
    const auto refuse_empty = [=](const CLI::App& command) {
        for (int i = 1; i < argc && argv[i] != std::string_view("--"); ++i) {
            const std::string word = argv[i], name = word.substr(0, word.find('='));
            if (!word.ends_with('=') || name.size() + 1 != word.size()) continue;
            if (command.get_option_no_throw(name)) throw CLI::ValidationError(name, empty_value);
        }
    };
    const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
    if (commands.empty()) refuse_empty(app);
    for (CLI::App* command : commands) {  // once it is known which one is meant
        command->preparse_callback([=](std::size_t) { refuse_empty(*command); });
    }
}

std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App* command = &app;
    while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
    auto left = app.remaining(true);
    const bool has_end = !left.empty() && left.front() == "--";  // of the options
    if (has_end) left.erase(left.begin());
    // CLI11 calls a misspelt command or option a missing one.
    const bool misnamed = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr ||
                          dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    std::string text = error.what();
    if (misnamed && !left.empty()) {
        const std::string& word = left.front();
        if (word.size() > 1 && word[0] == '-' && !has_end) {
            const std::string name = word.substr(0, word.find('='));
            const bool is_before = command != &app && command->get_option_no_throw(name);
            const std::string near = meant(name, option_names(*command));
            text = is_before ? name + " is an option of " + command->get_name() +
                                   ": write it after " + command->get_name()
                             : "there is no option " + word +
                                   (near.empty() ? of_others(name, app) : near);
        } else if (command == &app) {
            text = "there is no command '" + word + "'" + meant(word, command_names(app));
        } else {
            text = "'" + word + "' is one argument too many";
        }
    } else if (command == &app && misnamed && app.get_require_subcommand_min() > 0) {
        text = "a command is needed, as in palpate demo";
    } else if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
        text = wrong_count(*command, text);
    } else if (const std::string_view lead = "Could not convert: "; text.starts_with(lead)) {
        text = text.substr(lead.size()) + ": this option takes no such value";
    }
    std::string path;
    for (; command != nullptr; command = command->get_parent()) {
        path = command->get_name() + " " + path;
    }
    return one_line(text) + " (see " + path + "--help)";
}

}  // namespace palpate::app
