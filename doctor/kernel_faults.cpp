// Kernel, processors and clock.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "doctor/faults.hpp"

namespace palpate::doctor {
namespace {

/// A hand feels a greater lateness at 1000 Hz.
constexpr double slow_exit_us = 100;
constexpr double memory_needed = 512.0 * 1024 * 1024;  // bytes

/// Read by the processor itself, without a slow device or a lock.
constexpr std::array<std::string_view, 6> quick_clocks{
    "tsc",      "kvm-clock",        "arch_sys_counter", "hyperv_clocksource_tsc_page",
    "timebase", "riscv_clocksource"};

Fault preemption(const Machine& machine) {
    return {"kernel-preemption", false,
            fmt::format("a real-time thread waits while the kernel works for another program "
                        "(preemption: {})",
                        name_of(machine.preemption)),
            machine.preemption_can_be_chosen
                ? "add preempt=full to GRUB_CMDLINE_LINUX_DEFAULT in /etc/default/grub; sudo "
                  "update-grub; reboot"
                : "sudo apt install linux-image-rt-amd64; reboot"};
}

/// Empty: frequencies that follow the load are no fault of ours.
std::string slow_governor(const Machine& machine) {
    for (const std::string& governor : machine.governors) {
        if (governor != "performance") return governor;
    }
    return {};
}

double slowest_exit(const Machine& machine) {
    double slowest = 0;
    for (const IdleState& state : machine.idle_states) slowest = std::max(slowest, state.exit_us);
    return slowest;
}

}  // namespace

std::vector<Fault> kernel_faults(const Facts& facts) {
    const Machine& machine = facts.machine;
    std::vector<Fault> faults;
    if (machine.preemption == Preemption::none || machine.preemption == Preemption::voluntary) {
        faults.push_back(preemption(machine));
    }
    if (!machine.clock_source.empty() &&
        std::ranges::find(quick_clocks, machine.clock_source) == quick_clocks.end()) {
        faults.push_back({"clock-source", false,
                          fmt::format("the clock is {}: reading it takes a microsecond or more, "
                                      "and several are read in each tick",
                                      machine.clock_source),
                          "update the firmware (BIOS); if the kernel's log blames the tsc without "
                          "reason, boot with tsc=reliable"});
    }
    if (const std::string governor = slow_governor(machine); !governor.empty()) {
        faults.push_back(
            {"processor-governor", false,
             fmt::format("the processors slow down between ticks (governor: {})", governor),
             "sudo apt install linux-cpupower; sudo cpupower frequency-set -g "
             "performance"});
    }
    if (const double exit = slowest_exit(machine); exit > slow_exit_us) {
        faults.push_back({"processor-sleep", false,
                          fmt::format("a processor that sleeps deeply wakes {:.0f} us late", exit),
                          fmt::format("sudo apt install linux-cpupower; sudo cpupower idle-set -D "
                                      "{:.0f}",
                                      slow_exit_us)});
    }
    if (machine.processor_quota && *machine.processor_quota < 2) {
        faults.push_back({"processor-quota", false,
                          fmt::format("a control group stops this program when it has used {:.3g} "
                                      "processors",
                                      *machine.processor_quota),
                          "give the container or service at least two processors (--cpus=2, "
                          "CPUQuota=200%)"});
    }
    if (machine.processors == 1) {
        faults.push_back({"processor-single", false,
                          "there is one processor: window, readers and servo share it",
                          "use a machine, or give the virtual one, at least two processors"});
    }
    if (machine.processors > 0 && machine.load > 1.5 * machine.processors) {
        faults.push_back({"processor-load", false,
                          fmt::format("other programs compute: {:.3g} threads for {} processors",
                                      machine.load, machine.processors),
                          "end them before a session (top shows them)"});
    }
    if (machine.memory_available > 0 && machine.memory_available < memory_needed) {
        faults.push_back({"memory-low", false,
                          fmt::format("{:.0f} MB of memory are left: the system will swap or end "
                                      "programs",
                                      machine.memory_available / 1e6),
                          "close other programs, or touch a smaller volume"});
    }
    return faults;
}

}  // namespace palpate::doctor
