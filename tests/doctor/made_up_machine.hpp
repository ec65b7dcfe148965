// A machine made of files in a scratch folder: healthy, until a test changes something.
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "doctor/faults.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::doctor::test {

class MadeUpMachine {
  public:
    MadeUpMachine() {
        put("proc/sys/kernel/osrelease", "6.1.0-rt\n");
        put("proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian 6.1.1 (2024-01-01)\n");
        put("proc/cmdline", "BOOT_IMAGE=/boot/vmlinuz root=/dev/sda1 quiet\n");
        put("proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu tsc constant_tsc\n");
        put("proc/loadavg", "0.20 0.10 0.05 1/300 4000\n");
        put("proc/meminfo", "MemTotal: 16000000 kB\nMemAvailable:   12000000 kB\n");
        put("proc/self/cgroup", "0::/user.slice/session.scope\n");
        put("sys/fs/cgroup/user.slice/cpu.max", "max 100000\n");
        put("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
        put("proc/sys/kernel/sched_rt_period_us", "1000000\n");
        put("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
        for (const std::string cpu : {"cpu0", "cpu1", "cpu2", "cpu3"}) {
            const std::string folder = "sys/devices/system/cpu/" + cpu;
            put(folder + "/cpufreq/scaling_governor", "performance\n");
            put(folder + "/cpuidle/state0/name", "POLL\n");
            put(folder + "/cpuidle/state0/latency", "0\n");
            put(folder + "/cpuidle/state1/name", "C1\n");
            put(folder + "/cpuidle/state1/latency", "2\n");
        }
        put("etc/security/limits.d/palpate.conf",
            "@audio - rtprio 90\n@audio - memlock unlimited\n");
        put("etc/group", "root:x:0:\naudio:x:29:anna\ndialout:x:20:\nrender:x:105:anna\n");

        facts.limits = {90, Limits::unlimited, Limits::unlimited, 0, 0, 1, 1};
        facts.account = {1000, "anna", {1000, 29, 105}};
        for (const char* name :
             {"palpate-io-helper", "palpate-picture-helper", "palpate-explicit-helper"}) {
            facts.programs.push_back({name, std::string("/usr/libexec/palpate/") + name, {}});
        }
        facts.graphics = {"llvmpipe (LLVM 15.0.6)", "AMD Radeon RX 6600", {}, true};
        facts.devices = {{"simulated", true, "computed", {}, {}},
                         {"haply", true, "Inverse3", {}, {}},
                         {"openhaptics", true, "libHD.so", {}, {}},
                         {"forcedimension", true, "omega.7", {}, {}},
                         {"spacenav", true, "spacenavd", {}, {}}};
        Latency latency;
        latency.seconds = 10;
        latency.report.ticks = 10'000;
        latency.report.lateness = {10'000, 4'000, 9'000, 15'000, 40'000};
        facts.latency = latency;
    }

    void put(const std::string& name, const std::string& bytes) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        support::put_bytes(folder_ / name, bytes);
    }
    void remove(const std::string& name) const { std::filesystem::remove_all(folder_ / name); }

    /// Plugs a device in, with a node below /dev/bus/usb of this mode.
    void plug(const std::string& vendor, const std::string& product, const std::string& name,
              unsigned mode = 0666) const {
        const std::string folder = "sys/bus/usb/devices/1-2/";
        put(folder + "idVendor", vendor + "\n");
        put(folder + "idProduct", product + "\n");
        put(folder + "product", name + "\n");
        put(folder + "busnum", "1\n");
        put(folder + "devnum", "7\n");
        put(folder + "power/control", "on\n");
        put("sys/bus/usb/devices/1-2:1.0/bInterfaceClass", "03\n");
        node("dev/bus/usb/001/007", mode);
    }
    /// Its serial port.
    void plug_serial(unsigned mode) const {
        std::filesystem::create_directories(folder_ / "sys/bus/usb/devices/1-2:1.0/tty/ttyACM0");
        node("dev/ttyACM0", mode);
    }
    /// Its node as a human interface device.
    void plug_hidraw(unsigned mode) const {
        std::filesystem::create_directories(
            folder_ / "sys/bus/usb/devices/1-2:1.0/0003:2988:0302.0001/hidraw/hidraw0");
        node("dev/hidraw0", mode);
    }
    void node(const std::string& name, unsigned mode) const {
        put(name, "");
        ::chmod((folder_ / name).c_str(), mode);
    }

    /// Of a device for which nothing answers.
    void not_found(const std::string& name, const std::string& why) {
        for (devices::DeviceFinding& device : facts.devices) {
            if (device.name == name) device = {name, false, {}, why, {}};
        }
    }

    Machine read() const { return read_machine(folder_.path()); }
    std::vector<Fault> faults() {
        facts.machine = read();
        // The files belong to whoever runs the test; the person is somebody else.
        for (UsbDevice& usb : facts.machine.usb) disown(usb.node);
        for (UsbDevice& usb : facts.machine.usb) {
            for (Node& port : usb.ports) disown(port);
        }
        for (Node& card : facts.machine.render_nodes) disown(card);
        return faults_of(facts);
    }

    Facts facts;
    unsigned node_group = 0;  ///< of every node, in place of the test's own

  private:
    void disown(Node& node) const {
        node.owner = 0;
        node.group = node_group;
    }

    support::ScratchFolder folder_;
};

}  // namespace palpate::doctor::test
