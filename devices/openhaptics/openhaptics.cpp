// Finds and opens the device `openhaptics`: its options and errors.
#include "devices/openhaptics/openhaptics.hpp"

#include "devices/opening.hpp"

namespace palpate::devices {

DeviceFinding openhaptics::find(const std::string& library) {
    return finding_of("openhaptics",
                      "name=NAME (the driver's default),reset=no,library=" + words().usual,
                      [&](DeviceFinding& finding) {
                          const Hd hd(library);
                          finding.found = true;
                          finding.what = "OpenHaptics, " + hd.library.path() +
                                         "; whether a device answers shows when it is opened";
                      });
}

std::unique_ptr<openhaptics::Phantom> openhaptics::open(const DeviceChoice& choice,
                                                        const DeviceScene& scene,
                                                        const Timing& timing) {
    DeviceOptions options(choice, "name");
    Settings settings;
    settings.name = options.text("name", "");
    settings.reset = options.flag("reset", false);
    settings.rate = scene.rate;
    const std::string library = options.text("library", "");
    options.finish();
    return open_by_library<Phantom, Hd>(choice, scene, library, settings, timing);
}

}  // namespace palpate::devices
