// The status line and report. Compute time is ours, lateness the machine's.
#include "apps/palpate/live_status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace palpate::app {
namespace {

std::string four(const LatencySummary& s) {
    return fmt::format("p50 {}, p99 {}, p99.9 {}, max {}", duration_text(s.p50),
                       duration_text(s.p99), duration_text(s.p999), duration_text(s.max));
}

nlohmann::ordered_json json_of(const LatencySummary& s) {
    return {{"p50", s.p50}, {"p99", s.p99}, {"p99.9", s.p999}, {"max", s.max}};
}

/// " bone" where a layer is touched, " in skin" where the SCP is in one.
std::string layer_words(const LayersFelt& felt, const Layers* layers) {
    if (!layers) return {};
    const auto name = [&](int layer) {
        return layers->layers[static_cast<std::size_t>(layer)].name;
    };
    const int count = static_cast<int>(layers->layers.size());
    if (felt.touched >= 0 && felt.touched < count) return ' ' + name(felt.touched);
    if (felt.inside > 0 && felt.inside <= count) return " in " + name(felt.inside - 1);
    return {};
}

}  // namespace

std::string status_line(const Snapshot& now, const Layers* layers, const ServoReport& report,
                        std::size_t columns) {
    const Tick& tick = now.session.tick;
    const bool ready = now.session.device.status == DeviceStatus::ready;
    std::string words = force_words(tick);
    if (!words.empty()) words = " (" + words + ")";
    std::string state = ready ? tick.proxy.mode == Mode::constrained ? "contact" : "free"
                              : name_of(now.session.device.status);
    if (ready) state += layer_words(tick.layers, layers);
    if (now.session.frozen) state = "frozen";
    if (now.session.clutched) state = "clutch";
    std::string line =
        fmt::format("{:.1f} s {} {:.2f} N{} iso {:.5g} missed {} compute p99.9 {} late p99 {}",
                    tick.time, state, tick.force.norm(), words, tick.proxy.isovalue, report.missed,
                    duration_text(report.compute.p999), duration_text(report.lateness.p99));
    line.resize(std::min(line.size(), columns));
    return line;
}

std::string streaming_text(const stream::BrickLoaderStatus& s) {
    std::string text = fmt::format(
        "bricks {} in memory ({:.1f} MB, at most {:.1f}), {} loaded, {} dropped, {} missing; {} "
        "requests, "
        "{:.1f} MB, {} retries, {} from the cache",
        s.resident, double(s.bytes) / 1e6, double(s.most_bytes) / 1e6, s.loaded, s.dropped,
        s.missing, s.traffic.requests, double(s.traffic.bytes) / 1e6, s.traffic.retries,
        s.traffic.cached);
    if (!s.problem.empty()) text += "\n" + s.problem;
    return text;
}

std::string report_text(const ServoReport& r, double seconds) {
    if (r.compute.count == 0)
        return fmt::format("ticks {} in {:.1f} s, unpaced\n", r.ticks, seconds);
    std::string text = fmt::format(
        "ticks {} in {:.1f} s, missed deadlines {}, forces cancelled {}\n"
        "compute time (ours)    {}\n"
        "lateness (the machine) {}\n"
        "period                 {}\n",
        r.ticks, seconds, r.missed, r.overruns, four(r.compute), four(r.lateness), four(r.period));
    if (r.unrecorded > 0) {
        text += fmt::format("events that the recording lost: {} (the disk was too slow)\n",
                            r.unrecorded);
    }
    if (r.worst.tick >= 0) {
        text += fmt::format("worst tick {}: woken {} late, {} of work ({} computing); mostly {}\n",
                            r.worst.tick, duration_text(r.worst.lateness_ns),
                            duration_text(r.worst.work_ns), duration_text(r.worst.compute_ns),
                            name_of(r.worst.cause));
    }
    return text;
}

nlohmann::ordered_json report_json(const ServoReport& r, double seconds, const DeviceInfo& device) {
    return {{"device", device.name + " (" + device.model + ")"},
            {"seconds", seconds},
            {"ticks", r.ticks},
            {"missed", r.missed},
            {"overruns", r.overruns},
            {"unrecorded", r.unrecorded},
            {"compute_ns", json_of(r.compute)},
            {"lateness_ns", json_of(r.lateness)},
            {"work_ns", json_of(r.work)},
            {"period_ns", json_of(r.period)},
            {"worst",
             {{"tick", r.worst.tick},
              {"lateness_ns", r.worst.lateness_ns},
              {"work_ns", r.worst.work_ns},
              {"compute_ns", r.worst.compute_ns},
              {"cause", name_of(r.worst.cause)}}}};
}

}  // namespace palpate::app
