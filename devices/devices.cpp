// The table of devices.
#include "palpate/devices/devices.hpp"

#include <array>
#include <stdexcept>

#include "devices/falcon/falcon.hpp"
#include "devices/forcedimension/forcedimension.hpp"
#include "devices/haply/haply.hpp"
#include "devices/left_alone.hpp"
#include "devices/openhaptics/openhaptics.hpp"
#include "devices/recorded/recorded.hpp"
#include "devices/simulated/simulated.hpp"
#include "devices/spacenav/spacenav.hpp"
#include "palpate/devices/mouse.hpp"
#include "palpate/names.hpp"

namespace palpate::devices {
namespace {

struct Backend {
    const char* name;
    DeviceFinding (*find)();
    std::unique_ptr<Device> (*open)(const DeviceChoice&, const DeviceScene&);
};

/// With its thread.
std::unique_ptr<Device> started(auto device) {
    device->start();
    return device;
}

constexpr std::array<Backend, 8> backends{{
    {"simulated", &find_simulated, &open_simulated},
    {"recorded", &find_recorded, &open_recorded},
    {"mouse", &find_mouse, &open_mouse},
    {"haply", [] { return haply::find(); },
     [](const auto& choice, const auto& scene) { return started(haply::open(choice, scene)); }},
    {"openhaptics", [] { return openhaptics::find(""); },
     [](const auto& choice, const auto& scene) -> std::unique_ptr<Device> {
         return openhaptics::open(choice, scene);
     }},
    {"forcedimension", [] { return forcedimension::find(""); },
     [](const auto& choice, const auto& scene) {
         return started(forcedimension::open(choice, scene));
     }},
    {"falcon", [] { return falcon::find(""); },
     [](const auto& choice, const auto& scene) { return started(falcon::open(choice, scene)); }},
    {"spacenav", [] { return spacenav::find(); },
     [](const auto& choice, const auto& scene) { return started(spacenav::open(choice, scene)); }},
}};

std::vector<DeviceFinding> find_all() {
    std::vector<DeviceFinding> findings;
    for (const Backend& backend : backends) findings.push_back(backend.find());
    return findings;
}

}  // namespace

std::vector<DeviceFinding> find_devices(const OnProgress& progress) {
    return left_alone_when_stopped(progress, &find_all);
}

std::vector<std::string> device_names() {
    std::vector<std::string> names;
    for (const Backend& backend : backends) names.emplace_back(backend.name);
    return names;
}

std::unique_ptr<Device> open_device(const DeviceChoice& choice, const DeviceScene& scene) {
    for (const Backend& backend : backends) {
        if (choice.name == backend.name) return backend.open(choice, scene);
    }
    throw std::invalid_argument("there is no device '" + choice.name +
                                "': " + use_one_of(device_names(), choice.name) +
                                "; palpate devices tells which can be had");
}

}  // namespace palpate::devices
