// Finds and opens the device `forcedimension`: its options and errors.
#include "devices/forcedimension/forcedimension.hpp"

#include "devices/forcedimension/dhd_device.hpp"
#include "devices/opening.hpp"

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
    return finding_of(
        "forcedimension",
        "index=0,autoinit=no,centre=no,simulator=no,spring=0,library=" + words().usual,
        [&](DeviceFinding& finding) {
            const Dhd dhd(library);
            tell_count(finding, dhd.get_device_count(),
                       "Force Dimension SDK" + version_of(dhd) + ", " + dhd.library.path(),
                       words().how_to_attach);
        });
}

std::unique_ptr<forcedimension::DhdDevice> forcedimension::open(const DeviceChoice& choice,
                                                                const DeviceScene& scene,
                                                                const Timing& timing) {
    DeviceOptions options(choice, "index");
    Settings settings;
    settings.index = options.whole_number("index", 0, 0, 100);
    settings.initialise = options.flag("autoinit", false);
    settings.centre = options.flag("centre", false);
    settings.simulator = options.flag("simulator", false);
    settings.rate = scene.rate;
    const std::string library = options.text("library", "");
    settings.spring = options.number("spring", 0, 0, 3);
    options.finish();
    return open_by_library<DhdDevice, Dhd>(choice, scene, library, settings, timing);
}

}  // namespace palpate::devices
