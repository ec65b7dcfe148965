// Reads the commands of scripts and keys.
#include "apps/palpate/live_commands.hpp"

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>

#include "apps/options/render_options.hpp"
#include "apps/palpate/commands.hpp"
#include "io/system/number.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/layers_file.hpp"
#include "palpate/io/level.hpp"
#include "palpate/settings.hpp"

namespace palpate::app {

LiveCommands::LiveCommands(const run::Run& run)
    : data_(&run.data()),
      field_(run.field()),
      isovalue_(run.isovalue()),
      settings_(run.settings()) {
    if (settings_.penetrability.on) penetrability_ = settings_.penetrability;
    last_layers_ = settings_.layers;
}

Penetrability LiveCommands::penetrability_from(const CommandWords& words) const {
    const std::string mode = words.expect(2, words.count())[1];
    if (mode == "off" && words.count() == 2) return no_penetrability();
    const double threshold = words.number(2);
    if (mode == "threshold" && words.count() <= 4) {
        const double minimum =
            words.count() == 4 ? io::level_from_text(words[3], field_.volume()) : isovalue_;
        return penetrability_threshold(threshold, minimum, field_.solid());
    }
    if (mode != "ranges") words.refuse();
    std::vector<DensityRange> ranges;
    for (std::size_t i = 3; i < words.count(); ++i) {
        const run::LevelRange range = range_from(words[i]);
        ranges.push_back(
            {io::level_in(field_.volume(), range.low), io::level_in(field_.volume(), range.high)});
    }
    return penetrability_ranges(threshold, ranges, field_.solid());
}

Command LiveCommands::use_layers(std::shared_ptr<const Layers> layers) {
    const Command command = command::UseLayers{layers};
    check(command, settings_, kind_of(field_));
    if (layers) last_layers_ = layers;
    settings_.layers = std::move(layers);
    return command;
}

Command LiveCommands::layers_from(const CommandWords& words) {
    const std::string name = words.expect(2)[1];
    if (name == "off") return use_layers(nullptr);
    try {
        return use_layers(std::make_shared<const Layers>(
            io::layers_for(io::layers_named(name, stop_if_interrupted), field_.volume())));
    } catch (const io::InputError& e) {
        throw std::invalid_argument(e.what());
    }
}

/// Calls visit(name, value) for each number of the force that has an option, by the option's name.
static void for_each_force(ForceSettings& force, auto&& visit) {
    for_each_setting<ForceSettings>([&](const auto& one) {
        const std::string_view option = one.option;
        auto& value = force.*one.member;
        if constexpr (std::same_as<double&, decltype(value)>) {
            if (!option.empty()) visit(option.substr(option.rfind("--") + 2), value);
        }
    });
}

/// A command that changes one setting.
Command LiveCommands::setting_from(const CommandWords& words, RendererSettings& next) const {
    const std::string& name = words.name();
    if (name == "set") {
        const CommandWords named = words.as("set NAME VALUE, as in set limits.maximum_force 1");
        return change(next, named.expect(3)[1], named.number(2));
    }
    bool found = false;
    std::string forces;
    for_each_force(next.force, [&](std::string_view one, double& value) {
        forces.append(one).append(", ");
        if (one != name) return;
        value = words.expect(2).number(1);
        found = true;
    });
    if (found) return next.force;
    if (name == "friction") return next.proxy.friction = friction_from(name, words.expect(2)[1]);
    if (name == "scale") return command::Scale{words.expect(2).number(1)};
    throw std::invalid_argument(
        "there is no command '" + name + "'; there are isovalue, " + forces +
        "friction, penetrability, layers, forces, freeze, clutch, lift, scale, brush, carve, add, "
        "smooth, paint, fill, undo, redo, save, play, pause, step, seek, loop, set, quit");
}

DataRequest LiveCommands::take_up(const std::optional<run::HandBrush>& brush) {
    brush_ = brush;
    if (brush) last_brush_ = brush;
    return set_brush(brush);
}

Request LiveCommands::from_words(std::string_view line) {
    std::vector<std::string> all = CommandWords::in(line);
    const std::string name = all.empty() ? "" : all[0];
    const CommandWords words(std::move(all), name.empty() ? "a command" : name + " VALUE");
    words.expect(1, words.count());
    if (name == "brush") {
        (void)data_->editor();  // which a sequence does not have
        return take_up(
            brush_from(words.as("brush KIND RADIUS|tool[:BEYOND] [RATE [VALUE]], or brush off"),
                       field_.volume()));
    }
    if (auto data = data_request(words, *data_, field_.volume())) return data;
    if (name == "quit" && words.count() == 1) return Quit{};
    if (name == "lift") {
        words.as("lift, without a value").expect(1);
        return command::Lift{};
    }
    const CommandWords toggle = words.as(name + " on|off");
    if (name == "forces") return command::Forces{toggle.on_or_off()};
    if (name == "freeze") return command::Freeze{toggle.on_or_off()};
    if (name == "clutch") return command::Clutch{toggle.on_or_off()};
    if (name == "penetrability") {
        const Penetrability asked = penetrability_from(
            words.as("penetrability off, threshold PT [MINIMUM] or ranges PT LOW:HIGH"));
        if (asked.on) penetrability_ = asked;
        return Command(asked);
    }
    if (name == "layers") return layers_from(words.as("layers off, a file or the name of a set"));
    if (name == "isovalue") {
        isovalue_ = io::level_from_text(words.expect(2)[1], field_.volume());
        return command::Isovalue{isovalue_};
    }
    RendererSettings next = settings_;
    const Command command = setting_from(words, next);
    check(command, settings_, kind_of(field_));
    settings_ = next;
    return command;
}

std::optional<Request> LiveCommands::from_key(char key, const Snapshot& now) {
    const double percent = 0.01 * (field_.volume().maximum() - field_.volume().minimum());
    const double isovalue = now.session.tick.proxy.isovalue;
    switch (key) {
        case ' ':
            return command::Forces{!now.forces_on};
        case 'f':
            return command::Freeze{!now.session.frozen};
        case 'c':
            return command::Clutch{!now.session.clutched};
        case '+':
            return command::Isovalue{isovalue_ = isovalue + percent};
        case '-':
            return command::Isovalue{isovalue_ = isovalue - percent};
        case '[':
            return command::Scale{now.session.transform.scale / 1.1};
        case ']':
            return command::Scale{now.session.transform.scale * 1.1};
        case 'p':
            if (now.penetrability_on) return Command(no_penetrability());
            // From the present isovalue on, unless penetrability was set before.
            return Command(
                penetrability_.value_or(penetrability_threshold(1, isovalue, field_.solid())));
        case 'l':
            if (!last_layers_) return std::nullopt;
            return use_layers(settings_.layers ? nullptr : last_layers_);
        case 'b':
            if (brush_) return take_up(std::nullopt);
            return take_up(last_brush_.value_or(run::usual_brush(field_.geometry())));
        case 'u':
            return undo();
        case 'r':
            return redo();
        case 'k':
            return play(now.speed != 0 ? 0 : 1);
        case ',':
            return step(-1);
        case '.':
            return step(1);
        case 'q':
            return Quit{};
        case '?':
            return Help{};
        default:
            return std::nullopt;
    }
}

std::string LiveCommands::key_help() {
    return "keys: space forces on/off, f freeze, c clutch (the volume follows the hand), + - "
           "isovalue by 1 %, [ ] scale, p penetrability, l layers, b brush on/off, u undo, r redo, "
           "k play or pause a sequence, , . a frame back or on, q quit, ? this";
}

/// The hand that words begin with, which are left without it; 0: none. Throws
/// std::invalid_argument.
static int addressed(std::string& words, int count) {
    std::istringstream stream(words);
    std::string first, number, rest;
    if (!(stream >> first) || first != "hand") return 0;
    stream >> number;
    std::getline(stream, rest);
    const auto hand = io::number_from<int>(number);
    if (!hand || *hand < 1 || *hand > count) {
        throw std::invalid_argument("hand N COMMAND: N is 1 to " + std::to_string(count) +
                                    ", in the order of --device");
    }
    words = rest;
    return *hand;
}

/// Where # begins a comment, or the end. In quotes it is a part of a name.
static std::size_t comment_in(std::string_view line) {
    bool is_quoted = false;
    for (std::size_t at = 0; at < line.size(); ++at) {
        if (line[at] == '"') is_quoted = !is_quoted;
        if (line[at] == '#' && !is_quoted) return at;
    }
    return line.size();
}

std::vector<TimedRequest> read_commands(const std::string& path, LiveCommands& commands,
                                        const WhichHand& hand) {
    std::istringstream lines(io::read_text(path, stop_if_interrupted));
    std::vector<TimedRequest> requests;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        line.resize(comment_in(line));
        std::istringstream words(line);
        std::string time, rest;
        if (!(words >> time)) continue;
        std::getline(words, rest);
        const auto told = [&](const std::string& problem) {
            return fmt::format("{}, line {}: {}", path, number, problem);
        };
        const auto fail = [&](const std::string& problem) { throw io::InputError(told(problem)); };
        const auto seconds = io::number_from<double>(time);
        if (!seconds || !(*seconds >= 0)) {
            fail(io::quoted(time) +
                 " is no time: lines are SECONDS COMMAND, as in 1.5 isovalue 300");
        }
        if (!requests.empty() && *seconds < requests.back().time) {
            fail("the time goes back: put the lines in order");
        }
        try {
            const int whose = addressed(rest, hand.count);
            if (whose != 0 && whose != hand.number) continue;
            Request request = commands.from_words(rest);
            const bool is_done_once = !std::holds_alternative<Command>(request);
            if (whose == 0 && is_done_once && hand.number > 1) continue;
            requests.push_back({*seconds, std::move(request)});
        } catch (const std::invalid_argument& e) {
            fail(e.what());
        } catch (const io::OutputError& e) {
            throw io::OutputError(told(e.what()));
        }
    }
    return requests;
}

}  // namespace palpate::app
