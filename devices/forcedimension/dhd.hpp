// The part of Force Dimension's SDK that is used here, declared anew: its constants, and its
// functions as pointers into the vendor's library. Every call names its device.
#pragma once

#include <string>

#include "devices/models.hpp"
#include "devices/vendor_library.hpp"

namespace palpate::devices::forcedimension {

// Each constant has its name in the vendor's header beside it: docs/devices/interfaces.md lists
// them, and a test compares.

namespace error {
constexpr int communication = 2;  // DHD_ERROR_COM
constexpr int no_driver = 4;      // DHD_ERROR_NO_DRIVER_FOUND
constexpr int no_device = 5;      // DHD_ERROR_NO_DEVICE_FOUND
constexpr int timeout = 7;        // DHD_ERROR_TIMEOUT
constexpr int not_ready = 12;     // DHD_ERROR_DEVICE_NOT_READY
}  // namespace error
/// Places in what get_status() fills.
namespace status {
constexpr int reset = 3;               // DHD_STATUS_RESET: 1 while it waits for its calibration
constexpr int force = 5;               // DHD_STATUS_FORCE
constexpr int wrist_initialised = 12;  // DHD_STATUS_WRIST_INIT
constexpr int force_off_cause = 14;    // DHD_STATUS_FORCE_OFF_CAUSE
constexpr int count = 17;              // DHD_MAX_STATUS
constexpr int room = 32;  // ours: newer libraries fill more, without asking how much there is
}  // namespace status
/// Why the device itself has switched its force off.
enum class ForceOff : int {
    none = 0,      // DHD_FORCE_OFF_NONE
    button = 1,    // DHD_FORCE_OFF_BUTTON
    velocity = 2,  // DHD_FORCE_OFF_VELOCITY
    watchdog = 3,  // DHD_FORCE_OFF_WATCHDOG
    deadman = 6,   // DHD_FORCE_OFF_DEADMAN
};

VendorWords words();

/// The functions. Negative results are errors. Positive
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
    void (*enable_simulator)(bool on);  // before devices are counted
    const char* (*get_system_name)(char id);
    int (*get_serial_number)(unsigned short*, char id);
    void (*get_version)(int*, int*, int*, int*);
    int (*set_max_force)(double, char id);
    bool (*has_wrist)(char id);
    bool (*has_active_wrist)(char id);
    bool (*has_gripper)(char id);
    bool (*has_active_gripper)(char id);
    int (*get_gripper_angle)(double*, char id);        // [rad]
    double (*get_max_force)(char id);                  // [N] negative: no limit is set
    int (*emulate_button)(unsigned char on, char id);  // closing the gripper is button 0
    int (*enable_expert_mode)();
    int (*disable_expert_mode)();
    // [N], [N m], and of the gripper [N]
    int (*set_all)(double, double, double, double, double, double, double gripper, char id);
    int (*set_force_and_gripper)(double, double, double, double gripper,
                                 char id);  // without torque
    int (*set_force_and_torque)(double, double, double, double, double, double, char id);
    int (*set_max_torque)(double, char id);  // [N m]
    // In expert mode only.
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

    bool has_drd() const {
        return drd_open && drd_close && drd_is_initialised && drd_initialise && drd_stop;
    }
    bool has_torque() const { return set_all || set_force_and_torque; }
    bool can_centre() const {
        return has_drd() && drd_start && drd_regulate_position && drd_regulate_rotation &&
               drd_regulate_gripper && drd_turn_to;
    }
    int open(char index) const { return has_drd() ? drd_open(index) : dhd_open(index); }
    void close(char id) const { has_drd() ? drd_close(id) : dhd_close(id); }
    /// Text of the calling thread's last error.
    std::string error_words() const;
};

/// What an open device can do.
struct Arm {
    Model model;                  ///< `torque` is 0 without motors at its wrist
    Vec3 centre = Vec3::Zero();   ///< of its workspace [device mm]
    bool has_button_row = false;  ///< a Falcon's four buttons
    double opens = 0;             ///< sign of the force that opens its gripper. 0: none does
};
/// What the library tells; figures that it does not know are those of the model's data sheet. For a
/// model that is not in the table they are the smallest of all.
Arm arm_of(const Dhd& dhd, char id);

}  // namespace palpate::devices::forcedimension
