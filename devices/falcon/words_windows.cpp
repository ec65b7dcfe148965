// How libftdi is called and installed. Windows.
#include "devices/falcon/ftdi.hpp"

namespace palpate::devices::falcon {

VendorWords words() {
    return {
        .names = {"libftdi1.dll"},
        .usual = "libftdi1.dll",
        .how_to_install =
            "put libftdi1.dll and libusb-1.0.dll beside the program or in the PATH, or tell where "
            "it is: "
            "library=PATH",
        .how_to_attach = "connect it and its power supply, and install the driver WinUSB for it"};
}

}  // namespace palpate::devices::falcon
