// A stand-in for libHD.so: a device without hardware behind the functions of the HD interface, with
// a servo loop of its own. One device, no licence, no arm.
#include "mock_hd.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>

namespace {

using palpate::support::MockHd;
using palpate::support::MockHdState;

struct Scheduled {
    unsigned int (*callback)(void*);
    void* data;
    unsigned long handle;
};

struct ErrorInfo {
    unsigned int code;
    int internal_code;
    unsigned int device;
};

constexpr unsigned int the_device = 7;

// The interface is one of globals: so is this.
MockHd mock;
MockHdState& state = mock.state;
std::vector<Scheduled> scheduled;
std::optional<std::thread> scheduler;
std::atomic<bool> running{false};
bool force_output = false;
bool in_frame = false;
std::array<double, 3> frame_force{}, frame_torque{};
unsigned long last_handle = 0;

// The mutex is held by the caller of all of these.
void complain(unsigned int code) {
    state.errors.push_back(code);
}
void called(const std::string& what) {
    state.calls.push_back(what);
}
void want_frame() {
    if (in_frame) return;
    ++state.outside;
    complain(0x102);
}
void drive(const std::array<double, 3>& force, const std::array<double, 3>& torque) {
    state.force = force_output ? force : std::array<double, 3>{};
    const double size = std::hypot(state.force[0], state.force[1], state.force[2]);
    state.largest_force = std::max(state.largest_force, size);
    state.torque = force_output ? torque : std::array<double, 3>{};
    const double turning = std::hypot(state.torque[0], state.torque[1], state.torque[2]);
    state.largest_torque = std::max(state.largest_torque, turning);
}

void call_all() {
    std::vector<Scheduled> now;
    {
        const std::lock_guard lock(mock.mutex);
        if (!state.silent) now = scheduled;
    }
    for (const Scheduled& one : now) {
        if (one.callback(one.data) != 0) continue;
        const std::lock_guard lock(mock.mutex);
        std::erase_if(scheduled, [&](const Scheduled& s) { return s.handle == one.handle; });
    }
}

void loop() {
    auto next = std::chrono::steady_clock::now();
    while (running) {
        call_all();
        next = std::max(next + std::chrono::milliseconds(1), std::chrono::steady_clock::now());
        std::this_thread::sleep_until(next);
    }
}

}  // namespace

MOCK_EXPORT MockHd* mock_hd() {
    return &mock;
}

MOCK_EXPORT void mock_hd_frame() {
    if (running && !scheduler) call_all();
}

MOCK_EXPORT unsigned int hdInitDevice(const char* name) {
    mock.meanwhile(&MockHdState::while_opening);
    const std::lock_guard lock(mock.mutex);
    called("init " + std::string(name ? name : "NULL"));
    if (state.has_no_licence) return complain(0x600), 0xFFFFFFFF;
    const bool refused =
        state.refuses_all || (!name && state.refuses_null) || (name && name != state.only_name);
    if (refused || state.device_open) {
        complain(refused ? 0x300 : 0x301);
        return 0xFFFFFFFF;
    }
    state.device_open = true;
    return the_device;
}

MOCK_EXPORT void hdDisableDevice(unsigned int device) {
    const std::lock_guard lock(mock.mutex);
    called("disable device");
    if (device != the_device || !state.device_open) complain(0x104);
    state.device_open = false;
}

MOCK_EXPORT void hdMakeCurrentDevice(unsigned int device) {
    const std::lock_guard lock(mock.mutex);
    if (device != the_device || !state.device_open) complain(0x104);
}

MOCK_EXPORT void hdBeginFrame(unsigned int device) {
    {
        const std::lock_guard lock(mock.mutex);
        if (device != the_device || !state.device_open) complain(0x104);
        if (in_frame) complain(0x400);
        in_frame = true;
        frame_force = frame_torque = {};
    }
    mock.meanwhile(&MockHdState::while_beginning);
}

MOCK_EXPORT void hdEndFrame(unsigned int device) {
    const std::lock_guard lock(mock.mutex);
    if (device != the_device) complain(0x104);
    if (!in_frame) complain(0x401);
    in_frame = false;
    ++state.frames;
    drive(frame_force, frame_torque);
    if (state.every_error) complain(state.every_error);
    if (state.next_error) complain(state.next_error);
    for (const unsigned int ending : {0x304U, 0x500U, 0x501U}) {
        if (state.next_error == ending) state.silent = true;
    }
    state.next_error = 0;
}

MOCK_EXPORT ErrorInfo hdGetError() {
    const std::lock_guard lock(mock.mutex);
    if (state.errors.empty()) return {0, 0, 0};
    const unsigned int code = state.errors.back();
    state.errors.pop_back();
    return {code, -1, the_device};
}

MOCK_EXPORT const char* hdGetErrorString(unsigned int code) {
    switch (code) {
        case 0x102:
            return "Invalid operation";
        case 0x200:
            return "Warm motors";
        case 0x203:
            return "Exceeded maximum velocity";
        case 0x300:
            return "Device fault";
        case 0x302:
            return "Communication error";
        default:
            return nullptr;
    }
}

MOCK_EXPORT void hdEnable(unsigned int capability) {
    const std::lock_guard lock(mock.mutex);
    called("enable");
    if (capability != 0x4000) return complain(0x100);
    force_output = true;
}

MOCK_EXPORT void hdDisable(unsigned int capability) {
    const std::lock_guard lock(mock.mutex);
    called("disable");
    if (capability != 0x4000) return complain(0x100);
    force_output = false;
    drive({}, {});
}

MOCK_EXPORT void hdGetDoublev(unsigned int parameter, double* value) {
    const std::lock_guard lock(mock.mutex);
    switch (parameter) {
        case 0x2050:
            want_frame();
            if (state.no_position) return;
            std::copy(state.position.begin(), state.position.end(), value);
            break;
        case 0x2052:
            want_frame();
            std::copy(state.transform.begin(), state.transform.end(), value);
            break;
        case 0x2551:
            std::copy(state.workspace.begin(), state.workspace.end(), value);
            break;
        case 0x2602:
            *value = state.stiffness;
            break;
        case 0x2603:
            *value = state.most_force;
            break;
        case 0x2604:
            *value = state.continuous_force;
            break;
        case 0x2605:
            if (state.temperature_error) return complain(state.temperature_error);
            if (state.temperature < 0) return complain(0x100);
            value[0] = value[2] = 0;
            value[1] = state.temperature;
            break;
        case 0x2622:
            if (state.output_dof < 6) return complain(0x100);
            *value = state.most_torque;
            break;
        default:
            complain(0x100);
    }
}

MOCK_EXPORT void hdGetIntegerv(unsigned int parameter, int* value) {
    const std::lock_guard lock(mock.mutex);
    switch (parameter) {
        case 0x2000:
            want_frame();
            *value = state.buttons;
            break;
        case 0x2553:
            *value = state.input_dof;
            break;
        case 0x2554:
            *value = state.output_dof;
            break;
        case 0x2555:
            *value = state.calibration_style;
            break;
        case 0x2600:
            *value = state.rate;
            break;
        default:
            complain(0x100);
    }
}

MOCK_EXPORT const char* hdGetString(unsigned int parameter) {
    if (parameter == 0x2501) return "Mock Touch";
    return parameter == 0x2504 ? "20240001" : nullptr;
}

MOCK_EXPORT void hdSetDoublev(unsigned int parameter, const double* value) {
    const std::lock_guard lock(mock.mutex);
    want_frame();
    if (parameter == 0x2701 && state.output_dof >= 6) {
        if (state.torque_error) return complain(state.torque_error);
        std::copy(value, value + 3, frame_torque.begin());
        return;
    }
    if (parameter != 0x2700) return complain(0x100);
    std::copy(value, value + 3, frame_force.begin());
}

MOCK_EXPORT unsigned int hdCheckCalibration() {
    const std::lock_guard lock(mock.mutex);
    return state.calibration;
}

MOCK_EXPORT void hdUpdateCalibration(unsigned int style) {
    const std::lock_guard lock(mock.mutex);
    called("update calibration " + std::to_string(style));
    if (!(style & static_cast<unsigned int>(state.calibration_style))) return complain(0x102);
    if (state.update_helps) state.calibration = 0x5000;
}

MOCK_EXPORT void hdStartScheduler() {
    const std::lock_guard lock(mock.mutex);
    called("start scheduler");
    if (state.refuses_start) return complain(0x304);
    if (running.exchange(true)) return;
    if (state.own_thread) scheduler.emplace(loop);
}

MOCK_EXPORT void hdStopScheduler() {
    {
        const std::lock_guard lock(mock.mutex);
        called("stop scheduler");
        state.force_at_stop = state.force;
    }
    if (!running.exchange(false) || !scheduler) return;
    scheduler->join();
    scheduler.reset();
}

MOCK_EXPORT unsigned long hdScheduleAsynchronous(unsigned int (*callback)(void*), void* data,
                                                 unsigned short priority) {
    const std::lock_guard lock(mock.mutex);
    called("schedule " + std::to_string(priority));
    scheduled.push_back({callback, data, ++last_handle});
    return last_handle;
}

#ifndef MOCK_HD_LACKS_UNSCHEDULE
MOCK_EXPORT void hdUnschedule(unsigned long handle) {
    const std::lock_guard lock(mock.mutex);
    called("unschedule");
    std::erase_if(scheduled, [&](const Scheduled& one) { return one.handle == handle; });
}
#endif
