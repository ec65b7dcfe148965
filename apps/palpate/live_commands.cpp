// Reads words and keys.
#include "apps/palpate/live_commands.hpp"

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>

#include "apps/options/render_options.hpp"
#include "io/number.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/level.hpp"

namespace palpate::app {
namespace {

bool on_or_off(const std::vector<std::string>& words) {
    if (words.size() != 2 || (words[1] != "on" && words[1] != "off")) {
        wrong_words(words[0] + " on, or " + words[0] + " off,");
    }
    return words[1] == "on";
}

double number(const std::vector<std::string>& words, std::size_t at, const std::string& meant) {
    const auto value = at < words.size() ? io::number_from<double>(words[at]) : std::nullopt;
    if (!value) wrong_words(meant);
    return *value;
}

void expect_words(const std::vector<std::string>& words, std::size_t count) {
    if (words.size() != count) wrong_words(fmt::format("one value after '{}'", words[0]));
}

}  // namespace

LiveCommands::LiveCommands(const Field& field, double isovalue, const RendererSettings& settings)
    : field_(field), isovalue_(isovalue), settings_(settings) {
    if (settings.penetrability.on) penetrability_ = settings.penetrability;
}

Penetrability LiveCommands::penetrability_from(const std::vector<std::string>& words) const {
    const std::string mode = words.size() > 1 ? words[1] : "";
    if (mode == "off" && words.size() == 2) return no_penetrability();
    const double threshold =
        number(words, 2, "penetrability off, threshold PT or ranges PT LOW:HIGH");
    if (mode == "threshold" && words.size() <= 4) {
        const double minimum =
            words.size() == 4 ? io::level_from_text(words[3], field_.volume()) : isovalue_;
        return penetrability_threshold(threshold, minimum, field_.solid());
    }
    if (mode != "ranges")
        wrong_words("penetrability off, threshold PT [MINIMUM] or ranges PT LOW:HIGH");
    std::vector<DensityRange> ranges;
    for (std::size_t i = 3; i < words.size(); ++i) {
        const run::LevelRange range = range_from(words[i]);
        ranges.push_back(
            {io::level_in(field_.volume(), range.low), io::level_in(field_.volume(), range.high)});
    }
    return penetrability_ranges(threshold, ranges, field_.solid());
}

Request LiveCommands::from_words(std::string_view line) {
    std::istringstream stream{std::string(line)};
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) wrong_words("a command");
    const std::string& name = words[0];
    if (auto data = data_request(words, field_.volume())) {
        if (const auto* set = std::get_if<ask::SetBrush>(&*data)) {
            brush_ = set->brush;
            if (brush_) last_brush_ = brush_;
        }
        return *data;
    }
    if (name == "quit" && words.size() == 1) return Quit{};
    if (name == "forces") return command::Forces{on_or_off(words)};
    if (name == "freeze") return command::Freeze{on_or_off(words)};
    if (name == "clutch") return command::Clutch{on_or_off(words)};
    if (name == "penetrability") {
        const Penetrability asked = penetrability_from(words);
        if (asked.on) penetrability_ = asked;
        return Command(asked);
    }
    RendererSettings next = settings_;
    Command command;
    if (name == "isovalue") {
        expect_words(words, 2);
        isovalue_ = io::level_from_text(words[1], field_.volume());
        return command::Isovalue{isovalue_};
    }
    if (name == "friction") {
        expect_words(words, 2);
        command = next.proxy.friction = friction_from(name, words[1]);
    } else if (name == "scale") {
        expect_words(words, 2);
        command = command::Scale{number(words, 1, "scale FACTOR")};
    } else if (name == "stiffness" || name == "damping" || name == "viscosity") {
        expect_words(words, 2);
        const double value = number(words, 1, "a number");
        (name == "stiffness" ? next.force.stiffness
         : name == "damping" ? next.force.damping
                             : next.force.viscosity) = value;
        command = next.force;
    } else {
        throw std::invalid_argument("there is no command '" + name +
                                    "'; there are isovalue, stiffness, damping, viscosity, "
                                    "friction, penetrability, forces, "
                                    "freeze, clutch, scale, brush, carve, add, smooth, paint, "
                                    "fill, undo, redo, save, play, pause, step, seek, loop, quit");
    }
    check(command, settings_, field_.solid());
    settings_ = next;
    return command;
}

std::optional<Request> LiveCommands::from_key(char key, const Snapshot& now) {
    const double step = 0.01 * (field_.volume().maximum() - field_.volume().minimum());
    const double isovalue = now.session.tick.proxy.isovalue;
    switch (key) {
        case ' ':
            return command::Forces{!now.forces_on};
        case 'f':
            return command::Freeze{!now.session.frozen};
        case 'c':
            return command::Clutch{!now.session.clutched};
        case '+':
            return command::Isovalue{isovalue_ = isovalue + step};
        case '-':
            return command::Isovalue{isovalue_ = isovalue - step};
        case '[':
            return command::Scale{now.session.transform.scale / 1.1};
        case ']':
            return command::Scale{now.session.transform.scale * 1.1};
        case 'p':
            if (now.penetrability_on) return Command(no_penetrability());
            // From what is felt now, unless something else was asked for before.
            return Command(
                penetrability_.value_or(penetrability_threshold(1, isovalue, field_.solid())));
        case 'b':
            brush_ = brush_
                         ? std::nullopt
                         : std::optional(last_brush_.value_or(run::usual_brush(field_.geometry())));
            return DataRequest(ask::SetBrush{brush_});
        case 'u':
            return DataRequest(ask::Undo{});
        case 'r':
            return DataRequest(ask::Redo{});
        case 'k':
            return DataRequest(ask::Play{now.speed != 0 ? 0.0 : 1.0});
        case ',':
            return DataRequest(ask::Step{-1});
        case '.':
            return DataRequest(ask::Step{1});
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
           "isovalue by 1 %, [ ] scale, p penetrability, b brush on/off, u undo, r redo, k play or "
           "pause a sequence, , . a frame back or on, q quit, ? this";
}

std::vector<TimedRequest> read_commands(const std::string& path, LiveCommands& commands) {
    std::istringstream lines(io::read_text(path));
    std::vector<TimedRequest> requests;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        line.resize(std::min(line.find('#'), line.size()));
        std::istringstream words(line);
        std::string time, rest;
        if (!(words >> time)) continue;
        std::getline(words, rest);
        const auto fail = [&](const std::string& problem) {
            throw io::InputError(fmt::format("{}, line {}: {}", path, number, problem));
        };
        const auto seconds = io::number_from<double>(time);
        if (!seconds || !(*seconds >= 0)) {
            fail(io::quoted(time) +
                 " is no time: lines are SECONDS COMMAND, as in 1.5 isovalue 300");
        }
        if (!requests.empty() && *seconds < requests.back().time) {
            fail("the time goes back: put the lines in order");
        }
        try {
            requests.push_back({*seconds, commands.from_words(rest)});
        } catch (const std::invalid_argument& e) {
            fail(e.what());
        }
    }
    return requests;
}

}  // namespace palpate::app
