// Finds and opens the device `falcon`: its options and errors.
#include "devices/falcon/falcon.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "devices/falcon/words.hpp"
#include "devices/left_alone.hpp"

namespace palpate::devices {
namespace {

constexpr std::size_t largest_firmware = 1 << 20;  // [bytes] a real one has some 30 kB

std::vector<unsigned char> firmware_from(const std::string& path) {
    if (path.empty()) return {};
    std::ifstream file(path, std::ios::binary);
    std::vector<unsigned char> bytes;
    for (std::istreambuf_iterator<char> i(file), end; i != end; ++i) {
        bytes.push_back(static_cast<unsigned char>(*i));
        if (bytes.size() > largest_firmware) break;
    }
    if (bytes.empty() || bytes.size() > largest_firmware) {
        throw DeviceError("firmware=" + path +
                          ": cannot be read, is empty, or is no firmware of a Falcon");
    }
    return bytes;
}

}  // namespace

DeviceFinding falcon::find(const std::string& library) {
    DeviceFinding finding;
    finding.name = "falcon";
    finding.options = "index=0,firmware=PATH,library=libftdi1.so.2";
    try {
        const Ftdi ftdi(library);
        const int count = ftdi.count();
        finding.found = count > 0;
        if (finding.found) {
            finding.what = std::to_string(count) + (count == 1 ? " device; " : " devices; ") +
                           ftdi.library.path();
        } else {
            finding.missing = "no device (" + ftdi.library.path() + "): " + how_to_attach;
        }
    } catch (const std::exception& error) {
        finding.missing = error.what();
    }
    return finding;
}

DeviceFinding find_falcon() {
    return falcon::find("");
}

std::unique_ptr<Device> open_falcon(const DeviceChoice& choice, const DeviceScene& scene) {
    auto device = falcon::open(choice, scene);
    device->start();
    return device;
}

std::unique_ptr<falcon::FalconDevice> falcon::open(const DeviceChoice& choice,
                                                   const DeviceScene& scene, const Timing& timing) {
    DeviceOptions options(choice, "index");
    const double index = options.number("index", 0, 0, 100);
    if (index != std::floor(index)) {
        throw std::invalid_argument("device " + choice.name + ": index=" + std::to_string(index) +
                                    ": a whole number is needed");
    }
    const std::string firmware = options.text("firmware", "");
    const std::string library = options.text("library", "");
    options.finish();
    try {
        const Ftdi ftdi =
            left_alone_when_stopped(scene.progress, [library] { return Ftdi(library); });
        const Settings settings{static_cast<unsigned int>(index), firmware_from(firmware),
                                scene.rate};
        Claim own = claim_for(settings);
        const auto leaving = own.leaving();
        return left_alone_when_stopped(
            scene.progress,
            [ftdi, claim = std::move(own), settings, timing]() mutable {
                return std::make_unique<FalconDevice>(ftdi, std::move(claim), settings, timing);
            },
            leaving);
    } catch (const DeviceError& error) {
        throw DeviceError("device " + choice.name + ": " + error.what());
    }
}

}  // namespace palpate::devices
