// What a test tells and asks the stand-in for libHD.so; it finds this by the function mock_hd().
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "devices/stand_in.hpp"

namespace palpate::support {

struct MockHdState {
    // The device.
    std::array<double, 3> position{};  // [mm]
    std::array<double, 16> transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    int buttons = 0;
    double most_force = 3.3, continuous_force = 0.88, stiffness = 0.7;
    double temperature = 0;  // of its second motor; below 0: it tells none
    std::array<double, 6> workspace{-80, -60, -35, 80, 60, 35};
    int rate = 1000;
    int input_dof = 6, output_dof = 3;
    double most_torque = 170;  // [mN m]
    unsigned int calibration = 0x5000;
    int calibration_style = 4;

    // How it misbehaves.
    bool refuses_null = false;  // hdInitDevice(NULL) fails
    std::string only_name = "Default PHANToM";
    bool has_no_licence = false;
    bool refuses_all = false;      // and so does any name
    bool refuses_start = false;    // hdStartScheduler
    bool update_helps = true;      // hdUpdateCalibration
    unsigned int every_error = 0;  // reported by every frame
    // Those that end the servo loop (0x304, 0x500, 0x501) end it.
    unsigned int next_error = 0;         // reported by the next frame
    unsigned int torque_error = 0;       // reported by every call that sets a torque
    unsigned int temperature_error = 0;  // reported by every call that asks for it
    bool silent = false;                 // the servo loop calls nobody
    bool no_position = false;            // hdGetDoublev(position) tells nothing
    // Called without the lock by hdBeginFrame and hdInitDevice.
    std::function<void()> while_beginning, while_opening;
    bool own_thread = false;  // its servo loop runs by itself; otherwise by mock_hd_frame()

    // What it saw.
    std::array<double, 3> force{};   // as applied: the last frame's, zero without force output
    std::array<double, 3> torque{};  // [mN m] the same
    double largest_force = 0;        // since the last clear
    double largest_torque = 0;
    std::vector<std::string> calls;  // but for those in frames
    long frames = 0;
    std::array<double, 3> force_at_stop{1, 1, 1};  // as applied when the scheduler was stopped
    bool device_open = false;
    int outside = 0;                   // calls that want a frame, without one
    std::vector<unsigned int> errors;  // not asked for yet
};

using MockHd = StandIn<MockHdState>;

}  // namespace palpate::support

/// The stand-in's one and only.
extern "C" palpate::support::MockHd* mock_hd();
/// One round of the servo loop, where that has no thread of its own.
extern "C" void mock_hd_frame();
