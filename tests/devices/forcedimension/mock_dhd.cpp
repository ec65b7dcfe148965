// A stand-in for libdhd.so.3 and, unless MOCK_DHD_ALONE, for libdrd.so.3: one device without
// hardware behind the functions of the SDK. Its id is not its index, so that mixing them up shows.
#include "mock_dhd.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <thread>

namespace {

using palpate::support::MockDhd;
using palpate::support::MockDhdState;

constexpr char the_id = 5;

// The interface is one of globals: so is this.
MockDhd mock;
thread_local int last_error = 0;

int fail(int code) {
    last_error = code;
    return -1;
}

void apply(MockDhdState& state, const std::array<double, 3>& force,
           const std::array<double, 3>& torque = {}, std::optional<double> gripper = {}) {
    const bool held = state.is_regulating && state.regulates_position;
    const bool works =
        state.initialised && state.force_on && !state.brakes && !held && state.force_off_cause == 0;
    state.force = works ? force : std::array<double, 3>{};
    if (gripper) state.gripper_force = *gripper;  // the force alone leaves it
    if (!works) state.gripper_force = 0;
    const double size = std::hypot(state.force[0], state.force[1], state.force[2]);
    state.largest_force = std::max(state.largest_force, size);
    const bool turns = works && state.active_wrist && !state.is_regulating;
    state.torque = turns ? torque : std::array<double, 3>{};
    const double turning = std::hypot(state.torque[0], state.torque[1], state.torque[2]);
    state.largest_torque = std::max(state.largest_torque, turning);
}

bool is_one_of(int type, std::initializer_list<int> types) {
    return std::ranges::find(types, type) != types.end();
}

bool has_gripper(const MockDhdState& state) {
    return state.gripper.value_or(is_one_of(state.type, {35, 37, 104, 105, 108, 109}));
}

/// The state, for a call for this device; its lock is held.
class Call {
  public:
    explicit Call(char id, const char* name = nullptr) : lock_(mock.mutex) {
        if (id != the_id || !mock.state.is_open) ++mock.state.wrong_id;
        if (name) mock.state.calls.emplace_back(name);
    }
    MockDhdState* operator->() const { return &mock.state; }

  private:
    std::lock_guard<std::mutex> lock_;
};

int open_device(char index, const char* name) {
    // As a driver whose bus is stuck. Its file is open meanwhile, so that a test sees it.
    if (const char* const seen = std::getenv("MOCK_DHD_HANGS")) {
        const std::ifstream file(seen);
        std::this_thread::sleep_for(std::chrono::hours(1));
    }
    mock.meanwhile(&MockDhdState::while_opening);
    const std::lock_guard lock(mock.mutex);
    mock.state.calls.emplace_back(name);
    if (mock.state.refuses_open || index != 0) return fail(20);
    mock.state.is_open = true;
    return the_id;
}

}  // namespace

MOCK_EXPORT MockDhd* mock_dhd() {
    return &mock;
}

MOCK_EXPORT int dhdGetDeviceCount() {
    const std::lock_guard lock(mock.mutex);
    return mock.state.count + (mock.state.simulates ? 1 : 0);
}

MOCK_EXPORT void dhdEnableSimulator(bool on) {
    const std::lock_guard lock(mock.mutex);
    mock.state.simulates = on;
}

MOCK_EXPORT void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
    *major = 3;
    *minor = 17;
    *release = 5;
    *revision = 0;
}

MOCK_EXPORT int dhdErrorGetLast() {
    return last_error;
}

MOCK_EXPORT const char* dhdErrorGetLastStr() {
    switch (last_error) {
        case 2:
            return "communication error";
        case 8:
            return "geometry error";
        case 9:
            return "expert mode disabled";
        case 20:
            return "device already in use";
        default:
            return "undocumented error";
    }
}

MOCK_EXPORT int dhdOpenID(char index) {
    return open_device(index, "dhd open");
}

MOCK_EXPORT int dhdClose(char id) {
    const Call call(id, "dhd close");
    call->is_open = false;
    return 0;
}

MOCK_EXPORT int dhdStop(char id) {
    const Call call(id, "stop");
    call->force_at_stop = call->force;
    call->force_on = false;
    call->brakes = true;
    apply(mock.state, {}, {}, 0);
    return 0;
}

MOCK_EXPORT int dhdEnableForce(unsigned char on, char id) {
    const Call call(id, "enable force");
    if (call->refuses_force) return fail(12);
    call->force_on = on != 0;
    if (call->force_off_cause == 3) call->force_off_cause = 0;
    return 0;
}

MOCK_EXPORT int dhdGetSystemType(char id) {
    const Call call(id);
    return call->type;
}

MOCK_EXPORT const char* dhdGetSystemName(char id) {
    const Call call(id);
    return "mock.3";
}

MOCK_EXPORT int dhdGetSerialNumber(unsigned short* number, char id) {
    const Call call(id);
    *number = 4711;
    return 0;
}

#ifndef MOCK_DHD_LACKS_STATUS
MOCK_EXPORT int dhdGetStatus(int* status, char id) {
    const Call call(id);
    if (call->status_error) return fail(call->status_error);
    std::fill(status, status + 17, 0);
    std::fill(status + 17, status + call->status_count, 0x55555555);
    status[3] = call->initialised ? 0 : 1;
    status[5] = call->tells_of_force && call->force_on && call->force_off_cause == 0 ? 1 : 0;
    status[6] = call->brakes ? 1 : 0;
    status[12] = call->wrist_initialised ? 1 : 0;
    status[14] = call->force_off_cause;
    return 0;
}
#endif

MOCK_EXPORT int dhdGetPosition(double* x, double* y, double* z, char id) {
    mock.meanwhile(&MockDhdState::while_reading);
    const Call call(id);
    if (call->position_error) return fail(call->position_error);
    *x = call->position[0];
    *y = call->position[1];
    *z = call->position[2];
    return call->position_result;
}

MOCK_EXPORT int dhdGetOrientationFrame(double (*rows)[3], char id) {
    const Call call(id);
    if (call->orientation_error) return fail(call->orientation_error);
    std::memcpy(rows, call->frame, sizeof call->frame);
    return 0;
}

MOCK_EXPORT unsigned int dhdGetButtonMask(char id) {
    const Call call(id);
    return has_gripper(mock.state) && !call->emulates_button ? 0 : call->buttons;
}

MOCK_EXPORT int dhdEmulateButton(unsigned char on, char id) {
    const Call call(id);
    if (!has_gripper(mock.state) || call->refuses_emulation) return fail(6);
    call->emulates_button = on != 0;
    return 0;
}

MOCK_EXPORT bool dhdHasWrist(char id) {
    const Call call(id);
    return call->wrist.value_or(
        is_one_of(call->type, {34, 35, 36, 37, 64, 104, 105, 108, 109, 131, 132}));
}

MOCK_EXPORT bool dhdHasGripper(char id) {
    const Call call(id);
    return has_gripper(mock.state);
}

MOCK_EXPORT bool dhdHasActiveGripper(char id) {
    const Call call(id);
    return has_gripper(mock.state) && call->active_gripper;
}

MOCK_EXPORT int dhdGetGripperAngleRad(double* angle, char id) {
    const Call call(id);
    if (call->opening_error) return fail(call->opening_error);
    *angle = call->opening;
    return 0;
}

MOCK_EXPORT double dhdGetMaxForce(char id) {
    const Call call(id);
    return call->max_force > 0 ? call->max_force : call->limit;
}

MOCK_EXPORT int dhdSetForce(double x, double y, double z, char id) {
    const Call call(id);
    ++call->loops;
    if (call->force_error) return fail(call->force_error);
    apply(mock.state, {x, y, z});
    return call->force_result;
}

MOCK_EXPORT int dhdSetForceAndGripperForce(double x, double y, double z, double gripper, char id) {
    const Call call(id);
    ++call->loops;
    if (call->force_error) return fail(call->force_error);
    apply(mock.state, {x, y, z}, {}, gripper);
    return call->force_result;
}

MOCK_EXPORT bool dhdHasActiveWrist(char id) {
    const Call call(id);
    return call->active_wrist;
}

namespace {
int set_both(const std::array<double, 3>& force, const std::array<double, 3>& torque, char id,
             std::optional<double> gripper = {}) {
    const Call call(id);
    ++call->loops;
    if (call->torque_error) return fail(call->torque_error);
    apply(mock.state, force, torque, gripper);
    return call->force_result;
}
}  // namespace

// Each stand-in has one of the two functions.
#ifdef MOCK_DHD_ALONE
MOCK_EXPORT int dhdSetForceAndTorque(double fx, double fy, double fz, double tx, double ty,
                                     double tz, char id) {
    return set_both({fx, fy, fz}, {tx, ty, tz}, id);
}
#else
MOCK_EXPORT int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double tx,
                                                    double ty, double tz, double gripper, char id) {
    return set_both({fx, fy, fz}, {tx, ty, tz}, id, gripper);
}
#endif

MOCK_EXPORT int dhdSetMaxTorque(double limit, char id) {
    const Call call(id);
    call->max_torque = limit;
    return 0;
}

MOCK_EXPORT int dhdSetBrakes(int on, char id) {
    const Call call(id, "brakes");
    call->brakes = on != 0;
    return 0;
}

MOCK_EXPORT int dhdSetGravityCompensation(int on, char id) {
    const Call call(id, "gravity");
    call->gravity = on;
    return 0;
}

MOCK_EXPORT int dhdSetMaxForce(double limit, char id) {
    const Call call(id, "max force");
    call->max_force = limit;
    return 0;
}

MOCK_EXPORT int dhdEnableExpertMode() {
    const std::lock_guard lock(mock.mutex);
    mock.state.is_expert = true;
    return 0;
}

MOCK_EXPORT int dhdDisableExpertMode() {
    const std::lock_guard lock(mock.mutex);
    mock.state.is_expert = false;
    return 0;
}

MOCK_EXPORT int dhdSetWatchdog(unsigned char duration, char id) {
    const Call call(id, "watchdog");
    if (!call->is_expert) return fail(9);
    if (call->refuses_watchdog) return fail(6);
    call->watchdog = duration;
    return 0;
}

MOCK_EXPORT int dhdGetWatchdog(unsigned char* duration, char id) {
    const Call call(id);
    if (!call->is_expert) return fail(9);
    *duration = static_cast<unsigned char>(call->watchdog);
    return 0;
}

#ifndef MOCK_DHD_ALONE
MOCK_EXPORT int drdOpenID(char index) {
    return open_device(index, "drd open");
}

MOCK_EXPORT int drdClose(char id) {
    const Call call(id, "drd close");
    call->is_open = false;
    return 0;
}

MOCK_EXPORT bool drdIsInitialized(char id) {
    const Call call(id);
    return call->initialised;
}

MOCK_EXPORT int drdAutoInit(char id) {
    mock.meanwhile(&MockDhdState::while_initialising);
    const Call call(id, "initialise");
    call->is_regulating = true;
    if (!call->initialises) return fail(8);
    call->initialised = true;
    return 0;
}

MOCK_EXPORT int drdRegulatePos(bool on, char id) {
    const Call call(id);
    call->regulates_position = on;
    return 0;
}

MOCK_EXPORT int drdRegulateRot(bool on, char id) {
    const Call call(id);
    call->regulates_rotation = on;
    return 0;
}

MOCK_EXPORT int drdRegulateGrip(bool, char id) {
    const Call call(id);
    return 0;
}

MOCK_EXPORT int drdStart(char id) {
    const Call call(id, "start");
    call->is_regulating = true;
    return 0;
}

MOCK_EXPORT int drdStop(bool stays_on, char id) {
    const Call call(id, "stop regulating");
    call->is_regulating = false;
    call->force_on = stays_on;
    return 0;
}

MOCK_EXPORT int drdMoveToRot(double a, double b, double c, bool wait, char id) {
    mock.meanwhile(&MockDhdState::while_centring);
    const Call call(id, "turn");
    const bool straight = a == 0 && b == 0 && c == 0 && wait;
    const bool wrist_alone = call->regulates_rotation && !call->regulates_position;
    if (straight && wrist_alone && call->is_regulating) ++call->turned_to_centre;
    return 0;
}
#endif
