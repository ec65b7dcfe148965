// Options of method, penetrability and force.
#include "apps/options/render_options.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <stdexcept>

#include "apps/options/interruption.hpp"
#include "apps/options/no_effect.hpp"
#include "apps/options/values.hpp"
#include "io/system/number.hpp"
#include "palpate/run/beside.hpp"
#include "palpate/run/labels.hpp"
#include "palpate/settings.hpp"

namespace palpate::app {
namespace {

/// "0.5,0.3" as two numbers; "0.5" as twice the same where one is enough.
std::array<double, 2> two_numbers(const std::string& option, const std::string& text,
                                  bool one_is_enough = false) {
    const auto comma = text.find(',');
    const auto first = io::number_from<double>(text.substr(0, comma));
    const auto second =
        comma == std::string::npos ? first : io::number_from<double>(text.substr(comma + 1));
    if (!first || !second || (comma == std::string::npos && !one_is_enough)) {
        throw std::invalid_argument(
            fmt::format("{} {}: {} separated by a comma, as in 0.5,0.3", option, text,
                        one_is_enough ? "one number, or two" : "two numbers"));
    }
    return {*first, *second};
}

}  // namespace

/// "--stiffness" of "-k,--stiffness".
static std::string long_name(const std::string& option) {
    return option.empty() ? option : option.substr(option.find("--"));
}

Friction friction_from(const std::string& what, const std::string& text) {
    const auto [still, moving] = two_numbers(what, text, true);
    return {still, moving};
}

run::LevelRange range_from(const std::string& text) {
    const auto colon = text.find(':');
    if (colon == std::string::npos) {
        throw std::invalid_argument("range " + text + ": LOW:HIGH is needed, as in 300:700");
    }
    return {io::level_from_text(text.substr(0, colon)),
            io::level_from_text(text.substr(colon + 1))};
}

void RenderOptions::add_to(CLI::App& command, const std::optional<std::uint64_t>& memory) {
    command_ = &command;
    memory_ = &memory;
    const auto choose = [this](const std::string& name) { given.method = run::named_method(name); };
    command.add_option_function<std::string>("--method", choose, "Proxy method")
        ->check(one_of(baselines::method_names()))
        ->default_str(given.method.name);
    add_penetrability_to(command);
    command
        .add_option_function<std::string>(
            "--layers",
            [this](const std::string& text) {
                given.layers = io::layers_named(layers_ = text, stop_if_interrupted);
            },
            "Several surfaces, each with its own feel: a file, or the name of a built-in set")
        ->type_name(fmt::format("{{{}}}|FILE.json", fmt::join(io::layers_names(), ",")));
    command
        .add_option("--labels", labels,
                    "A layer for each label of a segmentation: a label volume on its own grid")
        ->type_name("VOLUME");
    command
        .add_option_function<std::string>(
            "--tool",
            [this, &memory](const std::string& text) {
                // Half of what the program may take, as for the chunks of a store.
                given.tool =
                    io::tool_spec_from(tool_ = text, stop_if_interrupted, memory.value_or(0) / 2);
            },
            "Touch with a rigid tool: sphere:R, rod:L, needle[:L,R], burr:R, box:X,Y,Z, fingertip "
            "[mm], or a file with points (.csv) or a mesh (.stl, .ply, .obj, .vtp)")
        ->type_name("{point,sphere:,rod:,needle,burr:,box:,fingertip}|FILE.{csv,stl,ply,obj,vtp}")
        ->default_str("point");
    command
        .add_option("--tool-spacing", given.tool_spacing,
                    "Distance between the tool's points [mm] (default: half a voxel)")
        ->check(above_zero());
    add_force_to(command);
    command
        .add_option("--rate", given.rate, "Updates of proxy and force per second (default: 1000)")
        ->type_name("FLOAT");
    command.add_option("--scale", given.scale, "Millimetres of volume per millimetre of hand")
        ->default_str("1");
    command
        .add_option("--step-budget", given.step_budget,
                    "Largest work of an update, in units of about one step through a tetrahedron")
        ->default_str(std::to_string(ProxySettings{}.step_budget));
}

void RenderOptions::add_penetrability_to(CLI::App& command) {
    const auto choose = [this](const std::string& name) {
        penetrability = name == "off"         ? Penetrability::off
                        : name == "threshold" ? Penetrability::threshold
                                              : Penetrability::ranges;
    };
    command
        .add_option_function<std::string>(
            "--penetrability", choose,
            "Whether the surface gives way when it is pressed hard, and at which levels")
        ->check(one_of({"off", "threshold", "ranges"}))
        ->default_str("off");
    command.add_option("--threshold", threshold,
                       "Penetration threshold PT: depth of the hand at which the surface gives way "
                       "[device mm] (1)");
    command.add_option_function<std::string>(
        "--minimum", [this](const std::string& text) { minimum = io::level_from_text(text); },
        "For threshold: the lowest level that is touched (default: the isovalue)");
    // Without allow_extra_args(false) this would take VOLUME for one more range.
    command
        .add_option_function<std::vector<std::string>>(
            "--range",
            [this](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) ranges.push_back(range_from(text));
            },
            "For ranges: levels that are touched, LOW:HIGH. May be given again")
        ->allow_extra_args(false)
        ->type_name("LOW:HIGH");
}

/// An option for two numbers of the same table, as in `--magnet DISTANCE,PEAK`.
template <class Pair>
static void add_pair(CLI::App& command, const std::string& name, const std::string& about,
                     Pair& pair) {
    std::string help = about + ": ", type;
    for_each_setting<Pair>([&](const auto& one) {
        std::string word = one.name;
        for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        const char* const comma = type.empty() ? "" : ",";
        help += fmt::format("{}{} [{}]", comma, word, one.unit);
        type += comma + word;
    });
    const auto read = [name, &pair](const std::string& text) {
        const auto numbers = two_numbers(name, text);
        std::size_t next = 0;
        for_each_setting<Pair>([&](const auto& one) { pair.*one.member = numbers.at(next++); });
    };
    command.add_option_function<std::string>(name, read, help)->type_name(type);
}

void RenderOptions::add_force_to(CLI::App& command) {
    ForceSettings& force = given.force;
    for_each_setting<ForceSettings>([&](const auto& one) {
        if (one.option[0] == '\0') return;
        auto& value = force.*one.member;
        if constexpr (std::same_as<double&, decltype(value)>) {
            // Values that depend on the device are set only if the user gave them.
            std::optional<double>* const left_open = &value == &force.stiffness ? &given.stiffness
                                                     : &value == &force.limit   ? &given.limit
                                                                                : nullptr;
            const std::string help = fmt::format("{} [{}]", one.about, one.unit);
            CLI::Option* const option = left_open ? command.add_option(one.option, *left_open, help)
                                                  : command.add_option(one.option, value, help);
            option->default_str(fmt::format("{}", value));
        } else {
            add_pair(command, one.option, one.about, value);
        }
    });
    command
        .add_option_function<std::string>(
            "--friction",
            [this](const std::string& text) { given.friction = friction_from("--friction", text); },
            "Friction coefficients. The dynamic one is at most the static one")
        ->type_name("STATIC[,DYNAMIC]");
}

run::RenderSetup RenderOptions::setup() const {
    const auto refuse = [](const std::string& option, const std::string& mode) {
        throw std::invalid_argument(option + " does nothing without --penetrability " + mode);
    };
    if (threshold && penetrability == Penetrability::off) {
        refuse("--threshold", "threshold (or ranges)");
    }
    if (minimum && penetrability != Penetrability::threshold) refuse("--minimum", "threshold");
    if (!ranges.empty() && penetrability != Penetrability::ranges) refuse("--range", "ranges");
    run::RenderSetup setup = given;
    if (!labels.empty()) {
        setup.layers = run::layers_by_label(
            run::load_labels(labels, memory_->value_or(0), stop_if_interrupted), setup.layers);
    }
    if (penetrability == Penetrability::threshold) {
        setup.penetrability = run::ThresholdSetup{threshold.value_or(1), minimum};
    }
    if (penetrability == Penetrability::ranges) {
        if (ranges.empty()) {
            throw std::invalid_argument(
                "--penetrability ranges needs at least one --range LOW:HIGH");
        }
        setup.penetrability = run::RangesSetup{threshold.value_or(1), ranges};
    }
    warn_of_no_effect(*command_, run::without_effect_in_replay(setup));
    return setup;
}

std::vector<std::string> RenderOptions::named_options() const {
    std::vector<std::string> names{"--friction", "--scale"};
    for_each_setting<ForceSettings>([&](const auto& one) {
        if (one.option[0] != '\0') names.push_back(long_name(one.option));
    });
    return names;
}

std::function<void(RendererSettings&)> RenderOptions::named() const {
    std::vector<std::function<void(RendererSettings&)>> changes;
    for_each_setting<ForceSettings>([&](const auto& one) {
        if (!is_given(*command_, long_name(one.option))) return;
        changes.emplace_back([one, value = given.force.*one.member](RendererSettings& settings) {
            settings.force.*one.member = value;
        });
    });
    return [changes, limit = given.limit, stiffness = given.stiffness, friction = given.friction,
            scale = given.scale](RendererSettings& settings) {
        for (const auto& change : changes) change(settings);
        if (limit) settings.force.limit = *limit;
        if (stiffness) settings.force.stiffness = *stiffness;
        if (friction) settings.proxy.friction = *friction;
        if (scale) settings.transform.scale = *scale;
    };
}

run::RenderSetup RenderOptions::setup_in(const run::LoadedVolume& volume) const {
    run::RenderSetup made = setup();
    if (auto& file = made.layers) {
        file->layers.labels = run::labels_beside(file->layers.labels, volume);
    }
    return made;
}

}  // namespace palpate::app
