// Finds and opens the device `openhaptics`: its options and errors.
#include "devices/openhaptics/openhaptics.hpp"

#include <utility>

#include "devices/left_alone.hpp"
#include "devices/openhaptics/phantom.hpp"
#include "devices/openhaptics/words.hpp"

namespace palpate::devices {

DeviceFinding openhaptics::find(const std::string& library) {
    DeviceFinding finding;
    finding.name = "openhaptics";
    finding.options = std::string("name=NAME (the driver's default),reset=no,library=") +
                      openhaptics::library_name;
    try {
        const Hd hd(library);
        finding.found = true;
        finding.what = "OpenHaptics, " + hd.library.path() +
                       "; whether a device answers shows when it is opened";
    } catch (const std::exception& error) {
        finding.missing = error.what();
    }
    return finding;
}

DeviceFinding find_openhaptics() {
    return openhaptics::find("");
}

std::unique_ptr<Device> open_openhaptics(const DeviceChoice& choice, const DeviceScene& scene) {
    return openhaptics::open(choice, scene, {});
}

std::unique_ptr<Device> openhaptics::open(const DeviceChoice& choice, const DeviceScene& scene,
                                          const Timing& timing) {
    DeviceOptions options(choice, "name");
    Settings settings;
    settings.name = options.text("name", "");
    settings.reset = options.flag("reset", false);
    settings.rate = scene.rate;
    const std::string library = options.text("library", "");
    options.finish();
    try {
        Claim own = claim_for_all();
        const auto leaving = own.leaving();
        return left_alone_when_stopped(
            scene.progress,
            [library, claim = std::move(own), settings, timing]() mutable {
                return std::make_unique<Phantom>(
                    std::make_unique<Attachment>(std::move(claim), library, settings.name),
                    settings, timing);
            },
            leaving);
    } catch (const DeviceError& error) {
        throw DeviceError("device " + choice.name + ": " + error.what());
    }
}

}  // namespace palpate::devices
