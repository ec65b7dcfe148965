// Faults of priority, locked memory and timers, which the kernel grants a user's programs.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "doctor/faults.hpp"

namespace palpate::doctor {
namespace {

/// Above the servo's 80, for its watchdog and the devices' threads (docs/servo.md).
constexpr std::uint64_t priority_needed = 81;
constexpr std::uint64_t lockable_memory_needed = std::uint64_t{1} << 30;  // bytes
constexpr const char* group = "audio";
constexpr const char* file = "/etc/security/limits.d/palpate.conf";

bool is_enough(const LimitLine& line, std::uint64_t needed) {
    if (line.value == "unlimited" || line.value == "-1" || line.value == "infinity") return true;
    const std::uint64_t value = std::strtoull(line.value.c_str(), nullptr, 10);
    return value >= needed;
}

bool is_member(const Facts& facts, const std::string& name) {
    const auto found = facts.machine.members.find(name);
    return found != facts.machine.members.end() &&
           std::ranges::count(found->second, facts.account.name) > 0;
}

/// How to get a limit of `needed`, written as `value`, by PAM's files: what is missing of line,
/// group and login.
std::string way_to_limit(const Facts& facts, const std::string& item, std::uint64_t needed,
                         const std::string& value) {
    std::string group_to_join;
    for (const LimitLine& line : facts.machine.limit_lines) {
        if (line.item != item || !is_enough(line, needed)) continue;
        const bool is_group = line.domain.rfind('@', 0) == 0;
        const std::string name = is_group ? line.domain.substr(1) : line.domain;
        if (is_group ? is_member(facts, name) : name == facts.account.name || name == "*") {
            return "log out and in again: the limit is set, but this login is older";
        }
        if (is_group && group_to_join.empty()) group_to_join = name;
    }
    if (!group_to_join.empty()) {
        return fmt::format("sudo adduser $USER {}; then log out and in again", group_to_join);
    }
    return fmt::format(
        "echo '@{0} - {1} {2}' | sudo tee -a {3}; sudo adduser $USER {0}; then log out "
        "and in again",
        group, item, value, file);
}

Fault refused_priority(const Facts& facts) {
    const Limits& limits = facts.limits;
    Fault fault{"real-time-priority",
                true,
                fmt::format("the system refuses real-time priority ({}): other programs delay the "
                            "servo, and the force shakes or drops out",
                            std::strerror(limits.priority_error)),
                {}};
    const bool allowed = limits.priority >= priority_needed || facts.account.id == 0;
    fault.remedy = way_to_limit(facts, "rtprio", priority_needed, "90");
    if (facts.machine.real_time_forbidden) {
        fault.name = "real-time-forbidden";
        fault.meaning = "this control group has no time for real-time threads";
        fault.remedy =
            "run it outside of the container, or give its control group a cpu.rt_runtime_us";
    } else if (allowed) {
        fault.remedy =
            "the limit allows it, so a container or a sandbox forbids it: start it with "
            "--cap-add=SYS_NICE --ulimit rtprio=90, or run it outside";
    }
    return fault;
}

Fault unlocked_memory(const Facts& facts) {
    const std::string meaning = fmt::format(
        "memory cannot be locked ({}): the servo stops for milliseconds when the system swaps",
        std::strerror(facts.limits.lock_error));
    return {"locked-memory", false, meaning,
            way_to_limit(facts, "memlock", lockable_memory_needed / 1024, "unlimited")};
}

}  // namespace

std::vector<Fault> real_time_faults(const Facts& facts) {
    const Limits& limits = facts.limits;
    const Machine& machine = facts.machine;
    std::vector<Fault> faults;
    if (limits.priority_error != 0) {
        faults.push_back(refused_priority(facts));
    } else if (limits.priority < priority_needed && limits.priority > 0 && facts.account.id != 0) {
        faults.push_back({"real-time-priority-low", false,
                          fmt::format("real-time priorities go up to {}; a device's thread and the "
                                      "watchdog ask for {}, one above the servo",
                                      limits.priority, priority_needed),
                          way_to_limit(facts, "rtprio", priority_needed, "90")});
    }
    if (limits.lock_error != 0) faults.push_back(unlocked_memory(facts));
    if (limits.real_time_us < 20'000) {
        faults.push_back({"real-time-limit", true,
                          fmt::format("the kernel ends a real-time thread that computes for {} us",
                                      limits.real_time_us),
                          "ulimit -R unlimited, or take the limit away from whatever starts it "
                          "(LimitRTTIME= of systemd)"});
    }
    if (machine.real_time_share < 0.5) {
        faults.push_back({"real-time-share", true,
                          fmt::format("real-time threads get only {:.0f} % of each period, and "
                                      "have to wait for the rest of it",
                                      100 * machine.real_time_share),
                          "sudo sysctl kernel.sched_rt_period_us=1000000 "
                          "kernel.sched_rt_runtime_us=950000"});
    }
    if (limits.timer_resolution_ns > 1e5) {
        faults.push_back({"timer-resolution", true,
                          fmt::format("the kernel's timers are exact to {:.3g} ms only: no loop of "
                                      "1000 Hz keeps its time",
                                      limits.timer_resolution_ns / 1e6),
                          "boot without highres=off, with a kernel of CONFIG_HIGH_RES_TIMERS "
                          "(Debian's have it)"});
    }
    if (limits.timer_slack_ns > 1000) {
        faults.push_back(
            {"timer-slack", false,
             fmt::format("threads without real-time priority are woken up to {:.0f} us "
                         "late, although they ask for 1 ns",
                         limits.timer_slack_ns / 1000),
             "run it outside of the sandbox that forbids prctl(PR_SET_TIMERSLACK)"});
    }
    return faults;
}

}  // namespace palpate::doctor
