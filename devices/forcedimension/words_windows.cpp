// How Force Dimension's library is called and installed. Windows.
#include "devices/forcedimension/dhd.hpp"

namespace palpate::devices::forcedimension {

VendorWords words() {
    return {.names = {"drd64.dll", "dhd64.dll"},
            .usual = "drd64.dll or dhd64.dll",
            .how_to_install =
                "install Force Dimension's SDK for Windows and put its drd64.dll (and dhd64.dll) "
                "beside the "
                "program or in the PATH, or tell where it is: library=PATH",
            .how_to_attach = "connect it, switch it on and install the SDK's USB driver"};
}

}  // namespace palpate::devices::forcedimension
