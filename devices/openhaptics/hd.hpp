// The part of OpenHaptics' HD interface that is used here, declared anew: its constants, and its
// functions as pointers into the vendor's library.
#pragma once

#include <cstdint>
#include <string>

#include "devices/vendor_library.hpp"

namespace palpate::devices::openhaptics {

using Handle = unsigned int;
constexpr Handle no_handle = 0xFFFFFFFF;

/// Returned by value.
struct ErrorInfo {
    unsigned int code;  ///< 0: none
    int internal_code;
    Handle device;
};

/// Called by the driver's servo loop.
using Callback = unsigned int (*)(void*);
constexpr unsigned int callback_done = 0, callback_again = 1;
constexpr unsigned short highest_priority = 65535;

namespace parameter {
constexpr unsigned int buttons = 0x2000;    // int, bits 0 to 3
constexpr unsigned int position = 0x2050;   // 3 double [mm]
constexpr unsigned int transform = 0x2052;  // 16 double, column after column
constexpr unsigned int model = 0x2501, driver_version = 0x2502, serial_number = 0x2504;  // string
constexpr unsigned int usable_workspace = 0x2551;       // 6 double: low corner, high corner [mm]
constexpr unsigned int input_dof = 0x2553;              // int
constexpr unsigned int output_dof = 0x2554;             // int, 6 with torque
constexpr unsigned int calibration_style = 0x2555;      // int, bits
constexpr unsigned int update_rate = 0x2600;            // int [Hz]
constexpr unsigned int nominal_max_stiffness = 0x2602;  // double [N/mm]
constexpr unsigned int nominal_max_force = 0x2603;      // double [N]
constexpr unsigned int nominal_max_torque = 0x2622;     // double [mN m]
constexpr unsigned int force = 0x2700;                  // 3 double [N]
constexpr unsigned int torque = 0x2701;                 // 3 double [mN m], axes of the device
}  // namespace parameter

constexpr unsigned int force_output = 0x4000;  // capability

namespace error {
constexpr unsigned int warm_motors = 0x200, exceeded_force = 0x201, exceeded_impulse = 0x202,
                       exceeded_velocity = 0x203, force_error = 0x204;
constexpr unsigned int device_fault = 0x300, already_initiated = 0x301, communication = 0x302,
                       communication_setup = 0x303, timer = 0x304;
}  // namespace error

enum Calibration : unsigned int {
    calibrated = 0x5000,
    needs_update = 0x5001,  ///< an update call is enough
    needs_person = 0x5002,  ///< somebody has to move the device first
};
enum CalibrationStyle : unsigned int { encoder_reset = 1, automatic = 2, inkwell = 4 };

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
    static constexpr int most_errors = 16;  ///< asked for in one call, so that the loop ends
    /// "Device fault (0x300)".
    std::string error_words(unsigned int code) const;
};

}  // namespace palpate::devices::openhaptics
