// Tables of simulated devices and hands. docs/devices/simulated.md gives their sources and what is
// assumed: change both together.
#include "devices/simulated/profiles.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "devices/models.hpp"
#include "palpate/names.hpp"

namespace palpate::devices {
namespace {

/// Mechanics and electronics of a model, which data sheets rarely contain.
struct Row {
    const char* name;
    const char* model;
    double mass, damping, friction;   // kg, N s/mm, N
    double encoder_step, force_step;  // mm, N
};

/// Rows of the models that measure the orientation.
struct TurningRow {
    const char* name;
    double inertia, damping, friction;  // kg mm^2, N mm s/rad, N mm
    double degrees, torque_step;        // of a step of angle, N mm
};

// clang-format off
constexpr Row rows[] = {
    // name         model              mass   damping friction encoder force step
    {"omni",        "PHANToM Omni",     0.045, 0.5e-3, 0.26,    0.055,  0.002},
    {"touch",       "Touch",            0.045, 0.5e-3, 0.26,    0.055,  0.002},
    {"touchx",      "Touch X",          0.045, 0.5e-3, 0.06,    0.023,  0.004},
    {"omega3",      "omega.3",          0.2,   2e-3,   0.1,     0.01,   0.006},
    {"omega6",      "omega.6",          0.3,   2e-3,   0.1,     0.01,   0.006},
    {"omega7",      "omega.7",          0.35,  2e-3,   0.1,     0.01,   0.006},
    {"sigma7",      "sigma.7",          0.4,   2e-3,   0.1,     0.0015, 0.01},
    {"premium6dof", "Premium 1.5/6DOF", 0.136, 0.5e-3, 0.2,     0.03,   0.004},
    {"falcon",      "Falcon",           0.15,  2e-3,   0.4,     0.0635, 0.01},
    {"inverse3",    "Inverse3",         0.15,  0.5e-3, 0.15,    0.01,   0.005},
    {"inverse3_versegrip", "Inverse3 with VerseGrip",
                                        0.2,   0.5e-3, 0.15,    0.01,   0.005},
};
constexpr TurningRow turning_rows[] = {
    // name                inertia damping friction step   torque step
    {"omni",                2,     0.05,   1,       0.1,   0},
    {"touch",               2,     0.05,   1,       0.1,   0},
    {"touchx",              2,     0.05,   0.5,     0.02,  0},
    {"omega6",             20,     0.2,    2,       0.09,  0},
    {"omega7",             25,     0.2,    2,       0.09,  0},
    {"sigma7",             40,     0.2,    2,       0.013, 0.2},
    {"premium6dof",        20,     0.2,    2,       0.008, 0.1},
    {"inverse3_versegrip", 20,     0.05,   0,       0.1,   0},
};
// clang-format on

/// Whose servo was measured.
constexpr std::string_view uneven = "touch";

void add_rotation(DeviceProfile& profile) {
    const auto row = std::ranges::find(turning_rows, profile.name, &TurningRow::name);
    if (row == std::end(turning_rows)) return;
    profile.inertia = row->inertia;
    profile.rotational_damping = row->damping;
    profile.rotational_friction = row->friction;
    profile.angle_step = row->degrees * std::numbers::pi / 180;
    profile.torque_step = row->torque_step;
}

DeviceProfile profile_of(const Row& row) {
    const Model& model = model_named(row.model);
    const Vec3 corner = 0.5 * Vec3(model.width, model.height, model.depth);
    DeviceProfile profile;
    profile.name = row.name;
    profile.model = row.model;
    profile.mass = row.mass;
    profile.damping = row.damping;
    profile.friction = row.friction;
    profile.encoder_step = row.encoder_step;
    profile.maximum_force = model.force;
    profile.force_step = row.force_step;
    profile.delay = 1e-3 * model.delay;
    profile.continuous_force = model.continuous;
    profile.stiffness = model.stiffness;
    profile.jitter = profile.name == uneven;
    profile.has_orientation = model.has_wrist;
    profile.maximum_torque = model.torque;
    profile.workspace_low = -corner;
    profile.workspace_high = corner;
    add_rotation(profile);
    return profile;
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
        // For rotation, the same mass, damper and spring act at a lever of 20 mm.
        {"light",
         {.mass = 0.05,
          .damping = 2e-3,
          .stiffness = 0.1,
          .inertia = 20,
          .rotational_damping = 0.8,
          .rotational_stiffness = 40}},
        {"normal",
         {.mass = 0.1,
          .damping = 5e-3,
          .stiffness = 0.3,
          .inertia = 40,
          .rotational_damping = 2,
          .rotational_stiffness = 120}},
        {"firm",
         {.mass = 0.2,
          .damping = 12e-3,
          .stiffness = 0.8,
          .inertia = 80,
          .rotational_damping = 4.8,
          .rotational_stiffness = 320}},
    };
    return all;
}

[[noreturn]] void unknown(const char* what, std::string_view name,
                          const std::vector<std::string>& accepted) {
    throw std::invalid_argument("there is no " + std::string(what) + " '" + std::string(name) +
                                "': " + use_one_of(accepted, name));
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
