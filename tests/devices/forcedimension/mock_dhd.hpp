// What a test tells and asks a stand-in for libdhd.so.3; it finds this by the function mock_dhd().
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "devices/stand_in.hpp"

namespace palpate::support {

struct MockDhdState {
    // The device.
    int count = 1;
    int type = 33;
    bool initialised = true;           // false: it is in RESET mode and waits for its calibration
    std::array<double, 3> position{};  // [m]
    double frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double opening = 0.5;      // [rad] of a gripper
    int opening_error = 0;     // dhdGetGripperAngleRad fails with this
    unsigned int buttons = 0;  // of a gripper: seen only while a button is emulated
    bool wrist_initialised = true;
    bool active_wrist = false;
    std::optional<bool> wrist, gripper;  // where they are not those of its type
    bool active_gripper = true;          // of a device that has one
    double limit = -1;                   // [N] dhdGetMaxForce before anybody sets one

    // How it misbehaves.
    bool refuses_open = false;
    bool refuses_force = false;  // dhdEnableForce fails
    bool refuses_emulation = false, refuses_watchdog = false;
    bool initialises = true;     // drdAutoInit
    int position_error = 0;      // dhdGetPosition fails with this
    int force_error = 0;         // dhdSetForce fails with this
    int status_count = 17;       // numbers that dhdGetStatus fills
    int status_error = 0;        // dhdGetStatus fails with this
    int position_result = 0;     // where it does not fail: 1 time guard
    int force_result = 0;        // 1 time guard, 2 motor saturated
    int orientation_error = 0;   // dhdGetOrientationFrame fails with this
    int torque_error = 0;        // dhdSetForceAndTorque(AndGripperForce) fails with this
    int force_off_cause = 0;     // the device has switched its force off
    bool tells_of_force = true;  // false: its status never says that force is on

    // Called without the lock by drdAutoInit, dhdGetPosition, drdMoveToRot, and dhdOpenID and
    // drdOpenID: time may pass there.
    std::function<void()> while_initialising, while_reading, while_centring, while_opening;

    // What it saw.
    std::array<double, 3> force{};   // [N] as applied: zero with brakes on or force off
    std::array<double, 3> torque{};  // [N m] the same; zero also while the wrist is regulated
    double gripper_force = 0;        // [N] the same
    double largest_force = 0, largest_torque = 0;
    double max_torque = -1;  // dhdSetMaxTorque
    // While it regulates the position, forces that are set have no effect.
    bool regulates_position = true, regulates_rotation = true, is_regulating = false;
    int turned_to_centre = 0;
    double max_force = -1;  // dhdSetMaxForce
    int watchdog = 17, gravity = 0;
    bool simulates = false, emulates_button = false, is_expert = false;
    bool force_on = false, brakes = true, is_open = false;
    std::vector<std::string> calls;                // but for those of the loop
    long loops = 0;                                // dhdSetForce
    int wrong_id = 0;                              // calls for another device
    std::array<double, 3> force_at_stop{1, 1, 1};  // as applied when dhdStop was called
};

using MockDhd = StandIn<MockDhdState>;

}  // namespace palpate::support

/// The stand-in's one and only.
extern "C" palpate::support::MockDhd* mock_dhd();
