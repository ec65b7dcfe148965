// palpate devices: lists the devices that were found, and why others were not.
#include "palpate/devices/devices.hpp"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/plugged_in.hpp"

namespace palpate::app {
namespace {

void list_devices(bool json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    const auto found = devices::find_devices(stop_if_interrupted);
    for (const devices::DeviceFinding& device : found) {
        const std::vector<std::string> plugged = plugged_in(device.name);
        if (json) {
            list.push_back({{"name", device.name},
                            {"found", device.found},
                            {"what", device.what},
                            {"missing", device.missing},
                            {"options", device.options},
                            {"plugged_in", plugged}});
            continue;
        }
        fmt::print("{:<15} {} {}\n", device.name, device.found ? "yes" : "no ",
                   device.found ? device.what : device.missing);
        for (const std::string& one : plugged) fmt::print("{:<15}     plugged in: {}\n", "", one);
        if (!device.options.empty()) fmt::print("{:<15}     options: {}\n", "", device.options);
    }
    if (json) print_json(list);
}

}  // namespace

void add_devices(CLI::App& app) {
    auto json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand(
        "devices", "List the haptic devices that were found, and why others were not");
    command->footer(
        "Looks for the library, the service and the devices of each kind. No device "
        "moves.\n\nExample:\n  palpate devices");
    command->add_flag("--json", *json, "Print the list as JSON");
    command->callback([json] { list_devices(*json); });
}

}  // namespace palpate::app
