// Converts recipes of samples to JSON and back.
#include "io/recording/samples_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "io/json_members.hpp"
#include "palpate/names.hpp"

namespace palpate::io {
namespace {

Json json_of(const Vec3& v) {
    return {v[0], v[1], v[2]};
}
Json json_of(const Index3& v) {
    return {v[0], v[1], v[2]};
}

Json json_of(const Pose& pose) {
    const Quaternion& q = pose.orientation;
    return {{"position", json_of(pose.position)}, {"wxyz", {q.w(), q.x(), q.y(), q.z()}}};
}

Json json_of(const Brush& brush) {
    return {{"kind", name_of(brush.kind)}, {"radius", brush.radius},
            {"hardness", brush.hardness},  {"strength", brush.strength},
            {"level", brush.level},        {"solid", enum_name(brush.solid)},
            {"value", brush.value}};
}

Json json_of(const edit::Stroke& stroke) {
    Json json = json_of(stroke.brush);
    json["from"] = json_of(stroke.from);
    json["to"] = json_of(stroke.to);
    return json;
}

Json json_of(const edit::Sweep& sweep, Bodies& bodies) {
    Json json = json_of(sweep.brush);
    json["from"] = json_of(sweep.from);
    json["to"] = json_of(sweep.to);
    const auto known = std::ranges::find(bodies, sweep.body);
    if (known != bodies.end()) {
        json["body"] = known - bodies.begin();
        return json;
    }
    bodies.push_back(sweep.body);
    const ToolBody& body = *sweep.body;
    json["body"] = {
        {"tool", to_value(*body.tool())}, {"step", body.step()}, {"reach", body.reach()}};
    return json;
}

Json json_of(const Edit& edit, Bodies& bodies) {
    if (const auto* stroke = std::get_if<edit::Stroke>(&edit))
        return {{"stroke", json_of(*stroke)}};
    if (const auto* sweep = std::get_if<edit::Sweep>(&edit))
        return {{"sweep", json_of(*sweep, bodies)}};
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

Brush brush_from(const Json& json) {
    Brush brush;
    brush.kind = brush_kind_from(word(json, "kind"));
    brush.radius = number(json, "radius");
    brush.hardness = number(json, "hardness");
    brush.strength = number(json, "strength");
    brush.level = number(json, "level");
    brush.solid = named<Solid>(word(json, "solid"));
    brush.value = number(json, "value");
    return brush;
}

Pose pose_from(const Json& json) {
    const Json& wxyz = member(json, "wxyz");
    if (!wxyz.is_array() || wxyz.size() != 4) wrong("wxyz");
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = number_from_json(wxyz[i], "wxyz");
    return {vector(json, "position"), {q[0], q[1], q[2], q[3]}};
}

std::shared_ptr<const ToolBody> body_from(const Json& json, Bodies& bodies) {
    if (json.is_number()) {
        if (!json.is_number_unsigned() || json.get<std::uint64_t>() >= bodies.size()) wrong("body");
        return bodies[json.get<std::size_t>()];
    }
    Tool tool;
    from_value(member(json, "tool"), "tool", tool);
    bodies.push_back(std::make_shared<const ToolBody>(std::make_shared<const Tool>(std::move(tool)),
                                                      number(json, "step"), number(json, "reach")));
    return bodies.back();
}

Edit edit_from(const Json& json, Bodies& bodies) {
    if (json.contains("stroke")) {
        const Json& stroke = json.at("stroke");
        return edit::Stroke{brush_from(stroke), vector(stroke, "from"), vector(stroke, "to")};
    }
    if (json.contains("sweep")) {
        const Json& sweep = json.at("sweep");
        return edit::Sweep{brush_from(sweep), body_from(member(sweep, "body"), bodies),
                           pose_from(member(sweep, "from")), pose_from(member(sweep, "to"))};
    }
    const Json& fill = json.at("fill");
    return edit::Fill{{index(fill, "low"), index(fill, "high")}, number(fill, "value")};
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

Json to_json(const command::Samples& samples, Bodies& bodies) {
    Json json{{"version", samples.version}};
    if (!samples.recipe) return json;
    if (const auto* made = std::get_if<EditOf>(samples.recipe.get())) {
        json["of"] = made->version;
        json["edit"] = json_of(made->edit, bodies);
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

command::Samples samples_command_from_json(const Json& json, Bodies& bodies) {
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
    if (edit.contains("stroke") || edit.contains("sweep") || edit.contains("fill")) {
        samples.recipe = std::make_shared<const Recipe>(EditOf{of, edit_from(edit, bodies)});
    }
    return samples;
}

}  // namespace palpate::io
