// Reads the kernel's files about a machine. Linux.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <sstream>

#include "doctor/facts.hpp"
#include "doctor/usb.hpp"

namespace palpate::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest = 1 << 20;  // bytes of a file that are read

/// Returns an empty text if the file cannot be read.
std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text(longest, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    return text;
}

std::string line_of(const fs::path& path) {
    const std::string text = text_of(path);
    return text.substr(0, text.find('\n'));
}

std::optional<double> number_of(const fs::path& path) {
    std::istringstream in(text_of(path));
    double number = 0;
    return in >> number ? std::optional(number) : std::nullopt;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Sorted, so that the same folder always reads the same; nothing of a folder that is not there.
std::vector<fs::path> entries_of(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> entries;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        entries.push_back(i->path());
    }
    std::ranges::sort(entries);
    return entries;
}

bool is_numbered(const std::string& name, const std::string& begin) {
    return name.size() > begin.size() && name.rfind(begin, 0) == 0 &&
           std::all_of(name.begin() + static_cast<long>(begin.size()), name.end(),
                       [](unsigned char c) { return std::isdigit(c) != 0; });
}

Preemption preemption_named(const std::string& word) {
    if (word == "none") return Preemption::none;
    if (word == "voluntary") return Preemption::voluntary;
    // Lazy preempts for real-time threads as full does.
    if (word == "full" || word == "lazy") return Preemption::full;
    return Preemption::unknown;
}

/// "preempt=full" of the command line, if it is there.
std::string boot_option(const std::string& command_line, const std::string& name) {
    std::istringstream in(command_line);
    std::string found;
    for (std::string word; in >> word;) {
        if (word.rfind(name + "=", 0) == 0) found = word.substr(name.size() + 1);
    }
    return found;
}

/// As the kernel was built: the default of one that can choose.
Preemption built_in(const std::string& config) {
    const auto set = [&](const char* name) {
        return contains("\n" + config, std::string("\nCONFIG_") + name + "=y\n");
    };
    if (set("PREEMPT_RT")) return Preemption::real_time;
    if (set("PREEMPT") || set("PREEMPT_LAZY")) return Preemption::full;
    if (set("PREEMPT_VOLUNTARY")) return Preemption::voluntary;
    if (set("PREEMPT_NONE")) return Preemption::none;
    return Preemption::unknown;
}

/// "none voluntary (full)"
Preemption chosen_now(const std::string& choices) {
    const auto open = choices.find('('), close = choices.find(')');
    if (open == std::string::npos || close == std::string::npos || close < open) {
        return Preemption::unknown;
    }
    return preemption_named(choices.substr(open + 1, close - open - 1));
}

void read_kernel(const fs::path& root, Machine& machine) {
    machine.release = line_of(root / "proc/sys/kernel/osrelease");
    machine.version = line_of(root / "proc/sys/kernel/version");
    machine.command_line = line_of(root / "proc/cmdline");
    machine.preemption_can_be_chosen = contains(machine.version, "PREEMPT_DYNAMIC");
    if (line_of(root / "sys/kernel/realtime") == "1" || contains(machine.version, "PREEMPT_RT")) {
        machine.preemption = Preemption::real_time;
        return;
    }
    if (contains(machine.version, "PREEMPT") && !machine.preemption_can_be_chosen) {
        machine.preemption = Preemption::full;
        return;
    }
    for (const Preemption said :
         {chosen_now(line_of(root / "sys/kernel/debug/sched/preempt")),
          preemption_named(boot_option(machine.command_line, "preempt")),
          built_in(text_of(root / "boot" / ("config-" + machine.release)))}) {
        if (said == Preemption::unknown) continue;
        machine.preemption = said;
        return;
    }
}

void read_idle_states(const fs::path& processor, Machine& machine) {
    for (const fs::path& state : entries_of(processor / "cpuidle")) {
        if (!is_numbered(state.filename().string(), "state")) continue;
        if (number_of(state / "disable").value_or(0) != 0) continue;
        const std::string name = line_of(state / "name");
        const double exit_us = number_of(state / "latency").value_or(0);
        const bool known = std::ranges::any_of(
            machine.idle_states, [&](const IdleState& other) { return other.name == name; });
        if (!known) machine.idle_states.push_back({name, exit_us});
    }
}

void read_processors(const fs::path& root, Machine& machine) {
    for (const fs::path& processor : entries_of(root / "sys/devices/system/cpu")) {
        if (!is_numbered(processor.filename().string(), "cpu")) continue;
        if (number_of(processor / "online").value_or(1) == 0) continue;
        ++machine.processors;
        const std::string governor = line_of(processor / "cpufreq/scaling_governor");
        if (!governor.empty() && std::ranges::count(machine.governors, governor) == 0) {
            machine.governors.push_back(governor);
        }
        read_idle_states(processor, machine);
    }
    const std::string cpuinfo = text_of(root / "proc/cpuinfo");
    machine.is_virtual = contains(cpuinfo, " hypervisor");
    machine.load = number_of(root / "proc/loadavg").value_or(0);
    machine.clock_source =
        line_of(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
    const std::string memory = text_of(root / "proc/meminfo");
    const auto at = memory.find("MemAvailable:");
    if (at == std::string::npos) return;
    std::istringstream in(memory.substr(at + 13));
    double kilobytes = 0;
    if (in >> kilobytes) machine.memory_available = kilobytes * 1024;
}

/// The folder of this process and those above it, up to that of the whole machine.
std::vector<fs::path> group_folders(const fs::path& top, const fs::path& own) {
    std::vector<fs::path> folders;
    fs::path folder = own.relative_path();
    for (; !folder.empty(); folder = folder.parent_path()) folders.push_back(top / folder);
    folders.push_back(top);
    return folders;
}

void limit_to(double quota, double period, Machine& machine) {
    if (!(quota > 0) || !(period > 0)) return;
    machine.processor_quota =
        std::min(machine.processor_quota.value_or(quota / period), quota / period);
}

/// Lines of /proc/self/cgroup: "0::/user.slice" (version 2), "3:cpu,cpuacct:/" (version 1).
void read_control_groups(const fs::path& root, Machine& machine) {
    std::istringstream lines(text_of(root / "proc/self/cgroup"));
    for (std::string line; std::getline(lines, line);) {
        const auto first = line.find(':');
        const auto second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const fs::path own = line.substr(second + 1);
        if (controllers == ",,") {
            for (const fs::path& folder : group_folders(root / "sys/fs/cgroup", own)) {
                std::istringstream in(line_of(folder / "cpu.max"));
                double quota = 0, period = 0;  // "max" is no number: no limit
                if (in >> quota >> period) limit_to(quota, period, machine);
            }
        } else if (contains(controllers, ",cpu,")) {
            for (const fs::path& folder : group_folders(root / "sys/fs/cgroup/cpu", own)) {
                limit_to(number_of(folder / "cpu.cfs_quota_us").value_or(-1),
                         number_of(folder / "cpu.cfs_period_us").value_or(-1), machine);
            }
            const fs::path share = root / "sys/fs/cgroup/cpu" / own.relative_path();
            machine.real_time_forbidden = number_of(share / "cpu.rt_runtime_us").value_or(1) == 0;
        }
    }
}

void read_real_time(const fs::path& root, Machine& machine) {
    const double runtime = number_of(root / "proc/sys/kernel/sched_rt_runtime_us").value_or(-1);
    const double period = number_of(root / "proc/sys/kernel/sched_rt_period_us").value_or(1e6);
    machine.real_time_share = runtime < 0 || !(period > 0) ? 1 : std::min(1.0, runtime / period);
    read_control_groups(root, machine);
    std::vector<fs::path> files = entries_of(root / "etc/security/limits.d");
    files.insert(files.begin(), root / "etc/security/limits.conf");
    for (const fs::path& file : files) {
        std::istringstream lines(text_of(file));
        for (std::string line; std::getline(lines, line);) {
            std::istringstream in(line.substr(0, line.find('#')));
            LimitLine limit;
            std::string type;
            if (in >> limit.domain >> type >> limit.item >> limit.value) {
                machine.limit_lines.push_back(limit);
            }
        }
    }
}

/// Lines "audio:x:29:anna,ben" of /etc/group.
void read_groups(const fs::path& root, Machine& machine) {
    std::istringstream lines(text_of(root / "etc/group"));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream in(line);
        std::string name, password, number, people;
        if (!std::getline(in, name, ':') || !std::getline(in, password, ':') ||
            !std::getline(in, number, ':')) {
            continue;
        }
        std::getline(in, people);
        const auto id = static_cast<unsigned>(std::strtoul(number.c_str(), nullptr, 10));
        machine.group_names.emplace(id, name);
        std::vector<std::string>& members = machine.members[name];
        std::istringstream list(people);
        for (std::string one; std::getline(list, one, ',');) members.push_back(one);
    }
}

void read_graphics(const fs::path& root, Machine& machine) {
    for (const fs::path& card : entries_of(root / "sys/class/drm")) {
        machine.has_graphics_card |= is_numbered(card.filename().string(), "card");
    }
    for (const fs::path& node : entries_of(root / "dev/dri")) {
        if (!is_numbered(node.filename().string(), "renderD")) continue;
        machine.render_nodes.push_back(node_at(root, "/dev/dri/" + node.filename().string()));
    }
}

}  // namespace

const char* name_of(Preemption preemption) {
    switch (preemption) {
        case Preemption::none:
            return "none";
        case Preemption::voluntary:
            return "voluntary";
        case Preemption::full:
            return "full";
        case Preemption::real_time:
            return "real-time";
        case Preemption::unknown:
            break;
    }
    return "unknown";
}

Machine read_machine(const fs::path& root) {
    Machine machine;
    read_kernel(root, machine);
    read_processors(root, machine);
    read_real_time(root, machine);
    read_groups(root, machine);
    read_graphics(root, machine);
    machine.usb = read_usb(root);
    return machine;
}

}  // namespace palpate::doctor
