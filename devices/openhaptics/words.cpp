// How OpenHaptics is called and installed. Linux.
#include "devices/openhaptics/hd.hpp"

namespace palpate::devices::openhaptics {

VendorWords words() {
    return {
        .names = {"libHD.so", "libHD.so.3.4"},
        .usual = "libHD.so",
        .how_to_install =
            "install 3D Systems' OpenHaptics and the Touch (or PHANToM) device driver for Linux "
            "and what "
            "they need (apt install libncurses5 libtinfo5), or tell where the library is: "
            "library=PATH",
        .how_to_attach =
            "connect and switch on the device and set it up with the vendor's program (its name "
            "there, if "
            "it is not the default one: name=NAME); your account must be able to open it: "
            "/dev/ttyACM*, /dev/hidraw* or, a Touch of 2023 or later (2988:0304), its file below "
            "/dev/bus/usb (the driver's udev rule)"};
}

}  // namespace palpate::devices::openhaptics
