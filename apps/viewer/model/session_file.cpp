// Sessions as JSON: one list of members a struct, walked through by a writer and a reader.
#include "apps/viewer/model/session_file.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <concepts>
#include <stdexcept>
#include <utility>

#include "io/settings_json.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/output.hpp"

namespace palpate::viewer {
namespace {

using io::Json;

constexpr const char* format_name = "palpate-session";
constexpr int version = 1;
constexpr std::uintmax_t largest_file = std::uintmax_t{16} << 20;  // [bytes] far more than any
constexpr std::string_view synthetic_prefix = "synthetic:";

[[noreturn]] void wrong(const std::string& name, const std::string& what) {
    throw std::invalid_argument("'" + name + "' " + what);
}

Json json_from(double value) {
    return value;
}
Json json_from(const Vec3& v) {
    return {v[0], v[1], v[2]};
}
Json json_from(const Colour& c) {
    return {c.red, c.green, c.blue};
}

/// Three numbers of an array, whatever they mean.
Vec3 three_from(const Json& json, const std::string& name) {
    if (!json.is_array() || json.size() != 3) wrong(name, "must be three numbers");
    Vec3 v;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!json[i].is_number()) wrong(name, "must be three numbers");
        v[static_cast<int>(i)] = json[i].get<double>();
    }
    return v;
}

struct Writer {
    Json json = Json::object();

    template <class T>
    void operator()(const char* name, const T& value) {
        if constexpr (requires { members(*this, value); }) {
            Writer part;
            members(part, value);
            json[name] = std::move(part.json);
        } else if constexpr (std::same_as<T, bool> || std::same_as<T, std::string>) {
            json[name] = value;
        } else {
            json[name] = json_from(value);
        }
    }
    template <class T>
    void operator()(const char* name, const std::optional<T>& value) {
        if (value) (*this)(name, *value);
    }
    void operator()(const char* name, const std::vector<ControlPoint>& points);
};

/// Members that are missing leave what is there.
struct Reader {
    const Json& json;
    std::string where;  ///< "" or "look."

    const Json* find(const char* name) const {
        const auto found = json.find(name);
        return found == json.end() ? nullptr : &*found;
    }
    static Reader of(const Json& json, const std::string& name) {
        if (!json.is_object()) wrong(name, "must be an object");
        return {json, name + "."};
    }
    template <class T>
    void operator()(const char* name, T& value) {
        const Json* const j = find(name);
        if (!j) return;
        if constexpr (requires { members(*this, value); }) {
            Reader part = of(*j, where + name);
            members(part, value);
        } else {
            get(*j, where + name, value);
        }
    }
    template <class T>
    void operator()(const char* name, std::optional<T>& value) {
        if (find(name)) (*this)(name, value.emplace());
    }
    static void get(const Json& j, const std::string& name, bool& value) {
        if (!j.is_boolean()) wrong(name, "must be true or false");
        value = j.get<bool>();
    }
    static void get(const Json& j, const std::string& name, double& value) {
        if (!j.is_number()) wrong(name, "must be a number");
        value = j.get<double>();
    }
    static void get(const Json& j, const std::string& name, std::string& value) {
        if (!j.is_string()) wrong(name, "must be text");
        value = j.get<std::string>();
    }
    static void get(const Json& j, const std::string& name, Vec3& value) {
        value = three_from(j, name);
    }
    static void get(const Json& j, const std::string& name, Colour& value) {
        const Vec3 c = three_from(j, name);
        value = {c[0], c[1], c[2]};
    }
    static void get(const Json& j, const std::string& name, std::vector<ControlPoint>& points);
};

/// S is T, const or not.
template <class S, class T>
concept Is = std::same_as<std::remove_const_t<S>, T>;

void members(auto& v, Is<ControlPoint> auto& s) {
    v("level", s.level);
    v("colour", s.colour);
    v("opacity", s.opacity);
}

void members(auto& v, Is<TransferFunction> auto& s) {
    v("preset", s.preset);
    v("points", s.points);
}

void members(auto& v, Is<Look> auto& s) {
    v("surface", s.surface);
    v("surface_colour", s.surface_colour);
    v("surface_opacity", s.surface_opacity);
    v("volume", s.volume);
    v("transfer", s.transfer);
    v("shading", s.shading);
    v("slices", s.slices);
    v("contact", s.contact);
    v("tetrahedra", s.tetrahedra);
    v("planes", s.planes);
    v("box", s.box);
    v("orientation", s.orientation);
    v("scale_bar", s.scale_bar);
}

void members(auto& v, Is<pictures::Camera> auto& s) {
    v("focus", s.focus);
    v("towards_viewer", s.towards_viewer);
    v("up", s.up);
    v("half_height", s.half_height);
}

/// All but volume, solid side, isovalue and settings, which are not plain members.
void members(auto& v, Is<SessionFile> auto& s) {
    v("background", s.background);
    v("device", s.device);
    v("method", s.method);
    v("look", s.look);
    v("camera", s.camera);
    v("crosshair", s.crosshair);
    v("follow", s.follow);
    v("window_low", s.window_low);
    v("window_high", s.window_high);
    v("slices_shown", s.slices_shown);
}

void Writer::operator()(const char* name, const std::vector<ControlPoint>& points) {
    Json& list = json[name] = Json::array();
    for (const ControlPoint& point : points) {
        Writer part;
        members(part, point);
        list.push_back(std::move(part.json));
    }
}

void Reader::get(const Json& j, const std::string& name, std::vector<ControlPoint>& points) {
    if (!j.is_array()) wrong(name, "must be a list");
    points.clear();
    for (const Json& point : j) {
        Reader part = of(point, name + "[" + std::to_string(points.size()) + "]");
        members(part, points.emplace_back());
    }
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

void check_look(const Look& look) {
    check_colour("look.surface_colour", look.surface_colour);
    check_part("look.surface_opacity", look.surface_opacity);
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

/// Throws std::invalid_argument naming the member.
void check_session(const SessionFile& s) {
    if (s.volume.volume.empty()) wrong("volume", "must have a name");
    check_finite("isovalue", s.isovalue);
    if (s.background) check_finite("background", *s.background);
    if (s.device.empty()) wrong("device", "must have a name");
    RendererSettings settings = s.settings.value_or(RendererSettings{});
    settings.method = baselines::method_named(s.method);
    check(settings);
    check(settings.penetrability, s.solid);
    check_look(s.look);
    if (s.camera) check_camera(*s.camera);
    if (s.crosshair && !s.crosshair->allFinite()) wrong("crosshair", "must be finite");
    check_finite("window_low", s.window_low);
    check_finite("window_high", s.window_high);
    if (!(s.window_low <= s.window_high)) wrong("window_low", "must not be above 'window_high'");
}

app::VolumeOptions volume_from(const Json& json, const std::filesystem::path& folder) {
    if (!json.is_object()) wrong("volume", "must be an object");
    std::map<std::string, std::string> names;
    for (const auto& [name, value] : json.items()) {
        Reader::get(value, "volume." + name, names[name]);
    }
    app::VolumeOptions options = app::options_from(names);
    if (options.volume.empty()) wrong("volume.volume", "is missing");
    if (!options.volume.starts_with(synthetic_prefix)) {
        options.volume = (folder / options.volume).lexically_normal().string();
    }
    return options;
}

/// As the file names it: relative where it lies below the folder.
std::string name_from(const std::string& volume, const std::filesystem::path& folder) {
    if (volume.starts_with(synthetic_prefix)) return volume;
    const auto whole = std::filesystem::absolute(volume).lexically_normal();
    const auto below =
        whole.lexically_relative(std::filesystem::absolute(folder).lexically_normal());
    const bool outside = below.empty() || *below.begin() == "..";
    return (outside ? whole : below).string();
}

const Json& needed(const Json& json, const char* name) {
    const auto found = json.find(name);
    if (found == json.end()) wrong(name, "is missing");
    return *found;
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

SessionFile session_from(const Json& json, const std::filesystem::path& folder) {
    check_head(json);
    SessionFile session;
    session.volume = volume_from(needed(json, "volume"), folder);
    Reader::get(needed(json, "isovalue"), "isovalue", session.isovalue);
    Reader reader{json, ""};
    std::string solid = "above";
    reader("solid", solid);
    if (solid != "above" && solid != "below") wrong("solid", "must be above or below");
    session.solid = solid == "above" ? Solid::above : Solid::below;
    if (const Json* const settings = reader.find("settings")) {
        if (!settings->is_object()) wrong("settings", "must be an object");
        io::from_json(*settings, session.settings.emplace());
    }
    members(reader, session);
    check_session(session);
    if (session.settings) session.settings->method = baselines::method_named(session.method);
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
        return session_from(Json::parse(text), path.parent_path());
    } catch (const Json::exception&) {
        throw fail("is no session: it is not valid JSON, or was cut off");
    } catch (const std::invalid_argument& e) {
        throw fail(e.what());
    }
}

void write_session(const std::filesystem::path& path, const SessionFile& session) {
    check_session(session);
    app::VolumeOptions volume = session.volume;
    volume.volume = name_from(volume.volume, path.parent_path());
    Writer writer;
    writer.json["format"] = format_name;
    writer.json["version"] = version;
    writer.json["volume"] = app::to_names(volume);
    writer.json["solid"] = session.solid == Solid::above ? "above" : "below";
    writer.json["isovalue"] = session.isovalue;
    if (session.settings) writer.json["settings"] = io::to_json(*session.settings);
    members(writer, session);
    std::string text;
    try {
        text = writer.json.dump(1) + "\n";
    } catch (const Json::exception&) {
        throw io::OutputError(path.string() +
                              ": a name in the session is not UTF-8 text, which is what session "
                              "files hold: rename the volume");
    }
    io::PendingFile file(path);
    file.write(text);
    file.commit();
}

}  // namespace palpate::viewer
