// Finds the functions of Force Dimension's library, and the abilities of its devices.
#include "devices/forcedimension/dhd.hpp"

#include <algorithm>
#include <iterator>

namespace palpate::devices::forcedimension {
namespace {

struct Type {
    int number;
    const char* model;
    double centre_right = 0, centre_near = 0;  ///< [mm] of the workspace
};

/// Numbers of dhdGetSystemType(). Those that the vendor no longer sells are in CHAI3D's driver. So
/// are the centres, as the offsets that it adds to a position, which are the other way round.
constexpr Type types[] = {
    {31, "delta.3"},           {32, "omega.3"},          {33, "omega.3"},
    {34, "omega.6"},           {36, "omega.6"},          {35, "omega.7"},
    {37, "omega.7"},           {60, "Falcon"},           {61, "delta.6"},
    {62, "delta.6"},           {63, "delta.3"},          {64, "delta.6"},
    {104, "sigma.7", -20, 10}, {105, "sigma.7", 20, 10}, {106, "sigma.6+", -20, 10},
    {107, "sigma.6+", 20, 10}, {108, "lambda.7"},        {109, "lambda.7"},
    {131, "lambda.6"},         {132, "lambda.6"},        {203, "lambda.3"},
    {206, "sigma.3"},
};
constexpr int falcon = 60;

/// The force on the gripper counts upwards where it opens one for the right hand, and downwards for
/// the left hand (CHAI3D's driver).
constexpr int right_grippers[] = {35, 104, 108}, left_grippers[] = {37, 105, 109};

double sign_that_opens(const Dhd& dhd, int number, bool has_torque, char id) {
    if (!dhd.has_active_gripper || !dhd.has_active_gripper(id) || !dhd.get_gripper_angle) return 0;
    if (has_torque ? !dhd.set_all : !dhd.set_force_and_gripper) return 0;
    if (std::ranges::count(right_grippers, number) > 0) return 1;
    return std::ranges::count(left_grippers, number) > 0 ? -1 : 0;
}

}  // namespace

Arm arm_of(const Dhd& dhd, char id) {
    const int number = dhd.get_system_type(id);
    const auto* const type = std::ranges::find(types, number, &Type::number);
    const bool is_known = type != std::end(types);
    Arm arm{model_named(is_known ? type->model : "Force Dimension device")};
    if (is_known) arm.centre = Vec3(type->centre_right, 0, type->centre_near);
    arm.has_button_row = number == falcon;

    Model& model = arm.model;
    if (dhd.has_wrist) model.has_wrist = dhd.has_wrist(id);
    if (dhd.has_gripper) model.has_gripper = dhd.has_gripper(id);
    const bool is_active = dhd.has_active_wrist ? dhd.has_active_wrist(id) : is_known;
    if (!model.has_wrist || !is_active || !dhd.has_torque()) model.torque = 0;
    arm.opens = sign_that_opens(dhd, number, model.torque > 0, id);
    const double limit = dhd.get_max_force ? dhd.get_max_force(id) : -1;
    if (limit > 0) model.force = is_known ? std::min(model.force, limit) : std::min(limit, 20.);
    model.continuous = std::min(model.continuous, model.force);
    return arm;
}

Dhd::Dhd(const std::string& path) : library(path, words()) {
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
    library.take(enable_simulator, "dhdEnableSimulator");
    library.take(get_system_name, "dhdGetSystemName");
    library.take(get_serial_number, "dhdGetSerialNumber");
    library.take(get_version, "dhdGetSDKVersion");
    library.take(set_max_force, "dhdSetMaxForce");
    library.take(has_wrist, "dhdHasWrist");
    library.take(has_active_wrist, "dhdHasActiveWrist");
    library.take(has_gripper, "dhdHasGripper");
    library.take(has_active_gripper, "dhdHasActiveGripper");
    library.take(get_gripper_angle, "dhdGetGripperAngleRad");
    library.take(get_max_force, "dhdGetMaxForce");
    library.take(emulate_button, "dhdEmulateButton");
    library.take(enable_expert_mode, "dhdEnableExpertMode");
    library.take(disable_expert_mode, "dhdDisableExpertMode");
    library.take(set_all, "dhdSetForceAndTorqueAndGripperForce");
    library.take(set_force_and_gripper, "dhdSetForceAndGripperForce");
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
