// A tick is rendered from copies of the session, which is a value.
#include "benchmarks/soak_recording.hpp"

#include <fmt/format.h>

#include <cstring>
#include <ctime>
#include <limits>

#include "benchmarks/soak_meter.hpp"
#include "palpate/io/recording.hpp"

namespace palpate::benchmarks {
namespace {

bool same(const Vec3& a, const Vec3& b) {
    return std::memcmp(a.data(), b.data(), 3 * sizeof(double)) == 0;
}

/// Bit for bit, in all that a recording keeps of what was rendered.
bool same(const SessionTick& a, const SessionTick& b) {
    const ProxyUpdate& p = a.tick.proxy;
    const ProxyUpdate& q = b.tick.proxy;
    return same(p.hip, q.hip) && same(p.scp, q.scp) && p.status == q.status && p.mode == q.mode &&
           p.density == q.density && p.isovalue == q.isovalue && p.tetrahedra == q.tetrahedra &&
           same(a.tick.force, b.tick.force) && a.tick.force_flags == b.tick.force_flags &&
           a.frozen == b.frozen && a.clutched == b.clutched;
}

/// The tick, and how long it takes at best [ns].
SessionTick repeat_timed(Session& session, const SessionTick& recorded, std::int64_t& shortest) {
    const Session before = session;
    SessionTick tick;
    shortest = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < ReadBack::repeats; ++i) {
        session = before;
        const std::int64_t begin = now_ns(CLOCK_MONOTONIC);
        tick = repeat(session, recorded);
        shortest = std::min(shortest, now_ns(CLOCK_MONOTONIC) - begin);
    }
    return tick;
}

}  // namespace

ReadBack read_back(const std::filesystem::path& path, const Field& field) {
    ReadBack result;
    io::RecordingReader reader(path);
    const io::RecordingHead& head = reader.head();
    if (io::identify(field.volume(), {}).crc32 != head.volume.crc32) {
        result.problem = "the recording names another volume";
        return result;
    }
    Session session{make_renderer(field, head.isovalue, head.settings), head.session};
    LatencyHistogram update, again;
    while (const auto event = reader.next()) {
        if (const auto* command = std::get_if<Command>(&*event)) {
            check(*command, session.renderer.settings, kind_of(field));
            apply(session, *command);
            ++result.commands;
            continue;
        }
        const auto& recorded = std::get<SessionTick>(*event);
        std::int64_t shortest = 0;
        const SessionTick tick = repeat_timed(session, recorded, shortest);
        if (!same(recorded, tick)) {
            result.problem = fmt::format("tick {} of the recording (line {}) comes out differently",
                                         result.ticks, reader.line());
            return result;
        }
        again.add(shortest);
        update.add(recorded.tick.update_ns);
        ++result.ticks;
        result.in_contact += tick.tick.proxy.mode == Mode::constrained;
        result.with_force += !tick.tick.force.isZero(0);
        result.largest_force = std::max(result.largest_force, tick.tick.force.norm());
    }
    result.update = update.summary();
    result.again = again.summary();
    if (!reader.complete()) result.problem = "the recording has no end";
    if (reader.lost() > 0) result.problem = fmt::format("the recording lost {}", reader.lost());
    return result;
}

}  // namespace palpate::benchmarks
