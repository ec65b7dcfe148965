// Summary, report and JSON of the doctor's results.
#include "doctor/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "doctor/usb.hpp"

namespace palpate::doctor {
namespace {

using Json = nlohmann::ordered_json;

double us(std::int64_t ns) {
    return static_cast<double>(ns) / 1000;
}

std::string joined(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
    return text;
}

std::string kernel_line(const Machine& m) {
    return fmt::format("Linux {}, preemption {}, {} processors{}, clock {}", m.release,
                       name_of(m.preemption), m.processors, m.is_virtual ? " (virtual)" : "",
                       m.clock_source.empty() ? "unknown" : m.clock_source);
}

std::string real_time_line(const Limits& limits) {
    return fmt::format("SCHED_FIFO {}, memory {}, timers exact to {:.3g} us",
                       limits.priority_error == 0 ? "granted" : "refused",
                       limits.lock_error == 0 ? "can be locked" : "cannot be locked",
                       std::max(limits.timer_resolution_ns, limits.timer_slack_ns) / 1000);
}

std::string latency_line(const Latency& latency) {
    const LatencySummary& late = latency.report.lateness;
    return fmt::format(
        "{:.0f} s{}: woken {:.3g} us late at p50, {:.3g} us at p99, {:.3g} us at "
        "p99.9, {:.3g} us at most; {} of {} ticks missed",
        latency.seconds, latency.under_load ? " under load" : "", us(late.p50), us(late.p99),
        us(late.p999), us(late.max), latency.report.missed,
        latency.report.ticks + latency.report.missed);
}

std::string graphics_line(const Graphics& graphics) {
    const std::string machine = graphics.machine.empty() ? "none" : graphics.machine;
    return fmt::format("pictures by {}; the machine's driver: {}; {}",
                       graphics.pictures.empty() ? "nothing" : graphics.pictures, machine,
                       graphics.has_display ? "a display" : "no display");
}

std::string programs_line(const std::vector<Program>& programs) {
    std::vector<std::string> broken;
    for (const Program& program : programs) {
        if (!program.problem.empty()) broken.push_back(program.name);
    }
    return broken.empty() ? fmt::format("all {} helpers work", programs.size())
                          : "not usable: " + joined(broken);
}

std::string devices_line(const Facts& facts) {
    std::vector<std::string> found, absent;
    for (const devices::DeviceFinding& device : facts.devices) {
        (device.found ? found : absent).push_back(device.name);
    }
    return fmt::format(
        "{}{}", joined(found),
        absent.empty() ? "" : "; not here: " + joined(absent) + " (palpate devices says why)");
}

std::vector<std::pair<const char*, std::string>> lines_of(const Facts& facts) {
    std::vector<std::pair<const char*, std::string>> lines{
        {"kernel", kernel_line(facts.machine)}, {"real time", real_time_line(facts.limits)}};
    if (facts.latency) lines.emplace_back("latency", latency_line(*facts.latency));
    lines.emplace_back("graphics", graphics_line(facts.graphics));
    lines.emplace_back("helpers", programs_line(facts.programs));
    lines.emplace_back("devices", devices_line(facts));
    return lines;
}

std::string hints(std::ptrdiff_t count) {
    return fmt::format("{} hint{}", count, count == 1 ? "" : "s");
}

std::string verdict(const std::vector<Fault>& faults) {
    const auto essential = std::ranges::count_if(faults, &Fault::essential);
    if (faults.empty()) return "nothing is missing";
    const std::string others = hints(std::ssize(faults) - essential);
    if (essential == 0) return "nothing essential is missing; " + others;
    return fmt::format("{} essential, {}", essential, others);
}

std::string certificate(const Latency& latency) {
    const ServoReport& r = latency.report;
    std::string text = fmt::format(
        "Rendered: {}.\n\nFor {:.0f} s{}.\n\n", latency.rendered, latency.seconds,
        latency.under_load ? ", while as many threads as there are processors compute" : "");
    for (const std::string& sentence : latency.privileges) text += "- " + sentence + "\n";
    text += fmt::format("\n| | p50 [us] | p99 | p99.9 | max |\n|---|---|---|---|---|\n");
    const auto row = [&](const char* name, const LatencySummary& s) {
        text += fmt::format("| {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", name, us(s.p50),
                            us(s.p99), us(s.p999), us(s.max));
    };
    row("lateness (the machine)", r.lateness);
    row("compute (this program)", r.compute);
    row("work (both)", r.work);
    row("period", r.period);
    text +=
        fmt::format("\nTicks {}, missed {}, forces cancelled {}.\n", r.ticks, r.missed, r.overruns);
    if (r.worst.tick >= 0) {
        text += fmt::format("Worst tick {}: woken {:.1f} us late, {:.1f} us of work; mostly {}.\n",
                            r.worst.tick, us(r.worst.lateness_ns), us(r.worst.work_ns),
                            name_of(r.worst.cause));
    }
    text += "\n| woken late by at most [us] | ticks |\n|---|---|\n";
    for (const LatenessBin& bin : latency.histogram) {
        text += fmt::format("| {:.5g} | {} |\n", bin.to_us, bin.ticks);
    }
    return text;
}

std::string devices_table(const Facts& facts) {
    std::string text = "| device | found | |\n|---|---|---|\n";
    for (const devices::DeviceFinding& d : facts.devices) {
        text += fmt::format("| {} | {} | {} |\n", d.name, d.found ? "yes" : "no",
                            d.found ? d.what : d.missing);
    }
    for (const PluggedIn& device : plugged_in(facts.machine.usb)) {
        text += fmt::format("| {} | plugged in | {} |\n", device.backend, device.name);
    }
    return text;
}

Json json_of(const LatencySummary& s) {
    return {{"p50", s.p50}, {"p99", s.p99}, {"p99.9", s.p999}, {"max", s.max}};
}

Json json_of(const Latency& latency) {
    Json histogram = Json::array();
    for (const LatenessBin& bin : latency.histogram) {
        histogram.push_back({{"to_us", bin.to_us}, {"ticks", bin.ticks}});
    }
    return {{"seconds", latency.seconds},
            {"under_load", latency.under_load},
            {"rendered", latency.rendered},
            {"privileges", latency.privileges},
            {"ticks", latency.report.ticks},
            {"missed", latency.report.missed},
            {"overruns", latency.report.overruns},
            {"lateness_ns", json_of(latency.report.lateness)},
            {"compute_ns", json_of(latency.report.compute)},
            {"work_ns", json_of(latency.report.work)},
            {"lateness_histogram", histogram}};
}

Json json_of(const Machine& m) {
    Json json = {{"kernel", m.release},
                 {"version", m.version},
                 {"preemption", name_of(m.preemption)},
                 {"virtual", m.is_virtual},
                 {"processors", m.processors},
                 {"load", m.load},
                 {"memory_available", m.memory_available},
                 {"clock_source", m.clock_source},
                 {"governors", m.governors},
                 {"real_time_share", m.real_time_share}};
    json["processor_quota"] = m.processor_quota ? Json(*m.processor_quota) : Json(nullptr);
    json["idle_states"] = Json::array();
    for (const IdleState& state : m.idle_states) {
        json["idle_states"].push_back({{"name", state.name}, {"exit_us", state.exit_us}});
    }
    json["usb"] = Json::array();
    for (const UsbDevice& usb : m.usb) {
        const KnownUsb* const kind = known(usb);
        if (!kind) continue;
        json["usb"].push_back(
            {{"id", usb.vendor + ":" + usb.product}, {"name", kind->name}, {"for", kind->backend}});
    }
    return json;
}

Json limit_json(std::uint64_t limit) {
    return limit == Limits::unlimited ? Json("unlimited") : Json(limit);
}

}  // namespace

std::string summary_of(const Facts& facts, const std::vector<Fault>& faults) {
    std::string text;
    for (const auto& [name, line] : lines_of(facts)) {
        text += fmt::format("{:<10} {}\n", name, line);
    }
    for (const Fault& fault : faults) {
        text += fmt::format("\n{} {}: {}\n  remedy: {}\n", fault.essential ? "MISSING" : "hint   ",
                            fault.name, fault.meaning, fault.remedy);
    }
    return text + "\n" + verdict(faults) + "\n";
}

std::string report_of(const Facts& facts, const std::vector<Fault>& faults,
                      const std::string& date) {
    std::string text = fmt::format("# Report of palpate doctor\n\npalpate {}, {}\n\n## Machine\n\n",
                                   PALPATE_VERSION, date);
    for (const auto& [name, line] : lines_of(facts)) text += fmt::format("- {}: {}\n", name, line);
    text += fmt::format("- kernel version: {}\n\n## Faults: {}\n\n", facts.machine.version,
                        verdict(faults));
    for (const Fault& fault : faults) {
        text += fmt::format("- {}{}: {}\n  - remedy: `{}`\n", fault.name,
                            fault.essential ? " (essential)" : "", fault.meaning, fault.remedy);
    }
    text += "\n## Devices\n\n" + devices_table(facts);
    if (facts.latency) text += "\n## Real-time certificate\n\n" + certificate(*facts.latency);
    return text;
}

Json json_of(const Facts& facts, const std::vector<Fault>& faults) {
    Json json = {{"version", PALPATE_VERSION},
                 {"essential_missing", std::ranges::any_of(faults, &Fault::essential)}};
    json["faults"] = Json::array();
    for (const Fault& fault : faults) {
        json["faults"].push_back({{"name", fault.name},
                                  {"essential", fault.essential},
                                  {"meaning", fault.meaning},
                                  {"remedy", fault.remedy}});
    }
    json["machine"] = json_of(facts.machine);
    const Limits& limits = facts.limits;
    json["limits"] = {{"priority", limit_json(limits.priority)},
                      {"priority_granted", limits.priority_error == 0},
                      {"locked_bytes", limit_json(limits.locked_bytes)},
                      {"lock_granted", limits.lock_error == 0},
                      {"real_time_us", limit_json(limits.real_time_us)},
                      {"timer_resolution_ns", limits.timer_resolution_ns},
                      {"timer_slack_ns", limits.timer_slack_ns}};
    json["graphics"] = {{"pictures", facts.graphics.pictures},
                        {"machine", facts.graphics.machine},
                        {"display", facts.graphics.has_display}};
    json["programs"] = Json::array();
    for (const Program& program : facts.programs) {
        json["programs"].push_back(
            {{"name", program.name}, {"works", program.problem.empty()}, {"path", program.path}});
    }
    json["devices"] = Json::array();
    for (const devices::DeviceFinding& device : facts.devices) {
        json["devices"].push_back({{"name", device.name},
                                   {"found", device.found},
                                   {"what", device.what},
                                   {"missing", device.missing}});
    }
    if (facts.latency) json["latency"] = json_of(*facts.latency);
    return json;
}

}  // namespace palpate::doctor
