// How libftdi is called and installed. Windows.
#include "devices/falcon/words.hpp"

namespace palpate::devices::falcon {

std::vector<std::string> library_names() {
    return {"libftdi1.dll"};
}

const char* const how_to_install =
    "put libftdi1.dll and libusb-1.0.dll beside the program or in the PATH, or tell where it is: "
    "library=PATH";

const char* const how_to_attach =
    "connect it and its power supply, and install the driver WinUSB for it";

}  // namespace palpate::devices::falcon
