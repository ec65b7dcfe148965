// Volume and session from a recording's head, and its ticks again.
#include "palpate/run/replay.hpp"

#include "palpate/io/address.hpp"
#include "palpate/run/labels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "io/system/number.hpp"
#include "palpate/baselines/methods.hpp"

namespace palpate::run {
namespace {

std::string volume_name(const std::string& recorded, const std::filesystem::path& recording) {
    if (recorded.starts_with("synthetic:") || io::is_web_address(recorded) ||
        std::filesystem::exists(recorded)) {
        return recorded;
    }
    std::string name = recorded;
    while (name.size() > 1 && name.back() == '/') name.pop_back();  // a folder
    const auto beside = recording.parent_path() / std::filesystem::path(name).filename();
    return std::filesystem::exists(beside) ? beside.string() : recorded;
}

bool same(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
           (std::isnan(a) && std::isnan(b));
}
bool same(const Vec3& a, const Vec3& b) {
    return same(a[0], b[0]) && same(a[1], b[1]) && same(a[2], b[2]);
}
bool same(const Quaternion& a, const Quaternion& b) {
    return same(a.w(), b.w()) && same(a.x(), b.x()) && same(a.y(), b.y()) && same(a.z(), b.z());
}
template <class T>
bool same(const T& a, const T& b) {
    return a == b;
}

std::string text_of(double value) {
    std::string text;
    io::append_number(text, value);
    return text;
}
std::string text_of(const Vec3& v) {
    return "(" + text_of(v[0]) + ", " + text_of(v[1]) + ", " + text_of(v[2]) + ")";
}
std::string text_of(const Quaternion& q) {
    return "(" + text_of(q.w()) + ", " + text_of(q.x()) + ", " + text_of(q.y()) + ", " +
           text_of(q.z()) + ")";
}
std::string text_of(bool value) {
    return value ? "true" : "false";
}
template <class T>
std::string text_of(const T& value) {
    return std::to_string(static_cast<std::int64_t>(value));
}

/// Keeps the first pair that differs.
struct Comparison {
    std::optional<Difference> found = {};

    template <class T>
    void operator()(const char* part, const T& recorded, const T& again) {
        if (!found && !same(recorded, again)) found = {part, text_of(recorded), text_of(again)};
    }
};

/// In a session, a set that takes another one's place may share its labels. Read again they are
/// another volume of the same samples; then the set gets those of the one before.
std::shared_ptr<const Layers> like_before(std::shared_ptr<const Layers> layers,
                                          const std::shared_ptr<const Layers>& before) {
    if (!layers || !layers->labels || !before || !before->labels) return layers;
    const Volume &now = layers->labels->volume(), &then = before->labels->volume();
    if (!(now.geometry() == then.geometry()) ||
        !std::ranges::equal(now.samples<std::uint8_t>(), then.samples<std::uint8_t>())) {
        return layers;
    }
    Layers same = *layers;
    same.labels = before->labels;
    return std::make_shared<const Layers>(std::move(same));
}

}  // namespace

Source recorded_source(const io::RecordingHead& head, const std::filesystem::path& recording,
                       const std::string& instead) {
    auto names = head.volume.options;
    std::string& volume = names["volume"];
    if (volume.starts_with("live:") && instead.empty()) {
        throw io::InputError(recording.string() +
                             ": is of a live source: its frames came from outside and are not in "
                             "the recording, so it can be plotted but not rendered again");
    }
    volume = instead.empty() ? volume_name(volume, recording) : instead;
    if (!instead.empty()) names.erase("secrets");
    try {
        return source_from(names);
    } catch (const std::invalid_argument& e) {
        throw io::InputError(recording.string() + ": " + e.what());
    }
}

Session recorded_session(const io::RecordingHead& head, const LoadedVolume& loaded,
                         const std::string& recording, const OnProgress& progress) {
    const io::VolumeIdentity now = io::identify(loaded.volume, {}, progress);
    if (now.size != head.volume.size || now.type != head.volume.type ||
        now.crc32 != head.volume.crc32) {
        throw io::InputError(loaded.name +
                             ": is not the volume of the recording (its size, type "
                             "or samples differ): name the right one");
    }
    try {
        RendererSettings settings = head.settings;
        settings.method = baselines::method_named(head.method);
        settings.layers = with_labels(settings.layers, recording, loaded);
        check(head.session);
        // A servo may be sent what a tool does not feel (docs/tools.md). It is kept for the point.
        const auto tool = std::exchange(settings.tool, nullptr);
        Session session{make_renderer(Field(start_samples(loaded), head.solid, head.background,
                                            head.interpolation),
                                      head.isovalue, settings),
                        head.session};
        Renderer& renderer = session.renderer;
        check_tool(tool.get(), settings.method, kind_of(renderer.field));
        if (tool) renderer.tool_proxy.emplace(tool);
        renderer.settings.tool = tool;
        make_room_for_tools(renderer);
        return session;
    } catch (const std::invalid_argument& e) {
        throw io::InputError(recording +
                             ": the head asks for what cannot be rendered: " + e.what());
    }
}

std::optional<Difference> difference(const SessionTick& recorded, const SessionTick& again) {
    const ProxyUpdate& a = recorded.tick.proxy;
    const ProxyUpdate& b = again.tick.proxy;
    Comparison compare;
    compare("HIP", a.hip, b.hip);
    compare("SCP", a.scp, b.scp);
    compare("status", a.status, b.status);
    compare("mode", a.mode, b.mode);
    compare("density", a.density, b.density);
    compare("isovalue", a.isovalue, b.isovalue);
    compare("tetrahedra", a.tetrahedra, b.tetrahedra);
    compare("force", recorded.tick.force, again.tick.force);
    compare("torque", recorded.tick.torque, again.tick.torque);
    compare("hand orientation", recorded.tick.tool.hand, again.tick.tool.hand);
    compare("proxy orientation", recorded.tick.tool.proxy, again.tick.tool.proxy);
    compare("contacts", recorded.tick.tool.contacts, again.tick.tool.contacts);
    compare("force flags", recorded.tick.force_flags, again.tick.force_flags);
    const LayersFelt &p = recorded.tick.layers, &q = again.tick.layers;
    compare("layer touched", p.touched, q.touched);
    compare("layers inside", p.inside, q.inside);
    compare("layers punctured", p.punctured, q.punctured);
    compare("frozen", recorded.frozen, again.frozen);
    compare("clutched", recorded.clutched, again.clutched);
    compare("moment", recorded.moment, again.moment);
    compare("samples", recorded.version, again.version);
    return compare.found;
}

Replay::Replay(io::RecordingReader& reader, const LoadedVolume& loaded, std::string recording,
               std::function<void()> tell)
    : reader_(reader),
      loaded_(loaded),
      recording_(std::move(recording)),
      session_(recorded_session(reader.head(), loaded, recording_,
                                [&tell](double) {
                                    if (tell) tell();
                                })),
      start_(session_.renderer.settings),
      samples_(session_.renderer.field.shared_samples(), frames_of(loaded),
               grid_of(loaded, std::move(tell))) {}

void Replay::carry_out(const Command& recorded) {
    try {
        Command command = samples_.whole(recorded);
        if (auto* layers = std::get_if<command::UseLayers>(&command)) {
            layers->layers = like_before(with_labels(layers->layers, recording_, loaded_),
                                         session_.renderer.settings.layers);
        }
        if (const auto* limits = std::get_if<DeviceLimits>(&command)) {
            keep_within(session_, *limits);  // a device may have declared any
        } else {
            // As the servo did: against the settings of the start.
            const Field& field = session_.renderer.field;
            apply(session_, CheckedCommand(command, start_, kind_of(field)));
        }
    } catch (const std::invalid_argument& e) {
        throw io::InputError(recording_ + ", before tick " + std::to_string(ticks_) +
                             ": a command that cannot be carried out: " + e.what());
    }
    ++commands_;
}

std::optional<Replay::Tick> Replay::next() {
    while (const auto event = reader_.next()) {
        if (const auto* command = std::get_if<Command>(&*event)) {
            carry_out(*command);
            continue;
        }
        const auto& recorded = std::get<SessionTick>(*event);
        return Tick{recorded, repeat(session_, recorded), ticks_++};
    }
    return std::nullopt;
}

}  // namespace palpate::run
