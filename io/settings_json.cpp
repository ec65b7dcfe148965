// One list of members a struct serves both ways: a Writer or a Reader walks through it.
#include "io/settings_json.hpp"

#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <stdexcept>
#include <string>

#include "io/samples_json.hpp"

namespace palpate::io {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

[[noreturn]] void wrong(const char* name, const char* wanted) {
    throw std::invalid_argument(std::string("'") + name + "' must be " + wanted);
}

struct Writer {
    Json json = Json::object();

    void operator()(const char* name, const double& value) { json[name] = number_to_json(value); }
    void operator()(const char* name, const bool& value) { json[name] = value; }
    void operator()(const char* name, const int& value) { json[name] = value; }
    void operator()(const char* name, const std::uint32_t& value) { json[name] = value; }
    void operator()(const char* name, const Vec3& value) {
        Json& list = json[name] = Json::array();
        for (int i = 0; i < 3; ++i) list.push_back(number_to_json(value[i]));
    }
    void operator()(const char* name, const Mat3& value) {
        Json& rows = json[name] = Json::array();
        for (int r = 0; r < 3; ++r) {
            Json row = Json::array();
            for (int c = 0; c < 3; ++c) row.push_back(number_to_json(value(r, c)));
            rows.push_back(row);
        }
    }
    template <class T>
    void part(const char* name, const T& value);
};

struct Reader {
    const Json& json;

    const Json* find(const char* name) const {
        if (!json.is_object()) wrong(name, "a member of an object");
        const auto found = json.find(name);
        return found == json.end() ? nullptr : &*found;
    }
    void operator()(const char* name, double& value) {
        if (const Json* j = find(name)) value = number_from_json(*j, name);
    }
    void operator()(const char* name, bool& value) {
        const Json* j = find(name);
        if (!j) return;
        if (!j->is_boolean()) wrong(name, "true or false");
        value = j->get<bool>();
    }
    void operator()(const char* name, int& value) { whole(name, value); }
    void operator()(const char* name, std::uint32_t& value) { whole(name, value); }
    template <class T>
    void whole(const char* name, T& value) {
        const Json* j = find(name);
        if (!j) return;
        const auto number = j->is_number_integer() ? j->get<std::int64_t>() : -1;
        if (number < 0 || number > std::int64_t{std::numeric_limits<T>::max()}) {
            wrong(name, "a whole number");
        }
        value = static_cast<T>(number);
    }
    void operator()(const char* name, Vec3& value) {
        const Json* j = find(name);
        if (!j) return;
        if (!j->is_array() || j->size() != 3) wrong(name, "three numbers");
        for (int i = 0; i < 3; ++i) value[i] = number_from_json((*j)[std::size_t(i)], name);
    }
    void operator()(const char* name, Mat3& value) {
        const Json* j = find(name);
        if (!j) return;
        if (!j->is_array() || j->size() != 3) wrong(name, "three rows of three numbers");
        for (int r = 0; r < 3; ++r) {
            const Json& row = (*j)[std::size_t(r)];
            if (!row.is_array() || row.size() != 3) wrong(name, "three rows of three numbers");
            for (int c = 0; c < 3; ++c) value(r, c) = number_from_json(row[std::size_t(c)], name);
        }
    }
    template <class T>
    void part(const char* name, T& value);
};

/// S is T, const or not: written from const settings, read into others.
template <class S, class T>
concept Is = std::same_as<std::remove_const_t<S>, T>;

void members(auto& v, Is<Friction> auto& s) {
    v("static", s.static_coefficient);
    v("dynamic", s.dynamic_coefficient);
}

void members(auto& v, Is<Magnet> auto& s) {
    v("distance", s.distance);
    v("peak", s.peak);
}

void members(auto& v, Is<Texture> auto& s) {
    v("amplitude", s.amplitude);
    v("wavelength", s.wavelength);
}

void members(auto& v, Is<ForceSettings> auto& s) {
    v("stiffness", s.stiffness);
    v("damping", s.damping);
    v("viscosity", s.viscosity);
    v.part("magnet", s.magnet);
    v.part("texture", s.texture);
    v("limit", s.limit);
    v("rate_limit", s.rate_limit);
    v("ramp", s.ramp);
    v("stale_after", s.stale_after);
    v("start_below", s.start_below);
}

void members(auto& v, Is<DeviceLimits> auto& s) {
    v("maximum_force", s.maximum_force);
    v("rate", s.rate);
    v("physical_damping", s.physical_damping);
}

void members(auto& v, Is<DeviceTransform> auto& s) {
    v("rotation", s.rotation);
    v("translation", s.translation);
    v("scale", s.scale);
}

void members(auto& v, Is<DensityRange> auto& s) {
    v("low", s.low);
    v("high", s.high);
}

void members(auto& v, Is<Penetrability> auto& s) {
    v("on", s.on);
    v("threshold", s.threshold);
    v("range_count", s.range_count);
    if (s.range_count < 0 || s.range_count > Penetrability::most_ranges) {
        wrong("range_count", "0 to 16");
    }
    for (int i = 0; i < s.range_count; ++i) {
        v.part(("range_" + std::to_string(i + 1)).c_str(), s.ranges[static_cast<std::size_t>(i)]);
    }
}

void members(auto& v, Is<SessionSettings> auto& s) {
    v("clutch_buttons", s.clutch_buttons);
    v("deadman_buttons", s.deadman_buttons);
    v("fastest_hand", s.fastest_hand);
    v("overrun", s.overrun);
}

void members(auto& v, Is<RendererSettings> auto& s) {
    v.part("friction", s.proxy.friction);
    v("step_budget", s.proxy.step_budget);
    v.part("penetrability", s.penetrability);
    v.part("force", s.force);
    v.part("device", s.device);
    v.part("transform", s.transform);
    v("forces_on", s.forces_on);
}

void members(auto& v, Is<command::Isovalue> auto& s) {
    v("value", s.isovalue);
}
void members(auto& v, Is<command::Freeze> auto& s) {
    v("on", s.on);
}
void members(auto& v, Is<command::Clutch> auto& s) {
    v("on", s.on);
}
void members(auto& v, Is<command::Forces> auto& s) {
    v("on", s.on);
}
void members(auto& v, Is<command::Scale> auto& s) {
    v("scale", s.scale);
}

void members(auto& v, Is<command::Moment> auto& s) {
    v("time", s.time);
}
void members(auto& v, Is<command::Speed> auto& s) {
    v("speed", s.speed);
}

template <class T>
void Writer::part(const char* name, const T& value) {
    Writer part;
    members(part, value);
    json[name] = std::move(part.json);
}

template <class T>
void Reader::part(const char* name, T& value) {
    const Json* j = find(name);
    if (!j) return;
    if (!j->is_object()) wrong(name, "an object");
    Reader part{*j};
    members(part, value);
}

template <class T>
Json written(const T& value) {
    Writer writer;
    members(writer, value);
    return std::move(writer.json);
}

/// Told by their recipe, which is more than a list of members.
Json written(const command::Samples& samples) {
    return to_json(samples);
}

/// The name of each alternative of Command, in its order.
constexpr std::array command_names{"isovalue",      "freeze",    "clutch", "forces", "scale",
                                   "samples",       "moment",    "speed",  "force",  "friction",
                                   "penetrability", "transform", "limits"};
static_assert(command_names.size() == std::variant_size_v<Command>);

template <std::size_t i = 0>
Command command_named(const std::string& name, const Json& json) {
    if constexpr (i == command_names.size()) {
        throw std::invalid_argument("there is no command '" + name + "'");
    } else {
        if (name != command_names[i]) return command_named<i + 1>(name, json);
        std::variant_alternative_t<i, Command> command{};
        if constexpr (std::same_as<decltype(command), command::Samples>) {
            return samples_command_from_json(json);
        } else {
            Reader reader{json};
            members(reader, command);
            return command;
        }
    }
}

}  // namespace

const Json& member(const Json& json, const char* name) {
    if (!json.is_object() || !json.contains(name)) {
        throw std::invalid_argument(std::string("'") + name + "' is missing");
    }
    return json.at(name);
}

double number_from_json(const Json& json, const char* name) {
    if (json.is_number()) return json.get<double>();
    if (json == "inf") return infinity;
    if (json == "-inf") return -infinity;
    wrong(name, "a number, \"inf\" or \"-inf\"");
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

Json to_json(const Command& command) {
    return {{command_names[command.index()],
             std::visit([](const auto& alternative) { return written(alternative); }, command)}};
}

void from_json(const Json& json, RendererSettings& settings) {
    Reader reader{json};
    members(reader, settings);
}

void from_json(const Json& json, SessionSettings& settings) {
    Reader reader{json};
    members(reader, settings);
}

Command command_from_json(const Json& json) {
    if (!json.is_object() || json.size() != 1) {
        throw std::invalid_argument("a command is an object of one member");
    }
    return command_named(json.begin().key(), json.begin().value());
}

}  // namespace palpate::io
