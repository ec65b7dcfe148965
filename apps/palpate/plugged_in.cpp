// Devices that are plugged in, as the doctor knows them. Linux.
#include "apps/palpate/plugged_in.hpp"

#include "doctor/usb.hpp"

namespace palpate::app {

std::vector<std::string> plugged_in(const std::string& backend) {
    std::vector<std::string> names;
    for (const doctor::PluggedIn& device : doctor::plugged_in(doctor::read_usb("/"))) {
        if (device.backend == backend) names.push_back(device.name);
    }
    return names;
}

}  // namespace palpate::app
