// Converts recipes of samples to JSON and back.
#include "io/recording/samples_json.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <variant>

#include "io/json_members.hpp"
#include "palpate/names.hpp"

namespace palpate {

static io::Json to_value(const BricksOf::Change& brick) {
    return {brick.at[0], brick.at[1], brick.at[2], brick.level};
}

static void from_value(const io::Json& json, const std::string& name, BricksOf::Change& brick) {
    std::array<int, 4> numbers{};
    if (!json.is_array() || json.size() != numbers.size()) io::wrong_member(name, "four numbers");
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto number = json[i].is_number_integer() ? json[i].get<std::int64_t>() : -2;
        if (number < -1 || number > 1 << 30) io::wrong_member(name, "whole numbers from -1");
        numbers[i] = static_cast<int>(number);
    }
    brick = {{numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

}  // namespace palpate

namespace palpate::io {

// The lists of members. Recordings from before a brush got a setting have its default. Not in an
// unnamed namespace, where JsonWriter would not find them.

static void members(auto& v, Is<Pose> auto& s) {
    v.needed("position", s.position);
    v.needed("wxyz", s.orientation);
}
static void members(auto& v, Is<edit::Stroke> auto& s) {
    members(v, s.brush);
    v.needed("from", s.from);
    v.needed("to", s.to);
}
/// But for its body, which is written once in a recording.
static void members(auto& v, Is<edit::Sweep> auto& s) {
    members(v, s.brush);
    v.needed("from", s.from);
    v.needed("to", s.to);
}
static void members(auto& v, Is<edit::Fill> auto& s) {
    v.needed("low", s.box.low);
    v.needed("high", s.box.high);
    v.needed("value", s.value);
}
static void members(auto& v, Is<FramesOf> auto& s) {
    v.needed("frames", s.numbers);
    v.needed("times", s.times);
    v.needed("period", s.period);
    v.must(std::ranges::all_of(s.numbers, [](int n) { return n >= 0; }), "frames",
           "whole numbers from 0");
    v.must(s.numbers.size() == s.times.size(), "frames", "as many as times");
}
/// But for its version, which an edit has, too.
static void members(auto& v, Is<BricksOf> auto& s) {
    v.needed("bricks", s.bricks);
}

namespace {

template <class T>
T read(const Json& json) {
    T value;
    JsonReader reader{json};
    members(reader, value);
    return value;
}

Json json_of(const std::shared_ptr<const ToolBody>& body, Bodies& bodies) {
    const auto known = std::ranges::find(bodies, body);
    if (known != bodies.end()) return known - bodies.begin();
    bodies.push_back(body);
    return {{"tool", to_value(*body->tool())}, {"step", body->step()}, {"reach", body->reach()}};
}

Json json_of(const Edit& edit, Bodies& bodies) {
    const Overloaded write{
        [](const edit::Stroke& stroke) {
            return Json{{"stroke", JsonWriter::of(stroke)}};
        },
        [&](const edit::Sweep& sweep) {
            Json json = JsonWriter::of(sweep);
            json["body"] = json_of(sweep.body, bodies);
            return Json{{"sweep", json}};
        },
        [](const edit::Fill& fill) {
            return Json{{"fill", JsonWriter::of(fill)}};
        },
        [](const edit::Replace& replace) {
            const Index3 high = replace.at + replace.samples.geometry().size - Index3::Ones();
            return Json{{"replace", {{"low", to_value(replace.at)}, {"high", to_value(high)}}}};
        }};
    return std::visit(write, edit);
}

double number(const Json& json, const char* name) {
    return number_from_json(member(json, name), name);
}

std::uint64_t whole(const Json& json, const char* name) {
    const Json& value = member(json, name);
    if (!value.is_number_unsigned()) wrong_member(name, "a whole number");
    return value.get<std::uint64_t>();
}

std::shared_ptr<const ToolBody> body_from(const Json& json, Bodies& bodies) {
    if (json.is_number()) {
        if (!json.is_number_unsigned() || json.get<std::uint64_t>() >= bodies.size()) {
            wrong_member("body", "the number of one that came before");
        }
        return bodies[json.get<std::size_t>()];
    }
    Tool tool;
    from_value(member(json, "tool"), "tool", tool);
    bodies.push_back(std::make_shared<const ToolBody>(std::make_shared<const Tool>(std::move(tool)),
                                                      number(json, "step"), number(json, "reach")));
    return bodies.back();
}

/// Nothing for samples that an application put in place.
std::optional<Edit> edit_from(const Json& json, Bodies& bodies) {
    if (json.contains("stroke")) return read<edit::Stroke>(json.at("stroke"));
    if (json.contains("fill")) return read<edit::Fill>(json.at("fill"));
    if (!json.contains("sweep")) return std::nullopt;
    auto sweep = read<edit::Sweep>(json.at("sweep"));
    sweep.body = body_from(member(json.at("sweep"), "body"), bodies);
    return sweep;
}

/// Nothing for samples whose recipe is not known.
std::optional<Recipe> recipe_from(const Json& json, Bodies& bodies) {
    if (json.contains("frames")) return read<FramesOf>(json);
    if (json.contains("bricks")) {
        auto bricks = read<BricksOf>(json);
        bricks.version = whole(json, "of");
        return bricks;
    }
    if (!json.contains("edit")) return std::nullopt;
    const std::uint64_t of = whole(json, "of");
    const auto edit = edit_from(json.at("edit"), bodies);
    if (!edit) return std::nullopt;
    return EditOf{of, *edit};
}

}  // namespace

Json to_json(const command::Samples& samples, Bodies& bodies) {
    Json json{{"version", samples.version}};
    if (!samples.recipe) return json;
    const Overloaded write{[&](const EditOf& made) {
                               json["of"] = made.version;
                               json["edit"] = json_of(made.edit, bodies);
                           },
                           [&](const BricksOf& bricks) {
                               json["of"] = bricks.version;
                               json.update(JsonWriter::of(bricks));
                           },
                           [&](const FramesOf& frames) { json.update(JsonWriter::of(frames)); }};
    std::visit(write, *samples.recipe);
    return json;
}

command::Samples samples_command_from_json(const Json& json, Bodies& bodies) {
    command::Samples samples;
    samples.version = whole(json, "version");
    if (const auto recipe = recipe_from(json, bodies)) {
        samples.recipe = std::make_shared<const Recipe>(*recipe);
    }
    return samples;
}

}  // namespace palpate::io
