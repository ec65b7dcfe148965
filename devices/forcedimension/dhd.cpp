// Finds the functions of Force Dimension's library; the table of models.
#include "devices/forcedimension/dhd.hpp"

#include <algorithm>
#include <iterator>

#include "devices/forcedimension/words.hpp"

namespace palpate::devices::forcedimension {
namespace {

// clang-format off
constexpr Model models[] = {
    // type            N  N/mm   mm         N mm
    {33,  "omega.3",  12, 5,     55, false, 0},
    {34,  "omega.6",  12, 5,     55, true,  0},
    {36,  "omega.6",  12, 5,     55, true,  0},
    {35,  "omega.7",  12, 5,     55, true,  0},
    {37,  "omega.7",  12, 5,     55, true,  0},
    {60,  "Falcon",    8, 3,     40, false, 0},
    {63,  "delta.3",  20, 5,    100, false, 0},
    {64,  "delta.6",  20, 5,    100, true,  150},
    {104, "sigma.7",  12, 4,     55, true,  400},
    {105, "sigma.7",  12, 4,     55, true,  400},
    {108, "lambda.7", 12, 4,     55, true,  150},
    {109, "lambda.7", 12, 4,     55, true,  150},
    {203, "lambda.3", 12, 4,     55, false, 0},
    {206, "sigma.3",  12, 4,     55, false, 0},
};
// clang-format on
/// For unknown models: the least that any of them can do.
constexpr Model any_model{0, "Force Dimension device", 8, 3, 40, false, 0};

}  // namespace

const Model& model_of(int system_type) {
    const auto found = std::ranges::find(models, system_type, &Model::type);
    return found == std::end(models) ? any_model : *found;
}

Dhd::Dhd(const std::string& path)
    : library(path.empty() ? library_names() : std::vector<std::string>{path}, how_to_install) {
    library.need(get_device_count, "dhdGetDeviceCount");
    library.need(dhd_open, "dhdOpenID");
    library.need(dhd_close, "dhdClose");
    library.need(stop, "dhdStop");
    library.need(enable_force, "dhdEnableForce");
    library.need(get_system_type, "dhdGetSystemType");
    library.need(get_status, "dhdGetStatus");
    library.need(get_position, "dhdGetPosition");
    library.need(get_orientation, "dhdGetOrientationFrame");
    library.need(get_buttons, "dhdGetButtonMask");
    library.need(set_force, "dhdSetForce");
    library.need(set_brakes, "dhdSetBrakes");
    library.need(set_gravity_compensation, "dhdSetGravityCompensation");
    library.need(error_get_last, "dhdErrorGetLast");
    library.need(error_get_last_text, "dhdErrorGetLastStr");
    library.take(get_system_name, "dhdGetSystemName");
    library.take(get_serial_number, "dhdGetSerialNumber");
    library.take(get_version, "dhdGetSDKVersion");
    library.take(set_max_force, "dhdSetMaxForce");
    library.take(has_active_wrist, "dhdHasActiveWrist");
    library.take(set_all, "dhdSetForceAndTorqueAndGripperForce");
    library.take(set_force_and_torque, "dhdSetForceAndTorque");
    library.take(set_max_torque, "dhdSetMaxTorque");
    library.take(set_watchdog, "dhdSetWatchdog");
    library.take(get_watchdog, "dhdGetWatchdog");
    library.take(drd_open, "drdOpenID");
    library.take(drd_close, "drdClose");
    library.take(drd_is_initialised, "drdIsInitialized");
    library.take(drd_initialise, "drdAutoInit");
    library.take(drd_start, "drdStart");
    library.take(drd_stop, "drdStop");
    library.take(drd_regulate_position, "drdRegulatePos");
    library.take(drd_regulate_rotation, "drdRegulateRot");
    library.take(drd_regulate_gripper, "drdRegulateGrip");
    library.take(drd_turn_to, "drdMoveToRot");
}

std::string Dhd::error_words() const {
    const char* words = error_get_last_text();
    return words && *words ? words : "error " + std::to_string(error_get_last());
}

}  // namespace palpate::devices::forcedimension
