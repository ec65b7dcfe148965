// palpate replay RECORDING --validate.
#include "apps/palpate/validate.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <optional>

#include "apps/palpate/progress.hpp"
#include "apps/palpate/render_options.hpp"
#include "apps/palpate/volume_options.hpp"
#include "baselines/methods.hpp"
#include "io/number.hpp"
#include "io/recording.hpp"

namespace palpate::app {
namespace {

/// The recorded name, looked for from here, then beside the recording.
std::string volume_name(const std::string& recorded, const std::filesystem::path& recording) {
    if (recorded.starts_with("synthetic:") || std::filesystem::exists(recorded)) return recorded;
    std::string name = recorded;
    while (name.size() > 1 && name.back() == '/') name.pop_back();  // a folder
    const auto beside = recording.parent_path() / std::filesystem::path(name).filename();
    return std::filesystem::exists(beside) ? beside.string() : recorded;
}

LoadedVolume load_recorded(const io::RecordingHead& head, const std::string& recording,
                           const std::string& instead, bool quiet) {
    const auto& options = head.volume.options;
    const auto option = [&](const char* name) {
        const auto found = options.find(name);
        return found == options.end() ? std::string() : found->second;
    };
    VolumeOptions volume;
    volume.volume = instead.empty() ? volume_name(option("volume"), recording) : instead;
    volume.dims = option("dims");
    volume.type = option("type");
    volume.spacing = option("spacing");
    volume.series = option("series");
    volume.skip = io::number_from<std::uint64_t>(option("skip")).value_or(0);
    volume.time_step = io::number_from<int>(option("time-step")).value_or(0);
    volume.smooth = io::number_from<int>(option("smooth")).value_or(0);
    volume.quiet = quiet;
    LoadedVolume loaded = load(volume);
    const io::VolumeIdentity now = io::identify(loaded.volume, {});
    if (now.size != head.volume.size || now.type != head.volume.type ||
        now.crc32 != head.volume.crc32) {
        throw io::InputError(volume.volume +
                             ": is not the volume of the recording (its size, type "
                             "or samples differ): name the right one with --volume");
    }
    return loaded;
}

/// The same bits; what is not a number equals what is none either, for text keeps no payload.
bool same(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
           (std::isnan(a) && std::isnan(b));
}

bool same(const Vec3& a, const Vec3& b) {
    return same(a[0], b[0]) && same(a[1], b[1]) && same(a[2], b[2]);
}

/// Which part of a tick differs, with both values; empty if none does.
std::string difference(const SessionTick& recorded, const SessionTick& again) {
    const auto differs = [](const char* name, const auto& a, const auto& b) {
        return fmt::format("{}: recorded {}, now {}", name, a, b);
    };
    const auto vectors = [&](const char* name, const Vec3& a, const Vec3& b) {
        return differs(name, fmt::format("({}, {}, {})", a[0], a[1], a[2]),
                       fmt::format("({}, {}, {})", b[0], b[1], b[2]));
    };
    const ProxyUpdate& a = recorded.tick.proxy;
    const ProxyUpdate& b = again.tick.proxy;
    if (!same(a.hip, b.hip)) return vectors("HIP", a.hip, b.hip);
    if (!same(a.scp, b.scp)) return vectors("SCP", a.scp, b.scp);
    if (a.status != b.status) return differs("status", int(a.status), int(b.status));
    if (a.mode != b.mode) return differs("mode", int(a.mode), int(b.mode));
    if (!same(a.density, b.density)) return differs("density", a.density, b.density);
    if (!same(a.isovalue, b.isovalue)) return differs("isovalue", a.isovalue, b.isovalue);
    if (a.tetrahedra != b.tetrahedra) return differs("tetrahedra", a.tetrahedra, b.tetrahedra);
    if (!same(recorded.tick.force, again.tick.force)) {
        return vectors("force", recorded.tick.force, again.tick.force);
    }
    if (recorded.tick.force_flags != again.tick.force_flags) {
        return differs("force flags", recorded.tick.force_flags, again.tick.force_flags);
    }
    if (recorded.frozen != again.frozen) return differs("frozen", recorded.frozen, again.frozen);
    if (recorded.clutched != again.clutched) {
        return differs("clutched", recorded.clutched, again.clutched);
    }
    return {};
}

Session session_of(const io::RecordingHead& head, const LoadedVolume& loaded,
                   const std::string& name) {
    try {
        RendererSettings settings = head.settings;
        settings.method = baselines::method_named(head.method);
        check(head.session);
        return {make_renderer(Field(loaded.volume, head.solid, head.background), head.isovalue,
                              settings),
                head.session};
    } catch (const std::invalid_argument& e) {
        throw io::InputError(name + ": the head asks for what cannot be rendered: " + e.what());
    }
}

/// What else may be the reason; reads on to the end.
std::string excuses(io::RecordingReader& reader) {
    std::string words;
    if (reader.head().version != PALPATE_VERSION) {
        words +=
            " (recorded with version " + reader.head().version + ", this is " PALPATE_VERSION ")";
    }
    while (reader.next()) {
    }
    if (reader.lost() > 0) {
        words += fmt::format(" (the recording lost {} events while it was made)", reader.lost());
    }
    return words;
}

}  // namespace

void validate(const std::string& recording, const std::string& volume, bool quiet) {
    io::RecordingReader reader{std::filesystem::path(recording)};
    const LoadedVolume loaded = load_recorded(reader.head(), recording, volume, quiet);
    Session session = session_of(reader.head(), loaded, recording);
    ProgressBar bar("validating", quiet);
    std::int64_t ticks = 0, commands = 0;
    while (const auto event = reader.next()) {
        if (const auto* command = std::get_if<Command>(&*event)) {
            try {
                check(*command, session.renderer.settings, session.renderer.field.solid());
            } catch (const std::invalid_argument& e) {
                throw io::InputError(
                    fmt::format("{}, before tick {}: a command that cannot be "
                                "carried out: {}",
                                recording, ticks, e.what()));
            }
            apply(session, *command);
            ++commands;
            continue;
        }
        const auto& recorded = std::get<SessionTick>(*event);
        const SessionTick again = repeat(session, recorded);
        if (const std::string words = difference(recorded, again); !words.empty()) {
            throw io::InputError(fmt::format("{}: tick {} (line {}, {} s) differs: {}{}", recording,
                                             ticks, reader.line(), recorded.tick.time, words,
                                             excuses(reader)));
        }
        if (++ticks % 1024 == 0) bar.at(reader.progress());
    }
    if (quiet) return;
    fmt::print("{}: {} ticks and {} commands, rendered again, are the same bit for bit\n",
               recording, ticks, commands);
    if (reader.lost() > 0) {
        fmt::print("the recording lost {} events while it was made\n", reader.lost());
    }
    if (!reader.complete()) fmt::print("the recording was cut off before its end\n");
}

}  // namespace palpate::app
