// Finds the functions of OpenHaptics' library.
#include "devices/openhaptics/hd.hpp"

#include <array>
#include <cstdio>

namespace palpate::devices::openhaptics {

Hd::Hd(const std::string& path) : library(path, words()) {
    library.need(init_device, "hdInitDevice");
    library.need(disable_device, "hdDisableDevice");
    library.need(make_current, "hdMakeCurrentDevice");
    library.need(begin_frame, "hdBeginFrame");
    library.need(end_frame, "hdEndFrame");
    library.need(get_error, "hdGetError");
    library.need(get_error_string, "hdGetErrorString");
    library.need(enable, "hdEnable");
    library.need(disable, "hdDisable");
    library.need(get_double, "hdGetDoublev");
    library.need(get_int, "hdGetIntegerv");
    library.need(get_string, "hdGetString");
    library.need(set_double, "hdSetDoublev");
    library.need(check_calibration, "hdCheckCalibration");
    library.need(update_calibration, "hdUpdateCalibration");
    library.need(start_scheduler, "hdStartScheduler");
    library.need(stop_scheduler, "hdStopScheduler");
    library.need(schedule, "hdScheduleAsynchronous");
    library.need(unschedule, "hdUnschedule");
}

unsigned int Hd::take_error() const noexcept {
    unsigned int oldest = 0;
    for (int i = 0; i < most_errors; ++i) {
        const unsigned int code = get_error().code;  // the newest first
        if (code == 0) break;
        oldest = code;
    }
    return oldest;
}

std::string Hd::error_words(unsigned int code) const {
    const char* words = get_error_string(code);
    std::array<char, 16> number{};
    std::snprintf(number.data(), number.size(), "(0x%x)", code);
    return (words && *words ? std::string(words) + " " : std::string("error ")) + number.data();
}

}  // namespace palpate::devices::openhaptics
