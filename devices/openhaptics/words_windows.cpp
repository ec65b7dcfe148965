// How OpenHaptics is called and installed. Windows.
#include "devices/openhaptics/hd.hpp"

namespace palpate::devices::openhaptics {

VendorWords words() {
    return {.names = {"HD.dll"},
            .usual = "HD.dll",
            .how_to_install =
                "install 3D Systems' OpenHaptics and the Touch (or PHANToM) device driver for "
                "Windows (64 "
                "bit), "
                "or tell where the library is: library=PATH",
            .how_to_attach =
                "connect and switch on the device and set it up with the vendor's program (its "
                "name there, if "
                "it is not the default one: name=NAME)"};
}

}  // namespace palpate::devices::openhaptics
