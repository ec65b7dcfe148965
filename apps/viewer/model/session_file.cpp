// Reads and writes session files: one list of members a struct, for a writer and a reader.
#include "apps/viewer/model/session_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "io/json_members.hpp"
#include "io/json_text.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/output.hpp"

namespace palpate::pictures {

static io::Json to_value(const Colour& c) {
    return io::to_value(Vec3(c.red, c.green, c.blue));
}

static void from_value(const io::Json& json, const std::string& name, Colour& colour) {
    Vec3 v;
    io::from_value(json, name, v);
    colour = {v[0], v[1], v[2]};
}

static void members(auto& v, io::Is<Camera> auto& s) {
    v("focus", s.focus);
    v("towards_viewer", s.towards_viewer);
    v("up", s.up);
    v("half_height", s.half_height);
}

}  // namespace palpate::pictures

namespace palpate::viewer {

using io::Is;

// The lists of members, and the names of an enum's values in their order. Not in an unnamed
// namespace, where io::JsonWriter would not find them.

static constexpr std::array<const char*, 3> value_names(Cut) {
    return {"nothing", "plane", "box"};
}

static constexpr std::array<const char*, 2> value_names(Measure) {
    return {"length", "angle"};
}

template <class T>
concept Named = requires(T value) {
    value_names(value);
};

static io::Json to_value(Named auto value) {
    return value_names(value)[static_cast<std::size_t>(value)];
}

template <Named T>
static void from_value(const io::Json& json, const std::string& name, T& value) {
    std::string text;
    io::from_value(json, name, text);
    const auto names = value_names(value);
    const auto at = std::ranges::find(names, text);
    if (at == names.end()) {
        std::string wanted = names.front();
        for (std::size_t i = 1; i < names.size(); ++i) {
            wanted.append(i + 1 < names.size() ? ", " : " or ").append(names[i]);
        }
        io::wrong_member(name, wanted);
    }
    value = static_cast<T>(at - names.begin());
}

static void members(auto& v, Is<ControlPoint> auto& s) {
    v("level", s.level);
    v("colour", s.colour);
    v("opacity", s.opacity);
}

static void members(auto& v, Is<TransferFunction> auto& s) {
    v("preset", s.preset);
    v("points", s.points);
}

static void members(auto& v, Is<SeenSurface> auto& s) {
    v("level", s.level);
    v("colour", s.colour);
    v("opacity", s.opacity);
    v("shown", s.shown);
}

static void members(auto& v, Is<CutPlane> auto& s) {
    v("point", s.point);
    v("normal", s.normal);
}

static void members(auto& v, Is<CutBox> auto& s) {
    v("low", s.low);
    v("high", s.high);
}

static void members(auto& v, Is<OverlayLook> auto& s) {
    v("shown", s.shown);
    v("opacity", s.opacity);
    v("colours", s.colours);
    v("surface", s.surface);
    v("surface_opacity", s.surface_opacity);
    v("level", s.level);
    v("hidden", s.hidden);
}

static void members(auto& v, Is<Look> auto& s) {
    v("surface", s.surface);
    v("surface_colour", s.surface_colour);
    v("surface_opacity", s.surface_opacity);
    v("surfaces", s.surfaces);
    v("cut", s.cut);
    v("cut_plane", s.cut_plane);
    v("cut_box", s.cut_box);
    v("colours", s.colours);
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
}

/// The plain members after `device` and `method`.
static void members(auto& v, Is<SessionFile> auto& s) {
    v("look", s.look);
    v("camera", s.camera);
    v("crosshair", s.crosshair);
    v("follow", s.follow);
    v("window_low", s.window_low);
    v("window_high", s.window_high);
    v("slices_shown", s.slices_shown);
    v("measurements", s.measurements);
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

void check_part(const std::string& name, double value) {
    if (!(value >= 0 && value <= 1)) wrong(name, "must be from 0 to 1");
}

void check_colour(const std::string& name, const Colour& c) {
    for (const double value : {c.red, c.green, c.blue}) check_part(name, value);
}

void check_finite(const std::string& name, double value) {
    if (!std::isfinite(value)) wrong(name, "must be a finite number");
}

void check_colours(const std::string& name, const std::string& colours) {
    const auto known = colour_map_names();
    if (std::ranges::count(known, colours) == 0) {
        wrong(name, "must be one of the colour maps, such as grey");
    }
}

void check_overlay(const OverlayLook& look) {
    check_part("look.overlay.opacity", look.opacity);
    check_part("look.overlay.surface_opacity", look.surface_opacity);
    check_colours("look.overlay.colours", look.colours);
    if (look.level) check_finite("look.overlay.level", *look.level);
}

void check_cut(const Look& look) {
    if (!look.cut_plane.point.allFinite()) wrong("look.cut_plane.point", "must be finite");
    if (!look.cut_plane.normal.allFinite() || !(look.cut_plane.normal.norm() > 0)) {
        wrong("look.cut_plane.normal", "must be finite and not zero");
    }
    const auto& [low, high] = look.cut_box;
    if (!(low.array() >= 0 && low.array() < high.array() && high.array() <= 1).all()) {
        wrong("look.cut_box", "must have 0 <= low < high <= 1 along each axis");
    }
}

void check_look(const Look& look) {
    check_colour("look.surface_colour", look.surface_colour);
    check_part("look.surface_opacity", look.surface_opacity);
    if (look.surfaces.size() > most_surfaces) {
        wrong("look.surfaces", "must not be more than " + std::to_string(most_surfaces));
    }
    for (std::size_t i = 0; i < look.surfaces.size(); ++i) {
        const std::string name = "look.surfaces[" + std::to_string(i) + "].";
        check_finite(name + "level", look.surfaces[i].level);
        check_colour(name + "colour", look.surfaces[i].colour);
        check_part(name + "opacity", look.surfaces[i].opacity);
    }
    check_cut(look);
    check_overlay(look.overlay);
    check_colours("look.colours", look.colours);
    const auto& points = look.transfer.points;
    const std::string list = "look.transfer.points";
    if (points.size() == 1) wrong(list, "must be two points or more, or none");
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string name = list + "[" + std::to_string(i) + "].";
        check_finite(name + "level", points[i].level);
        check_colour(name + "colour", points[i].colour);
        check_part(name + "opacity", points[i].opacity);
        if (i > 0 && !(points[i - 1].level < points[i].level)) {
            wrong(name + "level", "must be above that of the point before");
        }
    }
}

void check_camera(const pictures::Camera& camera) {
    if (!camera.focus.allFinite()) wrong("camera.focus", "must be finite");
    if (!(camera.half_height > 0) || !std::isfinite(camera.half_height)) {
        wrong("camera.half_height", "must be above 0");
    }
    const Vec3 side = camera.towards_viewer.normalized().cross(camera.up.normalized());
    if (!(side.norm() > 1e-6)) wrong("camera.up", "must not be along 'camera.towards_viewer'");
}

void check_measurements(const std::vector<Measurement>& measurements) {
    constexpr std::size_t most = 1000;
    if (measurements.size() > most) wrong("measurements", "must not be more than 1000");
    for (std::size_t i = 0; i < measurements.size(); ++i) {
        const auto& [kind, points] = measurements[i];
        const std::string name = "measurements[" + std::to_string(i) + "].points";
        const bool finite =
            std::ranges::all_of(points, [](const Vec3& p) { return p.allFinite(); });
        if (points.size() != points_of(kind) || !finite) {
            wrong(name, "must be " + std::to_string(points_of(kind)) + " finite points");
        }
    }
}

/// `name` is that of its members.
void check_hand(const std::string& name, const SessionHand& hand, const SessionFile& s) {
    check_finite(name + "isovalue", hand.isovalue);
    if (hand.device.name.empty()) wrong(name + "device", "must have a name");
    RendererSettings settings = hand.settings.value_or(RendererSettings{});
    settings.method = s.method.method;
    check(settings.penetrability, s.solid);
    if (settings.layers) check(*settings.layers, s.solid);
    if (settings.layers && settings.layers->by_label) {
        if (settings.layers->label_volume.empty()) {
            wrong(name + "settings.layers.label_volume", "is missing");
        }
        settings.layers.reset();  // their places are read later
    }
    check(settings);
}

/// Throws std::invalid_argument naming the member.
void check_session(const SessionFile& s) {
    if (name_of(s.source).empty()) wrong("volume", "must have a name");
    if (s.overlay && name_of(*s.overlay).empty()) wrong("overlay", "must have a name");
    if (s.background) check_finite("background", *s.background);
    check_hand("", s, s);
    if (s.others.size() >= most_hands) wrong("hands", "must not be more than the window has");
    for (const SessionHand& hand : s.others) check_hand("hands.", hand, s);
    check_look(s.look);
    if (s.camera) check_camera(*s.camera);
    check_measurements(s.measurements);
    if (s.crosshair && !s.crosshair->allFinite()) wrong("crosshair", "must be finite");
    check_finite("window_low", s.window_low);
    check_finite("window_high", s.window_high);
    if (!(s.window_low <= s.window_high)) wrong("window_low", "must not be above 'window_high'");
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
    const auto below =
        whole.lexically_relative(std::filesystem::absolute(folder).lexically_normal());
    const bool outside = below.empty() || *below.begin() == "..";
    return (outside ? whole : below).string();
}

/// The same settings with another name of the label volume, where there is one.
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
    io::JsonReader::get(needed(json, "isovalue"), "isovalue", hand.isovalue);
    io::JsonReader reader{json};
    if (const Json* const settings = reader.find("settings")) {
        if (!settings->is_object()) wrong("settings", "must be an object");
        RendererSettings read;
        io::from_json(*settings, read);
        hand.settings = with_label_volume(
            read, [&](const std::string& volume) { return name_in(volume, folder); });
    }
    std::string device = run::text_of(hand.device);
    reader("device", device);
    if (device.empty()) wrong("device", "must have a name");
    hand.device = devices::parse_device(device);
    return hand;
}

/// Those beside the first.
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

SessionFile session_from(const Json& json, const std::filesystem::path& folder) {
    check_head(json);
    SessionFile session;
    session.source = source_from(needed(json, "volume"), "volume", folder);
    if (const auto overlay = json.find("overlay"); overlay != json.end()) {
        session.overlay = source_from(*overlay, "overlay", folder);
    }
    static_cast<SessionHand&>(session) = hand_from(json, folder);
    session.others = others_from(json, folder);
    io::JsonReader reader{json};
    std::string solid = "above";
    reader("solid", solid);
    if (solid != "above" && solid != "below") wrong("solid", "must be above or below");
    session.solid = solid == "above" ? Solid::above : Solid::below;
    reader("background", session.background);
    std::string method = session.method.name;
    reader("method", method);
    session.method = run::named_method(method);
    // Other methods than the exact one feel the linear field only.
    std::string field = session.method.method == &update_exact ? "cubic" : "linear";
    reader("field", field);
    if (field != "linear" && field != "cubic") wrong("field", "must be linear or cubic");
    session.interpolation = interpolation_from(field);
    members(reader, session);
    check_session(session);
    if (session.settings) session.settings->method = session.method.method;
    for (SessionHand& hand : session.others) {
        if (hand.settings) hand.settings->method = session.method.method;
    }
    return session;
}

}  // namespace

SessionFile read_session(const std::filesystem::path& path) {
    const auto fail = [&](const std::string& problem) {
        return io::InputError(path.string() + ": " + problem);
    };
    std::error_code ignored;
    const std::uintmax_t bytes = std::filesystem::file_size(path, ignored);
    if (!ignored && bytes > largest_file) throw fail("is no session: it is too large for one");
    const std::string text = io::read_text(path);
    try {
        return session_from(io::parsed_json(text), path.parent_path());
    } catch (const Json::exception&) {
        throw fail("is no session: it is not valid JSON, or was cut off");
    } catch (const std::invalid_argument& e) {
        throw fail(e.what());
    }
}

void write_session(const std::filesystem::path& path, const SessionFile& session) {
    check_session(session);
    const auto names_of = [&](const run::Source& source) {
        auto names = run::to_names(source);
        names["volume"] = name_from(names["volume"], path.parent_path());
        return names;
    };
    io::JsonWriter writer;
    writer.json["format"] = format_name;
    writer.json["version"] = version;
    writer.json["volume"] = names_of(session.source);
    if (session.overlay) writer.json["overlay"] = names_of(*session.overlay);
    writer.json["solid"] = session.solid == Solid::above ? "above" : "below";
    writer.json["field"] = name_of(session.interpolation);
    write_hand(writer, session, path.parent_path());
    for (const SessionHand& hand : session.others) {
        io::JsonWriter other;
        write_hand(other, hand, path.parent_path());
        writer.json["hands"].push_back(other.json);
    }
    writer("background", session.background);
    writer("method", std::string(session.method.name));
    members(writer, session);
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
