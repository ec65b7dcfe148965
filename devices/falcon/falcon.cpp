// Finds and opens the device `falcon`: its options and errors.
#include "devices/falcon/falcon.hpp"

#include <fstream>
#include <iterator>

#include "devices/opening.hpp"

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
    return finding_of(
        "falcon", "index=0,firmware=PATH,library=" + words().usual, [&](DeviceFinding& finding) {
            const Ftdi ftdi(library);
            tell_count(finding, ftdi.count(), ftdi.library.path(), words().how_to_attach);
        });
}

std::unique_ptr<falcon::FalconDevice> falcon::open(const DeviceChoice& choice,
                                                   const DeviceScene& scene, const Timing& timing) {
    DeviceOptions options(choice, "index");
    Settings settings;
    settings.index = static_cast<unsigned int>(options.whole_number("index", 0, 0, 100));
    const std::string firmware = options.text("firmware", "");
    settings.rate = scene.rate;
    const std::string library = options.text("library", "");
    options.finish();
    settings.firmware = with_name(choice, [&] { return firmware_from(firmware); });
    return open_by_library<FalconDevice, Ftdi>(choice, scene, library, settings, timing);
}

}  // namespace palpate::devices
