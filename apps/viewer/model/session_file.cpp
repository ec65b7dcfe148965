// Reads and writes session files: one list of members a struct, for a writer and a reader.
#include "apps/viewer/model/session_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "io/json_members.hpp"
#include "io/json_text.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/output.hpp"

namespace palpate {

template <>
inline constexpr auto names_of<viewer::Cut> = enum_names("cut", "nothing", "plane", "box");
template <>
inline constexpr auto names_of<viewer::Measure> = enum_names("measure", "length", "angle");

}  // namespace palpate

namespace palpate::pictures {

static io::Json to_value(const Colour& c) {
    return io::to_value(Vec3(c.red, c.green, c.blue));
}

static void from_value(const io::Json& json, const std::string& name, Colour& colour) {
    Vec3 v;
    io::from_value(json, name, v);
    if (!(v.array() >= 0 && v.array() <= 1).all()) io::wrong_member(name, "from 0 to 1");
    colour = {v[0], v[1], v[2]};
}

static void members(auto& v, io::Is<Camera> auto& s) {
    v("focus", s.focus);
    v.must(s.focus.allFinite(), "focus", "finite");
    v("towards_viewer", s.towards_viewer);
    v("up", s.up);
    const Vec3 side = s.towards_viewer.normalized().cross(s.up.normalized());
    v.must(side.norm() > 1e-6, "up", "aslant to 'towards_viewer'");
    v("half_height", s.half_height);
    v.must(s.half_height > 0 && std::isfinite(s.half_height), "half_height", "above 0");
}

}  // namespace palpate::pictures

namespace palpate::run {

static io::Json to_value(const ButtonSetup& button) {
    return text_of(button);
}

static void from_value(const io::Json& json, const std::string& name, ButtonSetup& button) {
    std::string text;
    io::from_value(json, name, text);
    button = button_from("'" + name + "'", text);
}

}  // namespace palpate::run

namespace palpate::viewer {

using io::Is;

// The lists of members with their rules. Not in an unnamed namespace, where io::JsonWriter would
// not find them.

static void part(auto& v, const char* name, auto& value) {
    v(name, value);
    v.must(value >= 0 && value <= 1, name, "from 0 to 1");
}

static bool is_finite(double value) {
    return std::isfinite(value);
}
static bool is_finite(const Vec3& value) {
    return value.allFinite();
}
template <class T>
static bool is_finite(const std::optional<T>& value) {
    return !value || is_finite(*value);
}

static void finite(auto& v, const char* name, auto& value) {
    v(name, value);
    v.must(is_finite(value), name, "finite");
}

static void colour_map(auto& v, const char* name, auto& value) {
    v(name, value);
    v.must(std::ranges::count(colour_map_names(), value) > 0, name,
           "one of the colour maps, such as grey");
}

static void members(auto& v, Is<ControlPoint> auto& s) {
    finite(v, "level", s.level);
    v("colour", s.colour);
    part(v, "opacity", s.opacity);
}

static void members(auto& v, Is<TransferFunction> auto& s) {
    v("preset", s.preset);
    v("points", s.points);
    v.must(s.points.size() != 1, "points", "two points or more, or none");
    for (std::size_t i = 1; i < s.points.size(); ++i) {
        v.must(s.points[i - 1].level < s.points[i].level, "points[" + std::to_string(i) + "].level",
               "above that of the point before");
    }
}

static void members(auto& v, Is<SeenSurface> auto& s) {
    finite(v, "level", s.level);
    v("colour", s.colour);
    part(v, "opacity", s.opacity);
    v("shown", s.shown);
}

static void members(auto& v, Is<CutPlane> auto& s) {
    finite(v, "point", s.point);
    finite(v, "normal", s.normal);
    v.must(s.normal.norm() > 0, "normal", "finite and not zero");
}

static void members(auto& v, Is<CutBox> auto& s) {
    v("low", s.low);
    v("high", s.high);
    const auto low = s.low.array(), high = s.high.array();
    v.must((low >= 0 && low < high && high <= 1).all(), "", "0 <= low < high <= 1 along each axis");
}

static void members(auto& v, Is<OverlayLook> auto& s) {
    v("shown", s.shown);
    part(v, "opacity", s.opacity);
    colour_map(v, "colours", s.colours);
    v("surface", s.surface);
    part(v, "surface_opacity", s.surface_opacity);
    finite(v, "level", s.level);
    v("hidden", s.hidden);
}

static void members(auto& v, Is<Look> auto& s) {
    v("surface", s.surface);
    v("surface_colour", s.surface_colour);
    part(v, "surface_opacity", s.surface_opacity);
    v("surfaces", s.surfaces);
    v.must(s.surfaces.size() <= most_surfaces, "surfaces",
           "not more than " + std::to_string(most_surfaces));
    v("cut", s.cut);
    v("cut_plane", s.cut_plane);
    v("cut_box", s.cut_box);
    colour_map(v, "colours", s.colours);
    v("overlay", s.overlay);
    v("volume", s.volume);
    v("transfer", s.transfer);
    v("shading", s.shading);
    v("maximum", s.maximum);
    v("slices", s.slices);
    v("contact", s.contact);
    v("tetrahedra", s.tetrahedra);
    v("planes", s.planes);
    v("box", s.box);
    v("orientation", s.orientation);
    v("scale_bar", s.scale_bar);
}

static void members(auto& v, Is<Measurement> auto& s) {
    v("kind", s.kind);
    v("points", s.points);
    const bool whole = s.points.size() == points_of(s.kind);
    v.must(whole && std::ranges::all_of(s.points, [](const Vec3& p) { return is_finite(p); }),
           "points", std::to_string(points_of(s.kind)) + " finite points");
}

/// The plain members after `method`.
static void members(auto& v, Is<SessionFile> auto& s) {
    constexpr std::size_t most_measurements = 1000;
    members(v, s.buttons);
    v("look", s.look);
    v("camera", s.camera);
    finite(v, "crosshair", s.crosshair);
    v("follow", s.follow);
    finite(v, "window_low", s.window_low);
    finite(v, "window_high", s.window_high);
    v.must(s.window_low <= s.window_high, "window_low", "not above 'window_high'");
    v("slices_shown", s.slices_shown);
    v("measurements", s.measurements);
    v.must(s.measurements.size() <= most_measurements, "measurements", "not more than 1000");
}

namespace {

using io::Json;

constexpr const char* format_name = "palpate-session";
constexpr int version = 1;
constexpr std::uintmax_t largest_file = std::uintmax_t{16} << 20;  // [bytes] far more than any
constexpr std::string_view synthetic_prefix = "synthetic:";

[[noreturn]] void wrong(const std::string& name, const std::string& what) {
    throw std::invalid_argument("'" + name + "' " + what);
}

/// Throws std::invalid_argument naming the member.
void check_hand(const SessionHand& hand, const SessionFile& session) {
    RendererSettings settings = hand.settings.value_or(RendererSettings{});
    settings.method = session.method.method;
    check(settings.penetrability, session.solid);
    if (settings.layers) check(*settings.layers, session.solid);
    if (settings.layers && settings.layers->by_label) {
        if (settings.layers->label_volume.empty()) {
            wrong("settings.layers.label_volume", "is missing");
        }
        settings.layers.reset();  // their places are read later
    }
    check(settings);
}

/// A name from the file, relative to the session's folder.
std::string name_in(const std::string& volume, const std::filesystem::path& folder) {
    if (volume.starts_with(synthetic_prefix) || io::is_web_address(volume)) return volume;
    return (folder / volume).lexically_normal().string();
}

run::Source source_from(const Json& json, const std::string& member,
                        const std::filesystem::path& folder) {
    if (!json.is_object()) wrong(member, "must be an object");
    std::map<std::string, std::string> names;
    for (const auto& [name, value] : json.items()) {
        io::JsonReader::get(value, member + "." + name, names[name]);
    }
    std::string& volume = names["volume"];
    if (volume.empty()) wrong(member + ".volume", "is missing");
    volume = name_in(volume, folder);
    return run::source_from(names);
}

/// The name for the file: relative where the volume lies below the folder.
std::string name_from(const std::string& volume, const std::filesystem::path& folder) {
    if (volume.starts_with(synthetic_prefix) || io::is_web_address(volume)) return volume;
    const auto whole = std::filesystem::absolute(volume).lexically_normal();
    const auto below = whole.lexically_relative(folder.lexically_normal());
    const bool outside = below.empty() || *below.begin() == "..";
    return (outside ? whole : below).string();
}

/// The same settings with another name of the label volume, if they have one.
RendererSettings with_label_volume(RendererSettings settings,
                                   const std::function<std::string(const std::string&)>& name) {
    if (!settings.layers || settings.layers->label_volume.empty()) return settings;
    Layers named = *settings.layers;
    named.label_volume = name(named.label_volume);
    settings.layers = std::make_shared<const Layers>(std::move(named));
    return settings;
}

const Json& needed(const Json& json, const char* name) {
    const auto found = json.find(name);
    if (found == json.end()) wrong(name, "is missing");
    return *found;
}

void write_hand(io::JsonWriter& writer, const SessionHand& hand,
                const std::filesystem::path& folder) {
    writer.json["isovalue"] = hand.isovalue;
    if (hand.settings) {
        writer.json["settings"] = io::to_json(with_label_volume(
            *hand.settings, [&](const std::string& volume) { return name_from(volume, folder); }));
    }
    writer("device", run::text_of(hand.device));
}

void check_head(const Json& json) {
    if (!json.is_object() || json.value("format", Json()) != format_name) {
        throw std::invalid_argument(
            "is no session: save one in the viewer, or open this as a volume");
    }
    const Json& number = needed(json, "version");
    if (!number.is_number_integer() || number.get<std::int64_t>() < 1) {
        wrong("version", "must be a whole number from 1");
    }
    if (number.get<std::int64_t>() > version) {
        throw std::invalid_argument("is a session of version " +
                                    std::to_string(number.get<std::int64_t>()) +
                                    ", made by a later Palpate: use that");
    }
}

SessionHand hand_from(const Json& json, const std::filesystem::path& folder) {
    SessionHand hand;
    io::JsonReader reader{json};
    (void)needed(json, "isovalue");
    finite(reader, "isovalue", hand.isovalue);
    if (const Json* const settings = reader.find("settings")) {
        if (!settings->is_object()) wrong("settings", "must be an object");
        RendererSettings read;
        io::from_json(*settings, read);
        hand.settings = with_label_volume(
            read, [&](const std::string& volume) { return name_in(volume, folder); });
    }
    std::string device = run::text_of(hand.device);
    reader("device", device);
    if (device.empty() || device.starts_with(':')) wrong("device", "must have a name");
    hand.device = devices::parse_device(device);
    return hand;
}

/// The hands in addition to the first one.
std::vector<SessionHand> others_from(const Json& json, const std::filesystem::path& folder) {
    std::vector<SessionHand> others;
    const auto hands = json.find("hands");
    if (hands == json.end()) return others;
    if (!hands->is_array()) wrong("hands", "must be a list");
    for (const Json& hand : *hands) {
        if (!hand.is_object()) wrong("hands", "must be a list of objects");
        others.push_back(hand_from(hand, folder));
    }
    return others;
}

SessionFile from_json(const Json& json, const std::filesystem::path& folder) {
    check_head(json);
    SessionFile session;
    session.source = source_from(needed(json, "volume"), "volume", folder);
    if (const auto overlay = json.find("overlay"); overlay != json.end()) {
        session.overlay = source_from(*overlay, "overlay", folder);
    }
    static_cast<SessionHand&>(session) = hand_from(json, folder);
    session.others = others_from(json, folder);
    io::JsonReader reader{json};
    reader("solid", session.solid);
    finite(reader, "background", session.background);
    std::string method = session.method.name;
    reader("method", method);
    session.method = run::named_method(method);
    // Other methods than the exact one feel the linear field only.
    if (session.method.method != &update_exact) session.interpolation = Interpolation::linear;
    reader("field", session.interpolation);
    members(reader, session);
    reader.must(session.others.size() < most_hands, "hands", "not more than the window has");
    check_hand(session, session);
    for (const SessionHand& hand : session.others) check_hand(hand, session);
    if (session.settings) session.settings->method = session.method.method;
    for (SessionHand& hand : session.others) {
        if (hand.settings) hand.settings->method = session.method.method;
    }
    return session;
}

}  // namespace

SessionFile read_session(const std::filesystem::path& path) {
    return session_from(session_text(path), path);
}

std::string session_text(const std::filesystem::path& path, const OnProgress& progress) {
    std::error_code ignored;
    const std::uintmax_t bytes = std::filesystem::file_size(path, ignored);
    if (!ignored && bytes > largest_file) {
        throw io::InputError(path.string() + ": is no session: it is too large for one");
    }
    return io::read_text(path, progress);
}

SessionFile session_from(const std::string& text, const std::filesystem::path& path) {
    const auto fail = [&](const std::string& problem) {
        return io::InputError(path.string() + ": " + problem);
    };
    try {
        return from_json(io::parsed_json(text), path.parent_path());
    } catch (const Json::exception&) {
        throw fail("is no session: it is not valid JSON, or was cut off");
    } catch (const std::invalid_argument& e) {
        throw fail(e.what());
    }
}

void write_session(const std::filesystem::path& path, const SessionFile& session) {
    const auto folder = std::filesystem::absolute(path).parent_path();
    const auto names = [&](const run::Source& source) {
        if (name_of(source).empty()) wrong("volume", "must have a name");
        auto names = run::to_names(source);
        names["volume"] = name_from(names["volume"], folder);
        return names;
    };
    io::JsonWriter writer;
    writer.json["format"] = format_name;
    writer.json["version"] = version;
    writer.json["volume"] = names(session.source);
    if (session.overlay) writer.json["overlay"] = names(*session.overlay);
    writer("solid", session.solid);
    writer("field", session.interpolation);
    write_hand(writer, session, folder);
    for (const SessionHand& hand : session.others) {
        io::JsonWriter other;
        write_hand(other, hand, folder);
        writer.json["hands"].push_back(other.json);
    }
    writer("background", session.background);
    writer("method", std::string(session.method.name));
    members(writer, session);
    (void)from_json(writer.json, folder);  // what cannot be read is not written
    std::string text;
    try {
        text = writer.json.dump(1) + "\n";
    } catch (const Json::exception&) {
        throw io::OutputError(path.string() +
                              ": a name in the session is not UTF-8 text, which is what session "
                              "files hold: rename the volume");
    }
    io::write_file(path, text);
}

}  // namespace palpate::viewer
