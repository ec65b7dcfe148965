// Finds and opens the device `spacenav`: its options and errors.
#include "devices/spacenav/spacenav.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "devices/opening.hpp"
#include "devices/spacenav/mouse.hpp"

namespace palpate::devices {
namespace {

/// Paths of the socket: the one asked for, or else the usual ones.
std::vector<std::string> paths_from(const std::string& asked) {
    if (!asked.empty()) return {asked};
    const char* environment = std::getenv("SPNAV_SOCKET");
    std::ifstream file("/etc/spnavrc", std::ios::binary);
    const std::string configuration{std::istreambuf_iterator<char>(file), {}};
    return spacenav::socket_paths(environment ? environment : "", configuration);
}

}  // namespace

DeviceFinding spacenav::find() {
    return finding_of("spacenav",
                      "socket=/var/run/spnav.sock,speed=100 [mm/s],turn=90 [degrees/s],full=350",
                      [](DeviceFinding& finding) {
                          Socket socket;
                          finding.what = "spacenavd at " + connect_to_any(socket, paths_from(""));
                          finding.found = true;
                      });
}

std::unique_ptr<spacenav::Mouse> spacenav::open(const DeviceChoice& choice,
                                                const DeviceScene& scene, const Timing& timing) {
    DeviceOptions options(choice, "socket");
    const std::string asked = options.text("socket", "");
    Feel feel;
    feel.speed = options.number("speed", feel.speed, 1, 1000);
    feel.turn = options.number("turn", feel.turn, 0, 360);
    feel.deflection = options.number("full", feel.deflection, 1, 10000);
    options.finish();
    return with_name(choice, [&] {
        std::vector<std::string> paths = paths_from(asked);
        Socket socket;
        const std::string path = connect_to_any(socket, paths);
        return std::make_unique<Mouse>(std::move(socket), path, std::move(paths), feel, scene.rate,
                                       timing);
    });
}

}  // namespace palpate::devices
