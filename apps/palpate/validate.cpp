// palpate replay RECORDING --validate.
#include "apps/palpate/validate.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <optional>

#include "apps/live/recorded_samples.hpp"
#include "apps/live/recorded_scene.hpp"
#include "apps/palpate/progress.hpp"
#include "palpate/io/recording.hpp"

namespace palpate::app {
namespace {

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
    if (!same(recorded.moment, again.moment)) {
        return differs("moment", recorded.moment, again.moment);
    }
    if (recorded.version != again.version) {
        return differs("samples", recorded.version, again.version);
    }
    return {};
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
    VolumeOptions options = recorded_volume(reader.head(), recording, volume);
    options.quiet = quiet;
    const LoadedVolume loaded = load_for_terminal(options);
    Session session = recorded_session(reader.head(), loaded, recording);
    RecordedSamples samples(session.renderer.field.shared_samples(), frames_of(loaded));
    ProgressBar bar("validating", quiet);
    std::int64_t ticks = 0, commands = 0;
    while (const auto event = reader.next()) {
        if (const auto* command = std::get_if<Command>(&*event)) {
            try {
                const Command whole = samples.whole(*command);
                check(whole, session.renderer.settings, session.renderer.field.solid());
                apply(session, whole);
            } catch (const std::invalid_argument& e) {
                throw io::InputError(
                    fmt::format("{}, before tick {}: a command that cannot be "
                                "carried out: {}",
                                recording, ticks, e.what()));
            }
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
