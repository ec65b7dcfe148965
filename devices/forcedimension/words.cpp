// How Force Dimension's library is called and installed. Linux.
#include "devices/forcedimension/dhd.hpp"

namespace palpate::devices::forcedimension {

VendorWords words() {
    // The first one that is there is taken: libdrd holds all of libdhd.
    return {.names = {"libdrd.so.3", "libdrd.so", "libdhd.so.3", "libdhd.so"},
            .usual = "libdrd.so.3 or libdhd.so.3",
            .how_to_install =
                "install Force Dimension's SDK for Linux (libdrd.so.3, libdhd.so.3) where the "
                "loader finds it, "
                "or tell where it is: library=PATH",
            .how_to_attach =
                "connect it and switch it on; your account must be able to open its USB device "
                "(the SDK's udev "
                "rule, 51-forcedimension.rules)"};
}

}  // namespace palpate::devices::forcedimension
