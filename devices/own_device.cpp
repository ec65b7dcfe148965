// The thread of an application's device: read, write, read, ... at a steady rate. The servo only
// ever meets the newest reading and the newest force.
#include "devices/own_device.hpp"

#include <algorithm>
#include <utility>

namespace palpate::devices {

OwnFunctions::OwnFunctions(DeviceInfo info, double rate, std::string device)
    : info_(std::move(info)), rate_(rate), claim_(std::in_place, std::move(device)) {}

void OwnFunctions::run() {
    thread_ = std::this_thread::get_id();
    begin();
    const auto period = static_cast<std::int64_t>(1e9 / rate_);  // [ns]
    for (std::int64_t next = monotonic_ns(); !quit_;) {
        exchange();
        // One step that is late is made up for. More are left out.
        next = std::max(next + period, monotonic_ns() - period);
        if (!quit_) sleep_until(next);
    }
    close();
    claim_.reset();
}

OwnDevice::OwnDevice(std::shared_ptr<OwnFunctions> functions) : functions_(std::move(functions)) {
    std::packaged_task<void()> task([run = functions_] { run->run(); });
    ended_ = task.get_future();
    thread_ = std::thread(std::move(task));
}

OwnDevice::~OwnDevice() {
    constexpr std::chrono::milliseconds longest{500};
    if (end(longest)) return;
    functions_->leave_();
    thread_.detach();
}

bool OwnDevice::end(std::chrono::milliseconds longest) {
    stop();
    functions_->quit_ = true;
    if (is_own_thread() || ended_.wait_for(longest) != std::future_status::ready) return false;
    if (thread_.joinable()) thread_.join();
    return true;
}

DeviceInfo at_rate(DeviceInfo info, double rate) {
    info.limits.rate = std::min(info.limits.rate, rate);
    info.limits.delay += exchange_delay(1 / rate);
    return info;
}

}  // namespace palpate::devices
