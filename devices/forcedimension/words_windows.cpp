// How Force Dimension's library is called and installed. Windows.
#include "devices/forcedimension/words.hpp"

namespace palpate::devices::forcedimension {

std::vector<std::string> library_names() {
    return {"drd64.dll", "dhd64.dll"};
}

const char* const names_in_words = "drd64.dll or dhd64.dll";

const char* const how_to_install =
    "install Force Dimension's SDK for Windows and put its drd64.dll (and dhd64.dll) beside the "
    "program or in the PATH, or tell where it is: library=PATH";

const char* const how_to_attach = "connect it, switch it on and install the SDK's USB driver";

}  // namespace palpate::devices::forcedimension
