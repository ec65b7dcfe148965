// The service's JSON, read with suspicion.
#include "devices/haply/protocol.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace palpate::devices::haply {
namespace {

using Json = nlohmann::json;

const Json* member(const Json* object, const char* key) {
    if (!object || !object->is_object()) return nullptr;
    const auto found = object->find(key);
    return found == object->end() ? nullptr : &*found;
}

/// Text of the service goes to terminals and into our own messages: one line, no control bytes.
std::string printable(const Json* value) {
    constexpr std::size_t longest = 160;
    if (!value || !value->is_string()) return {};
    std::string text = value->get_ref<const std::string&>().substr(0, longest);
    for (char& c : text) {
        if (c < 0x20 || c > 0x7e) c = '?';
    }
    return text;
}

std::string id_of(const Json& entry) {
    std::string id = printable(member(&entry, "device_id"));
    return is_device_id(id) ? id : std::string{};
}

std::optional<bool> truth(const Json* value) {
    if (value && value->is_boolean()) return value->get<bool>();
    if (value && value->is_number_integer()) return value->get<std::int64_t>() != 0;
    return std::nullopt;
}

std::optional<double> number(const Json* value) {
    if (!value || !value->is_number()) return std::nullopt;
    const double x = value->get<double>();
    return std::isfinite(x) ? std::optional(x) : std::nullopt;
}

/// The parser would take any depth, but nothing here is deep, and refusing is quicker.
bool too_deep(std::string_view text) {
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            quoted = c != '"';
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            if (++depth > deepest_message) return true;
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return false;
}

/// The entry with this id, or the one in its place if that one leaves its id out.
const Json* entry_of(const Json& list, const std::string& id, std::size_t place) {
    if (!list.is_array()) return nullptr;
    for (const Json& entry : list) {
        if (!id.empty() && id_of(entry) == id) return &entry;
    }
    if (place >= list.size() || !list[place].is_object()) return nullptr;
    return list[place].contains("device_id") ? nullptr : &list[place];
}

/// A position of which components may be left out once they are known; nothing if it is broken.
std::optional<Vec3> position_from(const Json& given, const std::optional<Vec3>& known) {
    if (!given.is_object()) return std::nullopt;
    Vec3 position = known.value_or(Vec3::Zero());
    constexpr std::array keys{"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
        const Json* component = member(&given, keys[static_cast<std::size_t>(i)]);
        if (!component && known) continue;
        const auto value = number(component);
        if (!value || std::abs(*value) > farthest_position) return std::nullopt;
        position[i] = *value;
    }
    return position.norm() <= farthest_position ? std::optional(position) : std::nullopt;
}

/// Returns nothing for a quaternion of zeros, which a sleeping grip sends.
std::optional<Mat3> rotation_from(const Json* given) {
    const auto w = number(member(given, "w")), x = number(member(given, "x"));
    const auto y = number(member(given, "y")), z = number(member(given, "z"));
    if (!w || !x || !y || !z) return std::nullopt;
    const double length = std::hypot(std::hypot(*w, *x), std::hypot(*y, *z));
    if (!(length > 0.5 && length < 2)) return std::nullopt;
    return Eigen::Quaterniond(*w / length, *x / length, *y / length, *z / length)
        .toRotationMatrix();
}

/// Wireless grips have the buttons a, b, c, wired ones a single one. What is left out is held as
/// before; what makes no sense is not held, for a button may be the dead-man switch.
std::uint32_t buttons_from(const Json* state, std::uint32_t buttons) {
    const auto set = [&](std::uint32_t bit, const Json* value) {
        if (value) buttons = truth(value).value_or(false) ? buttons | bit : buttons & ~bit;
    };
    set(1, member(state, "button"));
    const Json* named = member(state, "buttons");
    set(1, member(named, "a"));
    set(2, member(named, "b"));
    set(4, member(named, "c"));
    return buttons;
}

void take_grip(Grip& grip, const Json& message) {
    for (const char* key : {"wireless_verse_grip", "verse_grip"}) {
        const Json* list = member(&message, key);
        if (!list || (!grip.list.empty() && grip.list != key)) continue;
        if (grip.list.empty()) {
            if (!list->is_array() || list->empty() || !list->front().is_object()) continue;
            grip.list = key;
            grip.id = id_of(list->front());
        }
        const Json* entry = entry_of(*list, grip.id, grip.place);
        if (!entry) {
            // Out of reach, out of battery or unplugged: nothing is held any more. The orientation
            // stays, for a tool that snapped straight would jump in the hand.
            const Mat3 last = grip.orientation;
            grip = {};
            grip.orientation = last;
            return;
        }
        const Json* state = member(entry, "state");
        if (const auto rotation = rotation_from(member(state, "orientation"))) {
            grip.orientation = *rotation;
        }
        grip.buttons = buttons_from(state, grip.buttons);
        const Json* status = member(entry, "status");
        if (!truth(member(status, "connected")).value_or(true)) grip.buttons = 0;
        return;
    }
}

/// The complaint of the service. Its form is not documented.
std::string complaint_in(const Json* object) {
    for (const char* key : {"error", "errors", "error_message"}) {
        const Json* error = member(object, key);
        if (error && error->is_array() && !error->empty()) error = &error->front();
        if (error && error->is_object()) error = member(error, "message");
        if (std::string text = printable(error); !text.empty()) return text;
    }
    return {};
}

/// Our entry in its list. Null if it is not there.
const Json* find_ours(ServiceState& state, const Json& list) {
    const Json* entry = entry_of(list, state.device_id, state.place);
    if (entry) state.place = static_cast<std::size_t>(entry - &list.front());
    return entry;
}

/// The device that was asked for, if it is in this list. Notes which others are.
const Json* choose(ServiceState& state, const std::string& key, const Json& list) {
    for (std::size_t place = 0; place < list.size(); ++place) {
        const std::string id = id_of(list[place]);
        if (id.empty()) continue;
        if (state.wanted.empty() || state.wanted == id) {
            state.device_id = id;
            state.list = key;
            state.place = place;
            return &list[place];
        }
        if (state.attached.size() < 200)
            state.attached += (state.attached.empty() ? "" : ", ") + id;
    }
    return nullptr;
}

/// Missing members of a transform are those of the identity.
void take_transform(Mapping::Transform& known, const Json* given) {
    if (!given || !given->is_object()) return;
    known = Mapping::identity;
    std::size_t i = 0;
    const auto take = [&](const char* part, std::initializer_list<const char*> components) {
        for (const char* component : components) {
            const Json* value = member(member(given, part), component);
            // A number that is none is never what was pinned.
            if (value) known[i] = number(value).value_or(std::numeric_limits<double>::infinity());
            ++i;
        }
    };
    take("position", {"x", "y", "z"});
    take("rotation", {"w", "x", "y", "z"});
    take("scale", {"x", "y", "z"});
}

void take_mapping(Mapping& mapping, const Json* config) {
    const auto take = [](std::string& known, const Json* value) {
        if (value) known = printable(value);
    };
    take(mapping.preset, member(config, "preset"));
    take(mapping.basis, member(member(config, "basis"), "permutation"));
    take(mapping.handedness, member(config, "handedness"));
    take_transform(mapping.mount, member(config, "mount"));
}

void take_config(ServiceState& state, const Json* config) {
    take_mapping(state.mapping, config);
    if (!config && !state.model.empty()) return;
    std::string kind = state.list;
    kind.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(kind.front())));
    state.model = kind + " " + state.device_id;
    const Json* info = member(config, "device_info");
    const auto major = number(member(info, "major_version"));
    const auto minor = number(member(info, "minor_version"));
    if (major && minor && std::abs(*major) < 1e6 && std::abs(*minor) < 1e6) {
        state.model += ", firmware " + std::to_string(static_cast<int>(*major)) + "." +
                       std::to_string(static_cast<int>(*minor));
    }
}

void take_status(ServiceState& state, const Json* status) {
    const auto take = [&](std::optional<bool>& known, const char* key) {
        if (const Json* value = member(status, key)) known = truth(value).value_or(false);
    };
    take(state.calibrated, "calibrated");
    take(state.ready, "ready");
    take(state.started, "started");
    take(state.powered, "power_supply");
}

/// Inverse3, Inverse3x, Minverse: the service's own name for all of them is *inverse. The keys of
/// the latter two are not documented.
bool is_list_of_devices(const std::string& key) {
    return key.find("inverse") != std::string::npos && is_device_id(key);
}

News refuse(ServiceState& state, std::string reason) {
    state.error = std::move(reason);
    return News::refused;
}

}  // namespace

News take_message(ServiceState& state, std::string_view message) {
    state.error.clear();
    if (message.size() > longest_message) return refuse(state, "a message of more than 1 MB");
    if (too_deep(message)) return refuse(state, "a message too deep in itself");
    const Json json = Json::parse(message.begin(), message.end(), nullptr, false);
    if (json.is_discarded() || !json.is_object()) return refuse(state, "a message that is no JSON");
    const Json* device = nullptr;
    bool lists_devices = false;
    if (state.device_id.empty()) state.attached.clear();
    for (const auto& [key, list] : json.items()) {
        if (!is_list_of_devices(key)) continue;
        if (!list.is_array()) return refuse(state, key + " that is no list");
        if (state.device_id.empty()) {
            device = choose(state, key, list);
        } else if (key == state.list) {
            device = find_ours(state, list);
        } else {
            continue;
        }
        lists_devices = true;
        if (device) break;
    }
    const Json* told = member(device, "state");
    if (const Json* given = member(told, "cursor_position")) {
        const auto position = position_from(*given, state.position);
        if (!position) return refuse(state, "an invalid cursor_position");
        state.position = position;
    }
    if (const Json* given = member(told, "current_cursor_force")) {
        state.rendered = position_from(*given, state.rendered);
    }
    take_transform(state.mapping.transform, member(told, "transform"));
    state.error = complaint_in(&json);
    take_grip(state.grip, json);
    if (!lists_devices) return News::none;
    if (!device) return News::gone;
    if (state.error.empty()) state.error = complaint_in(member(device, "status"));
    take_config(state, member(device, "config"));
    take_status(state, member(device, "status"));
    return News::state;
}

DeviceStatus status_of(const ServiceState& state) {
    if (!state.position) return DeviceStatus::starting;
    if (state.calibrated && !*state.calibrated) return DeviceStatus::uncalibrated;
    const bool ready =
        state.calibrated && state.ready.value_or(false) && state.started.value_or(false);
    return ready ? DeviceStatus::ready : DeviceStatus::starting;
}

std::string problem_of(const ServiceState& state) {
    if (!state.error.empty()) return "the service says: " + state.error;
    if (!state.position) return "no position of " + state.model + " yet";
    if (state.calibrated && !*state.calibrated) {
        return state.model +
               " is not calibrated: calibrate it (Haply Hub shows how); if it is, "
               "calibrated=assume";
    }
    if (status_of(state) != DeviceStatus::ready) {
        return state.model + " is not ready: look at its light, or at Haply Hub";
    }
    if (!state.powered.value_or(true)) {
        return state.model + " has no power for forces: plug its supply in";
    }
    const std::string& basis = state.mapping.basis;
    if (!basis.empty() && basis != "XYZ") {
        return "the service's basis is " + basis + ", not XYZ: see the option axes";
    }
    return {};
}

std::string_view Mapping::difference(const Mapping& other) const {
    constexpr double rounding = 1e-6;
    const auto same = [&](const Transform& a, const Transform& b) {
        return std::ranges::equal(
            a, b, [&](double x, double y) { return x == y || std::abs(x - y) <= rounding; });
    };
    if (preset != other.preset) return "preset";
    if (basis != other.basis) return "basis";
    if (handedness != other.handedness) return "handedness";
    if (!same(mount, other.mount)) return "mount";
    return same(transform, other.transform) ? "" : "transform";
}

ForceCommand::ForceCommand(std::string_view device_id, ForceKey key, const Extras& extras) {
    if (!is_device_id(device_id)) throw std::invalid_argument("haply: no device_id");
    const bool pins = !extras.preset.empty();
    if (!is_device_id(extras.list) || (pins && !is_device_id(extras.preset))) {
        throw std::invalid_argument("haply: no name");
    }
    char* end = text_.data();
    const auto append = [&](std::string_view text) { end = std::ranges::copy(text, end).out; };
    append("{");
    if (pins) append(R"("session":{"configure":{"profile":{"name":"palpate"}},)");
    if (!pins && extras.wants_all) append(R"("session":{)");
    if (pins || extras.wants_all) append(R"("force_render_full_state":{}},)");
    append("\"");
    append(extras.list);
    append(R"(":[{"device_id":")");
    append(device_id);
    append(R"(",)");
    if (pins) {
        append(R"("configure":{"preset":{"preset":")");
        append(extras.preset);
        append(R"("},"basis":{"permutation":"XYZ"}},)");
    }
    append(R"("commands":{"set_cursor_force":{")");
    append(key == ForceKey::values ? "values" : "vector");
    append("\":{");
    head_ = static_cast<std::size_t>(end - text_.data());
}

std::string_view ForceCommand::with(const Vec3& force) noexcept {
    constexpr std::array<std::string_view, 3> names{R"("x":)", R"(,"y":)", R"(,"z":)"};
    char* end = text_.data() + head_;
    for (int i = 0; i < 3; ++i) {
        end = std::ranges::copy(names[static_cast<std::size_t>(i)], end).out;
        const double value = force.allFinite() ? force[i] : 0;
        end = std::to_chars(end, text_.data() + text_.size(), value).ptr;
    }
    end = std::ranges::copy(std::string_view("}}}}]}"), end).out;
    return {text_.data(), static_cast<std::size_t>(end - text_.data())};
}

std::string_view snapshot_command() {
    return R"({"session":{"force_render_full_state":{}}})";
}

bool is_device_id(std::string_view text) {
    const auto plain = [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
               c == '-' || c == '_' || c == '.' || c == ':';
    };
    return !text.empty() && text.size() <= 64 && std::ranges::all_of(text, plain);
}

Mat3 axes_from(std::string_view text) {
    Mat3 axes = Mat3::Zero();
    std::string_view rest = text;
    for (int i = 0; i < 3; ++i) {
        const bool minus = rest.starts_with('-');
        if (minus) rest.remove_prefix(1);
        const char axis = rest.empty() ? '?' : rest.front();
        if (axis >= 'x' && axis <= 'z') axes(i, axis - 'x') = minus ? -1 : 1;
        rest.remove_prefix(rest.empty() ? 0 : 1);
    }
    if (!rest.empty() || axes.determinant() != 1) {
        throw std::invalid_argument("device haply: axes=" + std::string(text) +
                                    ": must be the service's axes that point right, up and towards "
                                    "you, such as xz-y; not mirrored");
    }
    return axes;
}

}  // namespace palpate::devices::haply
