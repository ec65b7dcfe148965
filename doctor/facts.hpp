// The facts that `palpate doctor` collects about a machine: plain values, collected by survey() and
// judged by faults_of(). Tests fill them in from a folder of their own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "doctor/latency.hpp"
#include "palpate/devices/backend.hpp"
#include "palpate/progress.hpp"

namespace palpate::doctor {

/// Where the kernel lets a thread interrupt another one that is inside the kernel.
enum class Preemption : std::uint8_t { unknown, none, voluntary, full, real_time };
const char* name_of(Preemption preemption);

/// A file below /dev, and who may open it.
struct Node {
    std::string path;  ///< as the person would write it: /dev/bus/usb/001/004
    unsigned mode = 0;
    unsigned owner = 0, group = 0;
    bool opens = false;  ///< this process can read and write it, by a rule of whatever kind
};

struct UsbDevice {
    std::string vendor, product;  ///< four hexadecimal digits each, lower case
    std::string name;             ///< as the device calls itself
    std::string folder;           ///< of its settings: /sys/bus/usb/devices/1-2
    Node node;                    ///< below /dev/bus/usb
    std::vector<Node> ports;      ///< /dev/ttyACM0, /dev/hidraw0 and the like
    bool may_sleep = false;       ///< the kernel may switch it off while it is not used
};

/// A sleeping state that the kernel may put a processor into.
struct IdleState {
    std::string name;
    double exit_us = 0;  ///< until it works again
};

/// A line of /etc/security/limits.conf or limits.d.
struct LimitLine {
    std::string domain;  ///< "@audio", "anna", "*"
    std::string item;    ///< "rtprio", "memlock"
    std::string value;
};

/// What the files below /proc, /sys, /dev and /etc say.
struct Machine {
    std::string release, version, command_line;  ///< of the kernel
    Preemption preemption = Preemption::unknown;
    bool preemption_can_be_chosen = false;  ///< when it boots
    bool is_virtual = false;
    int processors = 0;
    double load = 0;              ///< threads that wanted to run, mean of a minute
    double memory_available = 0;  ///< [bytes]
    std::string clock_source;
    std::vector<std::string> governors;  ///< of the processors' frequency, each once
    std::vector<IdleState> idle_states;  ///< those in use
    /// Part of the time that real-time threads may use; 1: all.
    double real_time_share = 1;
    /// A control group's limit [processors]; nothing: none.
    std::optional<double> processor_quota;
    /// A control group grants real-time threads no time at all.
    bool real_time_forbidden = false;
    std::vector<LimitLine> limit_lines;
    std::map<std::string, std::vector<std::string>> members;  ///< of each group
    std::map<unsigned, std::string> group_names;
    std::vector<UsbDevice> usb;
    bool has_graphics_card = false;
    std::vector<Node> render_nodes;  ///< /dev/dri/renderD128 ...
};

/// Reads a machine's files below `root` ("/", or a test's folder). Never throws for a file that is
/// missing or makes no sense: its value stays as it is by default.
Machine read_machine(const std::filesystem::path& root);

/// What the kernel grants this process.
struct Limits {
    static constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

    std::uint64_t priority = 0;              ///< highest real-time priority (RLIMIT_RTPRIO)
    std::uint64_t real_time_us = unlimited;  ///< without sleeping (RLIMIT_RTTIME)
    std::uint64_t locked_bytes = 0;          ///< RLIMIT_MEMLOCK
    int priority_error = 0;                  ///< of asking for SCHED_FIFO; 0: granted
    int lock_error = 0;                      ///< of locking a gigabyte; 0: granted
    double timer_resolution_ns = 1;
    double timer_slack_ns = 1;  ///< of a thread that asked for 1 ns
};
/// Asks for each and gives it back.
Limits read_limits();

/// Whose session it is.
struct Account {
    unsigned id = 0;
    std::string name;
    std::vector<unsigned> groups;  ///< of this login
};
Account read_account();

/// A program that Palpate starts.
struct Program {
    std::string name;
    std::string path;     ///< empty: not found
    std::string problem;  ///< why it cannot be used; empty: it can
};

/// OpenGL without a display.
struct Graphics {
    std::string pictures;      ///< the renderer that draws pictures; empty: there is none
    std::string machine;       ///< the one that the graphics card's driver offers
    std::string problem;       ///< why there are no pictures
    bool has_display = false;  ///< a screen for the viewer
};

struct Facts {
    Machine machine;
    Limits limits;
    Account account;
    std::vector<Program> programs;
    Graphics graphics;
    std::vector<devices::DeviceFinding> devices;
    std::string wanted_device;  ///< that has to work; empty: any
    std::optional<Latency> latency;
};

/// This machine, but for the latency. Takes a few seconds: helpers are started and devices are
/// looked for. Moves nothing. Throws std::invalid_argument for a device that there is not.
Facts survey(const std::string& wanted_device, const OnProgress& progress = {});

}  // namespace palpate::doctor
