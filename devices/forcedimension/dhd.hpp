// The part of Force Dimension's SDK that is used here, declared anew: its constants, and its
// functions as pointers into the vendor's library. Every call names its device.
#pragma once

#include <string>

#include "devices/vendor_library.hpp"

namespace palpate::devices::forcedimension {

namespace error {
constexpr int communication = 2, no_driver = 4, no_device = 5, timeout = 7, not_ready = 12;
}
/// Places in what get_status() fills.
namespace status {
constexpr int initialised = 3, force = 5, wrist_initialised = 12, force_off_cause = 14;
constexpr int count = 32;  // more than any version has
}  // namespace status
/// Why the device itself has switched its force off.
enum class ForceOff : int { none, button, velocity, watchdog, software, usb, deadman };

/// A model of device; figures from public drivers.
struct Model {
    int type;
    const char* name;
    double force;      ///< [N]
    double stiffness;  ///< [N/mm]
    double reach;      ///< [mm] half an edge of the usable cube round the origin
    bool has_wrist;
    double torque;  ///< [N mm] of the wrist's motors; 0: none
};
const Model& model_of(int system_type);

/// The functions. Grippers are not used. Negative results are errors. Positive
/// ones are not: they report the time guard (1) or a motor at its limit (2).
struct Dhd {
    /// Opens `path`; if that is empty, libdrd.so.3, which contains or loads all of libdhd.so.3, or
    /// else libdhd.so.3 alone. Never both: each could have a device table of its own. Throws
    /// DeviceError.
    explicit Dhd(const std::string& path);

    VendorLibrary library;

    int (*get_device_count)();
    int (*dhd_open)(char index);
    int (*dhd_close)(char id);
    int (*stop)(char id);
    int (*enable_force)(unsigned char on, char id);
    int (*get_system_type)(char id);
    int (*get_status)(int*, char id);
    int (*get_position)(double*, double*, double*, char id);  // [m]
    int (*get_orientation)(double (*)[3], char id);           // rows
    unsigned int (*get_buttons)(char id);
    int (*set_force)(double, double, double, char id);  // [N]
    int (*set_brakes)(int on, char id);
    int (*set_gravity_compensation)(int on, char id);
    int (*error_get_last)();  // of the calling thread, as is the next
    const char* (*error_get_last_text)();

    // Null where the library has none.
    const char* (*get_system_name)(char id);
    int (*get_serial_number)(unsigned short*, char id);
    void (*get_version)(int*, int*, int*, int*);
    int (*set_max_force)(double, char id);
    bool (*has_active_wrist)(char id);
    // [N], [N m], and of the gripper [N]
    int (*set_all)(double, double, double, double, double, double, double gripper, char id);
    int (*set_force_and_torque)(double, double, double, double, double, double, char id);
    int (*set_max_torque)(double, char id);  // [N m]
    int (*set_watchdog)(unsigned char eighths_of_ms, char id);
    int (*get_watchdog)(unsigned char*, char id);
    int (*drd_open)(char index);
    int (*drd_close)(char id);
    bool (*drd_is_initialised)(char id);
    int (*drd_initialise)(char id);
    int (*drd_start)(char id);
    int (*drd_stop)(bool forces_stay_on, char id);
    int (*drd_regulate_position)(bool on, char id);
    int (*drd_regulate_rotation)(bool on, char id);
    int (*drd_regulate_gripper)(bool on, char id);
    int (*drd_turn_to)(double, double, double, bool wait, char id);  // [rad] of the wrist

    bool has_drd() const { return drd_open && drd_close && drd_is_initialised && drd_initialise; }
    bool has_torque() const { return set_all || set_force_and_torque; }
    bool can_centre() const {
        return has_drd() && drd_start && drd_stop && drd_regulate_position &&
               drd_regulate_rotation && drd_regulate_gripper && drd_turn_to;
    }
    int open(char index) const { return has_drd() ? drd_open(index) : dhd_open(index); }
    void close(char id) const { has_drd() ? drd_close(id) : dhd_close(id); }
    /// Text of the calling thread's last error.
    std::string error_words() const;
};

}  // namespace palpate::devices::forcedimension
