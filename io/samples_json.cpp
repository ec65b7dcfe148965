// Converts recipes of samples to JSON and back.
#include "io/samples_json.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate::io {
namespace {

Json json_of(const Vec3& v) {
    return {v[0], v[1], v[2]};
}
Json json_of(const Index3& v) {
    return {v[0], v[1], v[2]};
}

Json json_of(const edit::Stroke& stroke) {
    const Brush& brush = stroke.brush;
    return {
        {"kind", name_of(brush.kind)}, {"radius", brush.radius},
        {"hardness", brush.hardness},  {"strength", brush.strength},
        {"level", brush.level},        {"solid", brush.solid == Solid::below ? "below" : "above"},
        {"value", brush.value},        {"from", json_of(stroke.from)},
        {"to", json_of(stroke.to)}};
}

Json json_of(const Edit& edit) {
    if (const auto* stroke = std::get_if<edit::Stroke>(&edit))
        return {{"stroke", json_of(*stroke)}};
    if (const auto* fill = std::get_if<edit::Fill>(&edit)) {
        return {{"fill",
                 {{"low", json_of(fill->box.low)},
                  {"high", json_of(fill->box.high)},
                  {"value", fill->value}}}};
    }
    const auto& replace = std::get<edit::Replace>(edit);
    const Index3 high = replace.at + replace.samples.geometry().size - Index3::Ones();
    return {{"replace", {{"low", json_of(replace.at)}, {"high", json_of(high)}}}};
}

[[noreturn]] void wrong(const char* name) {
    throw std::invalid_argument(std::string("'") + name + "' of the samples is not valid");
}

double number(const Json& json, const char* name) {
    return number_from_json(member(json, name), name);
}

std::string word(const Json& json, const char* name) {
    const Json& text = member(json, name);
    if (!text.is_string()) wrong(name);
    return text.get<std::string>();
}

Vec3 vector(const Json& json, const char* name) {
    const Json& list = member(json, name);
    if (!list.is_array() || list.size() != 3) wrong(name);
    return {number_from_json(list[0], name), number_from_json(list[1], name),
            number_from_json(list[2], name)};
}

Index3 index(const Json& json, const char* name) {
    const Vec3 v = vector(json, name);
    if (!(v.cwiseAbs().maxCoeff() <= 1 << 20)) wrong(name);
    return v.cast<int>();
}

std::uint64_t whole(const Json& json, const char* name) {
    const Json& value = member(json, name);
    if (!value.is_number_unsigned()) wrong(name);
    return value.get<std::uint64_t>();
}

edit::Stroke stroke_from(const Json& json) {
    edit::Stroke stroke;
    Brush& brush = stroke.brush;
    brush.kind = brush_kind_from(word(json, "kind"));
    brush.radius = number(json, "radius");
    brush.hardness = number(json, "hardness");
    brush.strength = number(json, "strength");
    brush.level = number(json, "level");
    brush.solid = word(json, "solid") == "below" ? Solid::below : Solid::above;
    brush.value = number(json, "value");
    stroke.from = vector(json, "from");
    stroke.to = vector(json, "to");
    return stroke;
}

FramesOf frames_from(const Json& json) {
    const Json& numbers = member(json, "frames");
    const Json& times = member(json, "times");
    if (!numbers.is_array() || !times.is_array() || numbers.size() != times.size()) wrong("frames");
    FramesOf frames;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (!numbers[i].is_number_unsigned() || numbers[i].get<std::uint64_t>() > 1 << 30) {
            wrong("frames");
        }
        frames.numbers.push_back(numbers[i].get<int>());
        frames.times.push_back(number_from_json(times[i], "times"));
    }
    frames.period = number(json, "period");
    return frames;
}

BricksOf bricks_from(const Json& json) {
    BricksOf bricks{whole(json, "of"), {}};
    const Json& list = member(json, "bricks");
    if (!list.is_array()) wrong("bricks");
    for (const Json& each : list) {
        if (!each.is_array() || each.size() != 4) wrong("bricks");
        std::array<int, 4> numbers{};
        for (std::size_t i = 0; i < 4; ++i) {
            if (!each[i].is_number_integer()) wrong("bricks");
            const auto number = each[i].get<std::int64_t>();
            if (number < -1 || number > 1 << 30) wrong("bricks");
            numbers[i] = static_cast<int>(number);
        }
        bricks.bricks.push_back({{numbers[0], numbers[1], numbers[2]}, numbers[3]});
    }
    return bricks;
}

Json json_of(const BricksOf& bricks) {
    Json list = Json::array();
    for (const BricksOf::Brick& brick : bricks.bricks) {
        list.push_back({brick.at[0], brick.at[1], brick.at[2], brick.level});
    }
    return list;
}

}  // namespace

Json to_json(const command::Samples& samples) {
    Json json{{"version", samples.version}};
    if (!samples.recipe) return json;
    if (const auto* made = std::get_if<EditOf>(samples.recipe.get())) {
        json["of"] = made->version;
        json["edit"] = json_of(made->edit);
        return json;
    }
    if (const auto* bricks = std::get_if<BricksOf>(samples.recipe.get())) {
        json["of"] = bricks->version;
        json["bricks"] = json_of(*bricks);
        return json;
    }
    const auto& frames = std::get<FramesOf>(*samples.recipe);
    json["frames"] = frames.numbers;
    json["times"] = frames.times;
    json["period"] = frames.period;
    return json;
}

command::Samples samples_command_from_json(const Json& json) {
    command::Samples samples;
    samples.version = whole(json, "version");
    if (json.contains("frames")) {
        samples.recipe = std::make_shared<const Recipe>(frames_from(json));
        return samples;
    }
    if (json.contains("bricks")) {
        samples.recipe = std::make_shared<const Recipe>(bricks_from(json));
        return samples;
    }
    if (!json.contains("edit")) return samples;
    const Json& edit = member(json, "edit");
    const std::uint64_t of = whole(json, "of");
    if (edit.contains("stroke")) {
        samples.recipe = std::make_shared<const Recipe>(EditOf{of, stroke_from(edit.at("stroke"))});
    } else if (edit.contains("fill")) {
        const Json& fill = edit.at("fill");
        const SampleBox box{index(fill, "low"), index(fill, "high")};
        samples.recipe =
            std::make_shared<const Recipe>(EditOf{of, edit::Fill{box, number(fill, "value")}});
    }
    return samples;
}

}  // namespace palpate::io
