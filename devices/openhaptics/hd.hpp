// The part of OpenHaptics' HD interface that is used here, declared anew: its constants, and its
// functions as pointers into the vendor's library.
#pragma once

#include <cstdint>
#include <string>

#include "devices/vendor_library.hpp"

namespace palpate::devices::openhaptics {

using Handle = unsigned int;
constexpr Handle no_handle = 0xFFFFFFFF;  // HD_INVALID_HANDLE

/// Returned by value.
struct ErrorInfo {
    unsigned int code;  ///< 0: none
    int internal_code;
    Handle device;
};

/// Called by the driver's servo loop.
using Callback = unsigned int (*)(void*);
// Each constant has its name in the vendor's header beside it: docs/devices/interfaces.md lists
// them, and a test compares.
constexpr unsigned int callback_done = 0;           // HD_CALLBACK_DONE
constexpr unsigned int callback_again = 1;          // HD_CALLBACK_CONTINUE
constexpr unsigned short highest_priority = 65535;  // HD_MAX_SCHEDULER_PRIORITY

namespace parameter {
constexpr unsigned int buttons = 0x2000;    // HD_CURRENT_BUTTONS, int, bits 0 to 3
constexpr unsigned int position = 0x2050;   // HD_CURRENT_POSITION, 3 double [mm]
constexpr unsigned int transform = 0x2052;  // HD_CURRENT_TRANSFORM, 16 double, column after column
constexpr unsigned int model = 0x2501;      // HD_DEVICE_MODEL_TYPE, string
constexpr unsigned int serial_number = 0x2504;  // HD_DEVICE_SERIAL_NUMBER, string
// 6 double: low corner, high corner [mm]
constexpr unsigned int usable_workspace = 0x2551;       // HD_USABLE_WORKSPACE_DIMENSIONS
constexpr unsigned int input_dof = 0x2553;              // HD_INPUT_DOF, int
constexpr unsigned int output_dof = 0x2554;             // HD_OUTPUT_DOF, int, 6 with torque
constexpr unsigned int calibration_style = 0x2555;      // HD_CALIBRATION_STYLE, int, bits
constexpr unsigned int update_rate = 0x2600;            // HD_UPDATE_RATE, int [Hz]
constexpr unsigned int nominal_max_stiffness = 0x2602;  // HD_NOMINAL_MAX_STIFFNESS, double [N/mm]
// double [N]
constexpr unsigned int continuous_force = 0x2604;  // HD_NOMINAL_MAX_CONTINUOUS_FORCE
// double for each motor, 0: as the room, 1: too hot
constexpr unsigned int motor_temperature = 0x2605;  // HD_MOTOR_TEMPERATURE
constexpr unsigned int nominal_max_force = 0x2603;  // HD_NOMINAL_MAX_FORCE, double [N]
// double [mN m]
constexpr unsigned int nominal_max_torque = 0x2622;  // HD_NOMINAL_MAX_TORQUE_FORCE
constexpr unsigned int force = 0x2700;               // HD_CURRENT_FORCE, 3 double [N]
constexpr unsigned int torque = 0x2701;  // HD_CURRENT_TORQUE, 3 double [mN m], axes of the device
}  // namespace parameter

constexpr unsigned int force_output = 0x4000;  // HD_FORCE_OUTPUT, a capability

namespace error {
constexpr unsigned int warm_motors = 0x200;          // HD_WARM_MOTORS
constexpr unsigned int exceeded_force = 0x201;       // HD_EXCEEDED_MAX_FORCE
constexpr unsigned int exceeded_impulse = 0x202;     // HD_EXCEEDED_MAX_FORCE_IMPULSE
constexpr unsigned int exceeded_velocity = 0x203;    // HD_EXCEEDED_MAX_VELOCITY
constexpr unsigned int force_error = 0x204;          // HD_FORCE_ERROR
constexpr unsigned int device_fault = 0x300;         // HD_DEVICE_FAULT
constexpr unsigned int communication = 0x302;        // HD_COMM_ERROR
constexpr unsigned int communication_setup = 0x303;  // HD_COMM_CONFIG_ERROR
// The driver's servo loop has ended.
constexpr unsigned int timer = 0x304;             // HD_TIMER_ERROR
constexpr unsigned int invalid_priority = 0x500;  // HD_INVALID_PRIORITY
constexpr unsigned int scheduler_full = 0x501;    // HD_SCHEDULER_FULL
constexpr unsigned int invalid_license = 0x600;   // HD_INVALID_LICENSE
}  // namespace error

enum Calibration : unsigned int {
    calibrated = 0x5000,    // HD_CALIBRATION_OK
    needs_update = 0x5001,  // HD_CALIBRATION_NEEDS_UPDATE: an update call is enough
    needs_person = 0x5002,  // HD_CALIBRATION_NEEDS_MANUAL_INPUT: it has to be moved first
};
enum CalibrationStyle : unsigned int {
    encoder_reset = 1,  // HD_CALIBRATION_ENCODER_RESET
    automatic = 2,      // HD_CALIBRATION_AUTO
    inkwell = 4,        // HD_CALIBRATION_INKWELL
};

VendorWords words();

/// The functions. All but error_words() need the device to be the current one.
struct Hd {
    /// Opens `path`; if that is empty, libHD.so where the loader finds it. Throws DeviceError.
    explicit Hd(const std::string& path);

    VendorLibrary library;

    Handle (*init_device)(const char* name);
    void (*disable_device)(Handle);
    void (*make_current)(Handle);
    void (*begin_frame)(Handle);
    void (*end_frame)(Handle);
    ErrorInfo (*get_error)();
    const char* (*get_error_string)(unsigned int code);
    void (*enable)(unsigned int capability);
    void (*disable)(unsigned int capability);
    void (*get_double)(unsigned int parameter, double*);
    void (*get_int)(unsigned int parameter, int*);
    const char* (*get_string)(unsigned int parameter);
    void (*set_double)(unsigned int parameter, const double*);
    unsigned int (*check_calibration)();
    void (*update_calibration)(unsigned int style);
    void (*start_scheduler)();
    void (*stop_scheduler)();
    unsigned long (*schedule)(Callback, void*, unsigned short priority);
    void (*unschedule)(unsigned long);

    /// The oldest error that the driver has not reported yet, 0 if there is none; drops the others.
    unsigned int take_error() const noexcept;
    static constexpr int most_errors = 16;  // ours: asked for in one call, so that the loop ends
    /// "Device fault (0x300)".
    std::string error_words(unsigned int code) const;
};

}  // namespace palpate::devices::openhaptics
