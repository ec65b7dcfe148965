// Shared by backends: looking for a device and opening it.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "devices/claim.hpp"
#include "devices/left_alone.hpp"
#include "devices/link.hpp"
#include "palpate/devices/backend.hpp"

namespace palpate::devices {

/// The finding of a backend. look(finding) says what there is. The message of what it throws says
/// what is missing.
DeviceFinding finding_of(const char* name, const std::string& options, auto&& look) {
    DeviceFinding finding;
    finding.name = name;
    finding.options = options;
    try {
        look(finding);
    } catch (const std::exception& error) {
        finding.missing = error.what();
    }
    return finding;
}

/// So many devices were found by this library.
inline void tell_count(DeviceFinding& finding, int count, const std::string& library,
                       const std::string& how_to_attach) {
    finding.found = count > 0;
    if (finding.found) {
        finding.what = std::to_string(count) + (count == 1 ? " device; " : " devices; ") + library;
    } else {
        finding.missing = "no device (" + library + "): " + how_to_attach;
    }
}

/// The result of open(). The messages of its DeviceErrors get the name of the device.
auto with_name(const DeviceChoice& choice, auto&& open) {
    try {
        return open();
    } catch (const DeviceError& error) {
        throw DeviceError("device " + choice.name + ": " + error.what());
    }
}

/// Opens an Opened(Library, Claim, settings, timing) by the vendor's library at a path (empty:
/// where it usually is). claim_for(settings) is the device that it opens. Library and driver are
/// left alone if they do not return and `scene.progress` throws.
template <class Opened, class Library, class Settings>
std::unique_ptr<Opened> open_by_library(const DeviceChoice& choice, const DeviceScene& scene,
                                        const std::string& path, const Settings& settings,
                                        const Timing& timing) {
    return with_name(choice, [&] {
        const Library library =
            left_alone_when_stopped(scene.progress, [path] { return Library(path); });
        Claim own = claim_for(settings);
        const auto leaving = own.leaving();
        return left_alone_when_stopped(
            scene.progress,
            [library, claim = std::move(own), settings, timing]() mutable {
                return std::make_unique<Opened>(library, std::move(claim), settings, timing);
            },
            leaving);
    });
}

}  // namespace palpate::devices
