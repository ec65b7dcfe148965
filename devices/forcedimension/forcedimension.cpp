// Finds and opens the device `forcedimension`: its options and errors.
#include "devices/forcedimension/forcedimension.hpp"

#include <cmath>
#include <utility>

#include "devices/forcedimension/dhd_device.hpp"
#include "devices/forcedimension/words.hpp"
#include "devices/left_alone.hpp"

namespace palpate::devices {
namespace {

std::string version_of(const forcedimension::Dhd& dhd) {
    if (!dhd.get_version) return {};
    int major = 0, minor = 0, release = 0, revision = 0;
    dhd.get_version(&major, &minor, &release, &revision);
    return " " + std::to_string(major) + "." + std::to_string(minor) + "." +
           std::to_string(release);
}

}  // namespace

DeviceFinding forcedimension::find(const std::string& library) {
    DeviceFinding finding;
    finding.name = "forcedimension";
    finding.options = std::string("index=0,autoinit=no,centre=no,simulator=no,spring=0,library=") +
                      forcedimension::names_in_words;
    try {
        const Dhd dhd(library);
        const std::string sdk = "Force Dimension SDK" + version_of(dhd) + ", " + dhd.library.path();
        const int count = dhd.get_device_count();
        finding.found = count > 0;
        if (finding.found) {
            finding.what = std::to_string(count) + (count == 1 ? " device; " : " devices; ") + sdk;
        } else {
            finding.missing = "no device (" + sdk + "): " + how_to_attach;
        }
    } catch (const std::exception& error) {
        finding.missing = error.what();
    }
    return finding;
}

DeviceFinding find_forcedimension() {
    return forcedimension::find("");
}

std::unique_ptr<Device> open_forcedimension(const DeviceChoice& choice, const DeviceScene& scene) {
    auto device = forcedimension::open(choice, scene);
    device->start();
    return device;
}

std::unique_ptr<forcedimension::DhdDevice> forcedimension::open(const DeviceChoice& choice,
                                                                const DeviceScene& scene,
                                                                const Timing& timing) {
    DeviceOptions options(choice, "index");
    const double index = options.number("index", 0, 0, 100);
    if (index != std::floor(index)) {
        throw std::invalid_argument("device " + choice.name + ": index=" + std::to_string(index) +
                                    ": a whole number is needed");
    }
    Settings settings;
    settings.index = static_cast<int>(index);
    settings.initialise = options.flag("autoinit", false);
    settings.centre = options.flag("centre", false);
    settings.simulator = options.flag("simulator", false);
    settings.rate = scene.rate;
    const std::string library = options.text("library", "");
    settings.spring = options.number("spring", 0, 0, 3);
    options.finish();
    try {
        const Dhd dhd = left_alone_when_stopped(scene.progress, [library] { return Dhd(library); });
        Claim own = claim_for(settings);
        const auto leaving = own.leaving();
        return left_alone_when_stopped(
            scene.progress,
            [dhd, claim = std::move(own), settings, timing]() mutable {
                return std::make_unique<DhdDevice>(dhd, std::move(claim), settings, timing);
            },
            leaving);
    } catch (const DeviceError& error) {
        throw DeviceError("device " + choice.name + ": " + error.what());
    }
}

}  // namespace palpate::devices
