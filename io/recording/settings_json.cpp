// Settings and commands: their lists of members, and plain values as JSON.
#include "io/recording/settings_json.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "io/json_members.hpp"
#include "io/layers_json.hpp"
#include "io/recording/samples_json.hpp"
#include "io/recording/session_point_json.hpp"

namespace palpate::io {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class T>
T whole_number(const Json& json, const std::string& name) {
    const auto number = json.is_number_integer() ? json.get<std::int64_t>() : -1;
    if (number < 0 || number > std::int64_t{std::numeric_limits<T>::max()}) {
        wrong_member(name, "a whole number");
    }
    return static_cast<T>(number);
}

}  // namespace

void wrong_member(const std::string& name, const std::string& wanted) {
    throw std::invalid_argument("'" + name + "' must be " + wanted);
}

void missing_member(const std::string& name) {
    throw std::invalid_argument("'" + name + "' is missing");
}

std::string one_of(const std::vector<std::string>& names) {
    std::string words = names.front();
    for (std::size_t i = 1; i < names.size(); ++i) {
        words.append(i + 1 < names.size() ? ", " : " or ").append(names[i]);
    }
    return words;
}

Json to_value(const Vec3& value) {
    Json list = Json::array();
    for (int i = 0; i < 3; ++i) list.push_back(number_to_json(value[i]));
    return list;
}

Json to_value(const Index3& value) {
    return {value[0], value[1], value[2]};
}

Json to_value(const Mat3& value) {
    Json rows = Json::array();
    for (int r = 0; r < 3; ++r) rows.push_back(to_value(Vec3(value.row(r))));
    return rows;
}

void from_value(const Json& json, const std::string& name, bool& value) {
    if (!json.is_boolean()) wrong_member(name, "true or false");
    value = json.get<bool>();
}

void from_value(const Json& json, const std::string& name, double& value) {
    value = number_from_json(json, name);
}

void from_value(const Json& json, const std::string& name, std::string& value) {
    if (!json.is_string()) wrong_member(name, "text");
    value = json.get<std::string>();
}

void from_value(const Json& json, const std::string& name, int& value) {
    value = whole_number<int>(json, name);
}

void from_value(const Json& json, const std::string& name, std::uint32_t& value) {
    value = whole_number<std::uint32_t>(json, name);
}

void from_value(const Json& json, const std::string& name, Vec3& value) {
    if (!json.is_array() || json.size() != 3) wrong_member(name, "three numbers");
    for (int i = 0; i < 3; ++i) value[i] = number_from_json(json[std::size_t(i)], name);
}

void from_value(const Json& json, const std::string& name, Index3& value) {
    Vec3 numbers;
    from_value(json, name, numbers);
    if (!(numbers.cwiseAbs().maxCoeff() <= 1 << 20)) wrong_member(name, "an index of a grid");
    value = numbers.cast<int>();
}

void from_value(const Json& json, const std::string& name, Mat3& value) {
    if (!json.is_array() || json.size() != 3) wrong_member(name, "three rows of three numbers");
    for (int r = 0; r < 3; ++r) {
        Vec3 row;
        from_value(json[std::size_t(r)], name, row);
        value.row(r) = row;
    }
}

Json to_value(const Quaternion& value) {
    Json list = Json::array();
    for (const double part : {value.w(), value.x(), value.y(), value.z()}) {
        list.push_back(number_to_json(part));
    }
    return list;
}

void from_value(const Json& json, const std::string& name, Quaternion& value) {
    if (!json.is_array() || json.size() != 4) wrong_member(name, "four numbers");
    std::array<double, 4> part{};
    for (std::size_t i = 0; i < 4; ++i) part[i] = number_from_json(json[i], name);
    value = Quaternion(part[0], part[1], part[2], part[3]);
}

Json to_value(const Layers& layers) {
    return to_json(layers);
}

void from_value(const Json& json, const std::string&, Layers& layers) {
    layers = layers_from_json(json);
}

/// Shapes with more triangles are left out.
constexpr std::size_t most_triangles_kept = 20'000;

Json to_value(const Tool& tool) {
    Json points = Json::array();
    for (const Vec3& point : tool.points()) points.push_back(to_value(point));
    Json json = {{"points", points}, {"gyration", tool.gyration()}, {"turns", tool.turns()}};
    const ToolShape& shape = tool.shape();
    if (shape.triangles.empty() || shape.triangles.size() > most_triangles_kept) return json;
    Json& vertices = json["vertices"] = Json::array();
    for (const Vec3& vertex : shape.vertices) vertices.push_back(to_value(vertex));
    json["triangles"] = shape.triangles;
    return json;
}

/// The shape of a tool, which may be missing.
ToolShape shape_from(const Json& json, const std::string& name) {
    ToolShape shape;
    if (!json.contains("triangles")) return shape;
    const Json &vertices = member(json, "vertices"), &triangles = json["triangles"];
    if (!vertices.is_array()) wrong_member(name + ".vertices", "a list of points");
    if (!triangles.is_array()) wrong_member(name + ".triangles", "a list of triangles");
    shape.vertices.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        from_value(vertices[i], name + ".vertices", shape.vertices[i]);
    }
    shape.triangles.resize(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (!triangles[i].is_array() || triangles[i].size() != 3) {
            wrong_member(name + ".triangles", "three numbers each");
        }
        for (std::size_t k = 0; k < 3; ++k) {
            from_value(triangles[i][k], name + ".triangles", shape.triangles[i][k]);
        }
    }
    return shape;
}

void from_value(const Json& json, const std::string& name, Tool& tool) {
    const Json& list = member(json, "points");
    if (!list.is_array() || list.size() > most_tool_points) {
        wrong_member(name + ".points", "a list of at most 20000 points");
    }
    std::vector<Vec3> points(list.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        from_value(list[i], name + ".points", points[i]);
    }
    double gyration = 0;
    bool turns = true;
    from_value(member(json, "gyration"), name + ".gyration", gyration);
    from_value(member(json, "turns"), name + ".turns", turns);
    tool = Tool(std::move(points), gyration, turns, shape_from(json, name));
}

// The lists of members. Not in an unnamed namespace, where JsonWriter would not find them.

static void members(auto& v, Is<Penetrability> auto& s) {
    PALPATE_MEMBERS(on, threshold, range_count)
    if (s.range_count < 0 || s.range_count > Penetrability::most_ranges) {
        wrong_member("range_count", "0 to 16");
    }
    numbered(v, "range_", s.ranges, s.range_count);
}

static void members(auto& v, Is<RendererSettings> auto& s) {
    v("friction", s.proxy.friction);
    v("step_budget", s.proxy.step_budget);
    PALPATE_MEMBERS(penetrability, layers, tool, force, device, transform, forces_on)
}

static void members(auto& v, Is<command::Isovalue> auto& s) {
    v("value", s.isovalue);
}
PALPATE_JSON(command::Freeze, on)
PALPATE_JSON(command::Clutch, on)
PALPATE_JSON(command::Forces, on)
PALPATE_JSON(command::Scale, scale)
PALPATE_JSON(command::UseLayers, layers, same_surfaces)
PALPATE_JSON(command::UseTool, tool)
PALPATE_JSON(command::Moment, time)
PALPATE_JSON(command::Speed, speed)
static void members(auto&, Is<command::Lift> auto&) {}

namespace {

template <class T>
Json written(const T& value) {
    return JsonWriter::of(value);
}

/// The name of each alternative of Command, in its order.
constexpr std::array command_names{"isovalue", "freeze", "clutch",   "forces",        "scale",
                                   "samples",  "moment", "speed",    "layers",        "tool",
                                   "resume",   "force",  "friction", "penetrability", "transform",
                                   "limits",   "lift"};
static_assert(command_names.size() == std::variant_size_v<Command>);

template <std::size_t i = 0>
Command command_named(const std::string& name, const Json& json, Bodies& bodies) {
    if constexpr (i == command_names.size()) {
        throw std::invalid_argument("there is no command '" + name + "'");
    } else {
        if (name != command_names[i]) return command_named<i + 1>(name, json, bodies);
        std::variant_alternative_t<i, Command> command{};
        if constexpr (std::same_as<decltype(command), command::Samples>) {
            return samples_command_from_json(json, bodies);
        } else {
            JsonReader reader{json};
            members(reader, command);
            return command;
        }
    }
}

}  // namespace

const Json& member(const Json& json, const char* name) {
    if (!json.is_object() || !json.contains(name)) missing_member(name);
    return json.at(name);
}

double number_from_json(const Json& json, const std::string& name) {
    if (json.is_number()) return json.get<double>();
    if (json == "inf") return infinity;
    if (json == "-inf") return -infinity;
    wrong_member(name, "a number, \"inf\" or \"-inf\"");
}

Json number_to_json(double value) {
    if (std::isfinite(value)) return value;
    return value > 0 ? "inf" : "-inf";
}

Json to_json(const RendererSettings& settings) {
    return written(settings);
}

Json to_json(const SessionSettings& settings) {
    return written(settings);
}

Json to_json(const Command& command, Bodies& bodies) {
    // Samples are written as their recipe, which is more than a list of members.
    const Overloaded write{
        [&](const command::Samples& samples) { return to_json(samples, bodies); },
        [](const auto& alternative) { return written(alternative); }};
    return {{command_names[command.index()], std::visit(write, command)}};
}

void from_json(const Json& json, RendererSettings& settings) {
    JsonReader reader{json};
    members(reader, settings);
}

void from_json(const Json& json, SessionSettings& settings) {
    JsonReader reader{json};
    members(reader, settings);
}

Command command_from_json(const Json& json, Bodies& bodies) {
    if (!json.is_object() || json.size() != 1) {
        throw std::invalid_argument("a command is an object of one member");
    }
    return command_named(json.begin().key(), json.begin().value(), bodies);
}

}  // namespace palpate::io
