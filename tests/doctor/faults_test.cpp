// Each fault is injected into a healthy machine, and has to be the one that is named, with what
// mends it.
#include "doctor/faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>

#include "doctor/made_up_machine.hpp"
#include "doctor/report.hpp"
#include "doctor/usb.hpp"

namespace palpate::doctor::test {
namespace {

using support::contains;

struct Injection {
    const char* fault;
    bool essential;
    const char* remedy;  ///< part of it
    void (*inject)(MadeUpMachine&);
};

void PrintTo(const Injection& injection, std::ostream* out) {
    *out << injection.fault;
}

using M = MadeUpMachine;
constexpr const char* governor = "sys/devices/system/cpu/cpu2/cpufreq/scaling_governor";

void no_priority(M& m) {
    m.facts.limits.priority = 0;
    m.facts.limits.priority_error = EPERM;
}

void not_a_member(M& m) {
    no_priority(m);
    m.put("etc/group", "audio:x:29:ben\n");
}
void no_limits_file(M& m) {
    no_priority(m);
    m.remove("etc/security");
}
void no_time_in_the_group(M& m) {
    m.facts.limits.priority_error = EPERM;
    m.put("proc/self/cgroup", "4:memory:/\n3:cpu,cpuacct:/box\n");
    m.put("sys/fs/cgroup/cpu/box/cpu.rt_runtime_us", "0\n");
}
void unlocked(M& m) {
    m.facts.limits.lock_error = ENOMEM;
    m.put("etc/security/limits.d/palpate.conf", "@audio - rtprio 90\n# @audio - memlock 1\n");
}
void voluntary(M& m) {
    m.put("proc/sys/kernel/version", "#1 SMP Debian 6.1.1\n");
    m.put("boot/config-6.1.0-rt", "CONFIG_SMP=y\nCONFIG_PREEMPT_VOLUNTARY=y\n");
}
void preempt_none(M& m) {
    m.put("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.1\n");
    m.put("boot/config-6.1.0-rt", "CONFIG_PREEMPT=y\nCONFIG_PREEMPT_DYNAMIC=y\n");
    m.put("proc/cmdline", "quiet preempt=none\n");
}
void slow_clock(M& m) {
    m.put("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n");
}
void deep_sleep(M& m) {
    m.put("sys/devices/system/cpu/cpu1/cpuidle/state3/name", "C10\n");
    m.put("sys/devices/system/cpu/cpu1/cpuidle/state3/latency", "890\n");
}
void quota_of_version_1(M& m) {
    m.put("proc/self/cgroup", "3:cpu:/box\n");
    m.put("sys/fs/cgroup/cpu/box/cpu.cfs_quota_us", "150000\n");
    m.put("sys/fs/cgroup/cpu/box/cpu.cfs_period_us", "100000\n");
}
void one_processor(M& m) {
    for (const char* cpu : {"cpu1", "cpu2"}) {
        m.remove(std::string("sys/devices/system/cpu/") + cpu);
    }
    m.put("sys/devices/system/cpu/cpu3/online", "0\n");
}
void missed_in_a_virtual_machine(M& m) {
    m.facts.latency->report.missed = 100;
    m.put("proc/cpuinfo", "flags\t: fpu tsc hypervisor\n");
}
void no_driver(M& m) {
    m.put("sys/class/drm/card0/dev", "226:0\n");
    m.node("dev/dri/renderD128", 0666);
    m.facts.graphics.machine = "llvmpipe (LLVM 15.0.6)";
}
void closed_card(M& m) {
    m.put("sys/class/drm/card0/dev", "226:0\n");
    m.node("dev/dri/renderD128", 0660);
    m.node_group = 44;
    m.put("etc/group", "video:x:44:\naudio:x:29:anna\n");
    m.facts.graphics.machine.clear();
}
void closed_sigma(M& m) {
    m.plug("1451", "0403", "sigma.7", 0664);
    m.not_found("forcedimension", "no device");
}
void closed_touch(M& m) {
    m.plug("2988", "0302", "Touch");
    m.plug_serial(0660);
    m.node_group = 20;
}
void closed_hid_touch(M& m) {
    m.plug("2988", "0302", "Touch");
    m.plug_hidraw(0600);
}
void touch_before_login(M& m) {
    m.plug("2988", "0302", "Touch");
    m.plug_serial(0660);
    m.node_group = 20;
    m.put("etc/group", "audio:x:29:anna\ndialout:x:20:anna\n");
}
void falcon_without_library(M& m) {
    m.plug("0403", "cb48", "FALCON HAPTIC");
    m.facts.devices.push_back({"falcon", false, {}, "cannot open its library (libftdi1.so.2)", {}});
}
void omega_without_library(M& m) {
    m.plug("1451", "0402", "omega.x");
    m.not_found("forcedimension", "cannot open its library (libdhd.so.3)");
}
void touch_without_terminal_libraries(M& m) {
    m.plug("2988", "0304", "Touch");
    m.not_found("openhaptics",
                "cannot open its library (libtinfo.so.5: cannot open shared object file)");
}
void mouse_without_service(M& m) {
    m.plug("256f", "c635", "SpaceMouse Compact", 0600);
    m.not_found("spacenav", "no spacenavd listens");
}
void sleepy_omega(M& m) {
    m.plug("1451", "0402", "omega.x");
    m.put("sys/bus/usb/devices/1-2/power/control", "auto\n");
}
void wanted_haply(M& m) {
    m.facts.wanted_device = "haply";
    m.not_found("haply", "nothing to talk to at 127.0.0.1:10001");
}

const Injection real_time[] = {
    {"real-time-priority", true, "log out and in again: the limit is set", no_priority},
    {"real-time-priority", true, "sudo adduser $USER audio", not_a_member},
    {"real-time-priority", true, "echo '@audio - rtprio 90' | sudo tee -a /etc/security/limits.d",
     no_limits_file},
    {"real-time-priority", true, "--cap-add=SYS_NICE",
     [](M& m) { m.facts.limits.priority_error = EPERM; }},
    {"real-time-forbidden", true, "cpu.rt_runtime_us", no_time_in_the_group},
    {"real-time-priority-low", false, "log out", [](M& m) { m.facts.limits.priority = 50; }},
    {"locked-memory", false, "echo '@audio - memlock unlimited'", unlocked},
    {"real-time-limit", true, "ulimit -R unlimited",
     [](M& m) { m.facts.limits.real_time_us = 10'000; }},
    {"real-time-share", true, "sudo sysctl kernel.sched_rt_period_us=1000000",
     [](M& m) { m.put("proc/sys/kernel/sched_rt_runtime_us", "100000\n"); }},
    {"timer-resolution", true, "highres=off",
     [](M& m) { m.facts.limits.timer_resolution_ns = 4e6; }},
    {"timer-slack", false, "PR_SET_TIMERSLACK",
     [](M& m) { m.facts.limits.timer_slack_ns = 50'000; }},
};

const Injection kernels[] = {
    {"kernel-preemption", false, "linux-image-rt-amd64", voluntary},
    {"kernel-preemption", false, "preempt=full", preempt_none},
    {"clock-source", false, "tsc=reliable", slow_clock},
    {"processor-governor", false, "cpupower frequency-set -g performance",
     [](M& m) { m.put(governor, "powersave\n"); }},
    {"processor-sleep", false, "cpupower idle-set -D 100", deep_sleep},
    {"processor-quota", false, "--cpus=2",
     [](M& m) { m.put("sys/fs/cgroup/user.slice/cpu.max", "50000 100000\n"); }},
    {"processor-quota", false, "CPUQuota=200%", quota_of_version_1},
    {"processor-single", false, "two processors", one_processor},
    {"processor-load", false, "top shows them",
     [](M& m) { m.put("proc/loadavg", "9.50 3.00 1.00 9/400 4711\n"); }},
    {"memory-low", false, "smaller volume",
     [](M& m) { m.put("proc/meminfo", "MemTotal: 4000000 kB\nMemAvailable: 200000 kB\n"); }},
};

const Injection programs[] = {
    {"ticks-missed", true, "hwlatdetect", [](M& m) { m.facts.latency->report.missed = 100; }},
    {"ticks-missed", true, "a physical machine", missed_in_a_virtual_machine},
    {"ticks-late", false, "hwlatdetect",
     [](M& m) {
         m.facts.latency->report.lateness = {10'000, 1, 2, 700'000, 800'000};
     }},
    {"helper-io", true, "install Palpate again",
     [](M& m) { m.facts.programs[0].problem = "it cannot be run"; }},
    {"helper-pictures", false, "install Palpate again",
     [](M& m) { m.facts.programs[1].problem = "it is nowhere"; }},
    {"graphics-missing", false, "sudo apt install libegl1 libgl1-mesa-dri",
     [](M& m) {
         m.facts.graphics = {{}, {}, "there is no EGL", false};
     }},
    {"graphics-software", false, "firmware-amd-graphics", no_driver},
    {"graphics-permission", false, "sudo adduser $USER video", closed_card},
};

const Injection plugged[] = {
    {"device-permission", true, "ATTR{idVendor}==\"1451\"", closed_sigma},
    {"device-permission", true, "sudo adduser $USER dialout", closed_touch},
    {"device-permission", true, "log out and in again: you are in group dialout",
     touch_before_login},
    {"device-library", true, "sudo apt install libftdi1-2", falcon_without_library},
    {"device-library", true, "install the vendor's library (docs/devices/forcedimension.md)",
     omega_without_library},
    {"device-library", true, "sudo apt install libncurses5 libtinfo5",
     touch_without_terminal_libraries},
    {"device-permission", true, "ATTR{idVendor}==\"2988\", ATTR{idProduct}==\"0304\"",
     [](M& m) { m.plug("2988", "0304", "Touch", 0600); }},
    {"device-service", true, "sudo apt install spacenavd", mouse_without_service},
    {"device-permission", true,
     "SUBSYSTEM==\"hidraw\", ATTRS{idVendor}==\"2988\", ATTRS{idProduct}==\"0302\"",
     closed_hid_touch},
    {"device-port", true, "modprobe -a cdc_acm usbhid",
     [](M& m) { m.plug("2988", "0302", "Touch"); }},
    {"device-sleep", false, "echo on | sudo tee /sys/bus/usb/devices/1-2/power/control",
     sleepy_omega},
    {"device-missing", true, "docs/devices/haply.md", wanted_haply},
};

TEST(Doctor, has_nothing_to_say_about_a_healthy_machine) {
    MadeUpMachine machine;
    machine.plug("1451", "0402", "omega.x");
    for (const Fault& fault : machine.faults()) ADD_FAILURE() << fault.name << fault.meaning;
}

TEST(Doctor, needs_no_serial_port_of_a_touch_that_has_a_hidraw_node) {
    MadeUpMachine machine;
    machine.plug("2988", "0302", "Touch");
    machine.plug_hidraw(0666);
    for (const Fault& fault : machine.faults()) ADD_FAILURE() << fault.name << fault.meaning;
}

TEST(Doctor, names_each_device_that_is_plugged_in_and_has_nothing_to_say_about_it) {
    const struct {
        const char *vendor, *product, *calls_itself;
        const char *backend, *name;
        bool has_port = false;
    } devices[] = {
        {"2988", "0302", "Touch", "openhaptics", "3D Systems Touch", true},
        {"2988", "0304", "Touch", "openhaptics", "3D Systems Touch (USB)"},
        {"1451", "0402", "omega.x", "forcedimension", "Force Dimension omega"},
        {"1451", "0403", "sigma.7", "forcedimension", "Force Dimension sigma"},
        {"1451", "040c", "lambda.7", "forcedimension", "Force Dimension lambda"},
        {"1451", "0301", "haptic device", "forcedimension", "Force Dimension device"},
        {"0403", "cb48", "FALCON HAPTIC", "falcon", "Novint Falcon"},
        {"256f", "c635", "SpaceMouse Compact", "spacenav", "3Dconnexion mouse"},
    };
    for (const auto& device : devices) {
        MadeUpMachine machine;
        machine.plug(device.vendor, device.product, device.calls_itself);
        if (device.has_port) machine.plug_serial(0666);
        for (const Fault& fault : machine.faults()) ADD_FAILURE() << fault.name << fault.meaning;
        const std::vector<PluggedIn> plugged = plugged_in(machine.facts.machine.usb);
        ASSERT_EQ(plugged.size(), 1U) << device.name;
        EXPECT_EQ(plugged[0].backend, device.backend);
        EXPECT_EQ(plugged[0].name, std::string(device.name) + ", " + device.vendor + ":" +
                                       device.product + ", calls itself " + device.calls_itself);
    }
    MadeUpMachine machine;
    machine.plug("1d6b", "0002", "a hub");
    EXPECT_TRUE(plugged_in(machine.read().usb).empty());
}

class InjectedFault : public testing::TestWithParam<Injection> {};

TEST_P(InjectedFault, is_named_alone_and_with_what_mends_it) {
    MadeUpMachine machine;
    GetParam().inject(machine);
    const std::vector<Fault> faults = machine.faults();
    ASSERT_EQ(faults.size(), 1U);
    const Fault& fault = faults.front();
    EXPECT_EQ(fault.name, GetParam().fault);
    EXPECT_EQ(fault.essential, GetParam().essential);
    EXPECT_TRUE(contains(fault.remedy, GetParam().remedy)) << fault.remedy;
    for (const std::string& line : {fault.meaning, fault.remedy}) {
        EXPECT_FALSE(line.empty());
        EXPECT_FALSE(contains(line, "\n")) << line;
    }
}

INSTANTIATE_TEST_SUITE_P(RealTime, InjectedFault, testing::ValuesIn(real_time));
INSTANTIATE_TEST_SUITE_P(Kernel, InjectedFault, testing::ValuesIn(kernels));
INSTANTIATE_TEST_SUITE_P(Programs, InjectedFault, testing::ValuesIn(programs));
INSTANTIATE_TEST_SUITE_P(Devices, InjectedFault, testing::ValuesIn(plugged));

TEST(Doctor, names_essential_faults_first) {
    MadeUpMachine machine;
    machine.put(governor, "powersave\n");
    machine.facts.programs[0].problem = "it cannot be run";
    machine.facts.latency->report.missed = 500;
    std::vector<std::string> names;
    for (const Fault& fault : machine.faults()) names.push_back(fault.name);
    EXPECT_EQ(names, (std::vector<std::string>{"ticks-missed", "helper-io", "processor-governor"}));
}

TEST(Doctor, counts_a_single_hint_in_the_singular) {
    const Fault essential{.name = "a", .essential = true, .meaning = "b", .remedy = "c"};
    const Fault hint{.name = "d", .essential = false, .meaning = "e", .remedy = "f"};
    const std::string one = summary_of({}, {hint}), two = summary_of({}, {essential, hint, hint});
    EXPECT_TRUE(contains(one, "nothing essential is missing; 1 hint\n")) << one;
    EXPECT_TRUE(contains(two, "1 essential, 2 hints\n")) << two;
}

TEST(Doctor, lets_root_and_the_owner_open_a_device) {
    MadeUpMachine machine;
    machine.plug("1451", "0402", "omega.x", 0600);
    EXPECT_EQ(machine.faults().front().name, "device-permission");
    machine.facts.account.id = 0;
    EXPECT_TRUE(machine.faults().empty());
}

TEST(Doctor, bears_a_machine_whose_files_are_missing_or_senseless) {
    const support::ScratchFolder empty;
    const Machine nothing = read_machine(empty.path());
    EXPECT_EQ(nothing.processors, 0);
    EXPECT_EQ(nothing.preemption, Preemption::unknown);
    MadeUpMachine machine;
    machine.put("proc/self/cgroup", "::\n:\nx\n0::/../../../..\n");
    machine.put("proc/meminfo", "MemAvailable:");
    machine.put("etc/group", "audio\n:::\naudio:x:many:,,,\n");
    machine.put("etc/security/limits.conf", "@\n@audio -\n\xff\n");
    machine.put("proc/loadavg", "none");
    machine.plug("1451", "0402", "\x1b[31mred");
    machine.put("sys/bus/usb/devices/1-2/busnum", "-7\n");
    const Machine read = machine.read();
    ASSERT_EQ(read.usb.size(), 1U);
    EXPECT_EQ(read.usb[0].name, "[31mred");
    EXPECT_EQ(read.memory_available, 0);
}

TEST(Doctor, tells_apart_how_the_kernel_may_be_interrupted) {
    const struct {
        const char *version, *command_line, *config, *now;
        Preemption preemption;
    } cases[] = {
        {"#1 SMP PREEMPT_RT", "", "", "", Preemption::real_time},
        {"#1 SMP PREEMPT", "", "", "", Preemption::full},
        {"#1 SMP PREEMPT_DYNAMIC", "", "", "", Preemption::unknown},
        {"#1 SMP PREEMPT_DYNAMIC", "quiet preempt=full", "", "", Preemption::full},
        {"#1 SMP PREEMPT_DYNAMIC", "preempt=full", "", "(none) voluntary full", Preemption::none},
        {"#1 SMP PREEMPT_DYNAMIC", "", "CONFIG_PREEMPT_VOLUNTARY=y\n", "", Preemption::voluntary},
        {"#1 SMP PREEMPT_DYNAMIC", "", "", "full (lazy)", Preemption::full},
        {"#1 SMP", "", "CONFIG_PREEMPT_NONE=y\n", "", Preemption::none},
    };
    for (const auto& kernel : cases) {
        const MadeUpMachine machine;
        machine.put("proc/sys/kernel/version", std::string(kernel.version) + "\n");
        machine.put("proc/cmdline", std::string(kernel.command_line) + "\n");
        machine.put("boot/config-6.1.0-rt", kernel.config);
        machine.put("sys/kernel/debug/sched/preempt", kernel.now);
        EXPECT_EQ(machine.read().preemption, kernel.preemption)
            << kernel.version << kernel.command_line << kernel.config << kernel.now;
    }
}

}  // namespace
}  // namespace palpate::doctor::test
