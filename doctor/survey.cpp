// Gathers the facts of this machine: asks the kernel, starts the helpers, looks for the devices.
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <thread>

#include "doctor/facts.hpp"
#include "io/process/helper_folders.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/names.hpp"
#include "pictures/picture.hpp"

namespace palpate::doctor {
namespace {

namespace fs = std::filesystem;

constexpr int servo_priority = 80;
/// Address space of about a session with a large volume.
constexpr std::size_t session_bytes = std::size_t{1} << 30;

std::uint64_t limit_of(int what) {
    rlimit limit{};
    if (getrlimit(static_cast<__rlimit_resource>(what), &limit) != 0) return 0;
    return limit.rlim_cur == RLIM_INFINITY ? Limits::unlimited : limit.rlim_cur;
}

/// On a thread that ends at once, so that nothing of this stays.
void ask_as_a_thread(Limits& limits) {
    std::thread([&limits] {
        sched_param parameter{};
        parameter.sched_priority = servo_priority;
        limits.priority_error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
        const sched_param usual{};
        pthread_setschedparam(pthread_self(), SCHED_OTHER, &usual);
        prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
        const int slack = prctl(PR_GET_TIMERSLACK, 0UL, 0UL, 0UL, 0UL);
        limits.timer_slack_ns = slack < 0 ? 50'000 : slack;
    }).join();
}

/// As many addresses as a session has are asked for, but no memory: MCL_ONFAULT fills none.
int error_of_locking() {
    void* const room = mmap(nullptr, session_bytes, PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room == MAP_FAILED) return errno;
    const int error = mlockall(MCL_CURRENT | MCL_ONFAULT) == 0 ? 0 : errno;
    munlockall();
    munmap(room, session_bytes);
    return error;
}

std::string path_of(const std::string& name, const char* variable) {
    const char* const set = std::getenv(variable);
    if (set) return set;
    for (const fs::path& folder : io::helper_folders()) {
        if (access((folder / name).c_str(), X_OK) == 0) return (folder / name).string();
    }
    return {};
}

Program program_named(const std::string& name, const char* variable) {
    Program program{name, path_of(name, variable), {}};
    if (program.path.empty()) {
        program.problem = "it is in none of the folders in which Palpate looks";
    } else if (access(program.path.c_str(), X_OK) != 0) {
        program.problem = "it cannot be run";
    }
    return program;
}

/// Reads the volume that comes with Palpate, and has the programs that know other formats.
Program reader() {
    Program program = program_named("palpate-io-helper", "PALPATE_IO_HELPER");
    if (!program.problem.empty()) return program;
    try {
        io::read_volume(io::sample_volume_path());
        const fs::path folder = fs::canonical(program.path).parent_path();
        for (const char* name :
             {"palpate-io-itk", "palpate-io-images", "palpate-io-vtk", "palpate-io-dicom"}) {
            if (access((folder / name).c_str(), X_OK) == 0) continue;
            program.problem = std::string(name) + " is missing in its folder or cannot be run";
        }
    } catch (const std::exception& e) {
        program.problem = e.what();
    }
    return program;
}

Graphics graphics() {
    Graphics graphics;
    pictures::DrawOptions options;
    options.time_limit_s = 30;
    try {
        graphics.pictures = pictures::renderer_name(false, options);
    } catch (const io::OutputError& e) {
        graphics.problem = e.what();
    }
    try {
        graphics.machine = pictures::renderer_name(true, options);
    } catch (const io::OutputError&) {  // then there is none but the processor
    }
    const auto set = [](const char* name) {
        const char* const value = std::getenv(name);
        return value != nullptr && *value != '\0';
    };
    graphics.has_display = set("DISPLAY") || set("WAYLAND_DISPLAY");
    return graphics;
}

}  // namespace

Limits read_limits() {
    Limits limits;
    limits.priority = limit_of(RLIMIT_RTPRIO);
    limits.real_time_us = limit_of(RLIMIT_RTTIME);
    limits.locked_bytes = limit_of(RLIMIT_MEMLOCK);
    ask_as_a_thread(limits);
    limits.lock_error = error_of_locking();
    timespec resolution{};
    clock_getres(CLOCK_MONOTONIC, &resolution);
    limits.timer_resolution_ns =
        1e9 * static_cast<double>(resolution.tv_sec) + static_cast<double>(resolution.tv_nsec);
    return limits;
}

Account read_account() {
    Account account;
    account.id = geteuid();
    const char* const name = std::getenv("USER");
    account.name = name ? name : "";
    const int count = getgroups(0, nullptr);
    account.groups.resize(static_cast<std::size_t>(count > 0 ? count : 0));
    if (count > 0) getgroups(count, account.groups.data());
    account.groups.push_back(getegid());
    return account;
}

Facts survey(const std::string& wanted_device, const OnProgress& progress) {
    Facts facts;
    facts.machine = read_machine("/");
    facts.limits = read_limits();
    facts.account = read_account();
    facts.wanted_device = wanted_device;
    facts.devices = devices::find_devices(progress);
    const std::vector<std::string> names = devices::device_names();
    if (!wanted_device.empty() && std::ranges::find(names, wanted_device) == names.end()) {
        throw std::invalid_argument("there is no device '" + wanted_device +
                                    "': " + use_one_of(names, wanted_device));
    }
    facts.programs = {reader(), program_named("palpate-picture-helper", "PALPATE_PICTURE_HELPER"),
                      program_named("palpate-explicit-helper", "PALPATE_EXPLICIT_HELPER")};
    facts.graphics = graphics();
    return facts;
}

}  // namespace palpate::doctor
