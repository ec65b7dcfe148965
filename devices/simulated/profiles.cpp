// Tables of simulated devices and hands. docs/devices/simulated.md gives their sources and what is
// assumed: change both together.
#include "devices/simulated/profiles.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace palpate::devices {
namespace {

struct Row {
    const char* name;
    const char* model;
    double mass, damping, friction;                  // kg, N s/mm, N
    double encoder_step, maximum_force, force_step;  // mm, N, N
    double delay, stiffness;                         // s, N/mm
    double width, height, depth;                     // mm, round the origin
};

// clang-format off
constexpr Row rows[] = {
    // name      model           mass   damping friction encoder force step  delay    stiffness  box
    {"omni",     "PHANToM Omni", 0.045, 0.5e-3, 0.26, 0.055,  3.3,  0.002, 0.5e-3,  0.7,  160, 120,  70},
    {"touch",    "Touch",        0.045, 0.5e-3, 0.26, 0.055,  3.3,  0.002, 1e-3,    0.4,  160, 120,  70},
    {"touchx",   "Touch X",      0.045, 0.5e-3, 0.06, 0.023,  7.9,  0.004, 1e-3,    1.48, 160, 120, 120},
    {"omega3",   "omega.3",      0.2,   2e-3,   0.1,  0.01,   12,   0.006, 0.25e-3, 5,    110, 110, 110},
    {"falcon",   "Falcon",       0.15,  2e-3,   0.4,  0.0635, 8,    0.01,  1e-3,    3,     80,  80,  80},
    {"inverse3", "Inverse3",     0.15,  0.5e-3, 0.15, 0.01,   10,   0.005, 1e-3,    1,    170, 170, 170},
};
// clang-format on

DeviceProfile profile_of(const Row& row) {
    const Vec3 corner = 0.5 * Vec3(row.width, row.height, row.depth);
    return {.name = row.name,
            .model = row.model,
            .mass = row.mass,
            .damping = row.damping,
            .friction = row.friction,
            .encoder_step = row.encoder_step,
            .maximum_force = row.maximum_force,
            .force_step = row.force_step,
            .delay = row.delay,
            .stiffness = row.stiffness,
            .workspace_low = -corner,
            .workspace_high = corner};
}

const std::vector<DeviceProfile>& profiles() {
    static const std::vector<DeviceProfile> all = [] {
        std::vector<DeviceProfile> made;
        for (const Row& row : rows) made.push_back(profile_of(row));
        return made;
    }();
    return all;
}

const std::vector<std::pair<std::string, HandGrip>>& grips() {
    static const std::vector<std::pair<std::string, HandGrip>> all{
        {"light", {.mass = 0.05, .damping = 2e-3, .stiffness = 0.1}},
        {"normal", {.mass = 0.1, .damping = 5e-3, .stiffness = 0.3}},
        {"firm", {.mass = 0.2, .damping = 12e-3, .stiffness = 0.8}},
    };
    return all;
}

[[noreturn]] void unknown(const char* what, std::string_view name,
                          const std::vector<std::string>& accepted) {
    std::string message =
        "there is no " + std::string(what) + " '" + std::string(name) + "'; there are:";
    for (const std::string& one : accepted) message += " " + one;
    throw std::invalid_argument(message);
}

}  // namespace

const std::vector<std::string>& profile_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const DeviceProfile& one : profiles()) all.push_back(one.name);
        return all;
    }();
    return names;
}

const DeviceProfile& profile(std::string_view name) {
    const auto found = std::ranges::find(profiles(), name, &DeviceProfile::name);
    if (found == profiles().end()) unknown("device profile", name, profile_names());
    return *found;
}

const std::vector<std::string>& grip_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const auto& one : grips()) all.push_back(one.first);
        return all;
    }();
    return names;
}

const HandGrip& grip(std::string_view name) {
    const auto found = std::ranges::find(grips(), name, &std::pair<std::string, HandGrip>::first);
    if (found == grips().end()) unknown("grip", name, grip_names());
    return found->second;
}

}  // namespace palpate::devices
