// How libftdi is called and installed. Linux.
#include "devices/falcon/ftdi.hpp"

namespace palpate::devices::falcon {

VendorWords words() {
    return {.names = {"libftdi1.so.2"},
            .usual = "libftdi1.so.2",
            .how_to_install = "sudo apt install libftdi1-2, or tell where it is: library=PATH",
            .how_to_attach =
                "connect it and its power supply; your account must be able to open its USB device "
                "(0403:cb48): Palpate's package has a udev rule"};
}

}  // namespace palpate::devices::falcon
