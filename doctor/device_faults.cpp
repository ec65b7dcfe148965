// Devices: plugged in, permitted, awake, with their library or service.
#include <fmt/format.h>

#include <algorithm>

#include "doctor/access.hpp"
#include "doctor/faults.hpp"
#include "doctor/usb.hpp"

namespace palpate::doctor {
namespace {

using Through = KnownUsb::Through;

const devices::DeviceFinding* finding_of(const Facts& facts, const std::string& name) {
    const auto found = std::ranges::find(facts.devices, name, &devices::DeviceFinding::name);
    return found == facts.devices.end() ? nullptr : &*found;
}

std::string called(const UsbDevice& device, const KnownUsb& kind) {
    return device.name.empty() ? kind.name : fmt::format("{} ({})", kind.name, device.name);
}

/// The node that this person's programs have to open, if they may not.
const Node* closed_node(const UsbDevice& device, const KnownUsb& kind, const Account& account) {
    if (kind.through == Through::usb && !may_open(device.node, account)) return &device.node;
    if (kind.through != Through::port) return nullptr;
    const auto closed = std::ranges::find_if(
        device.ports, [&](const Node& port) { return !may_open(port, account); });
    return closed == device.ports.end() ? nullptr : &*closed;
}

/// A udev rule below 73, where the tag uaccess gives a device to the person at the screen.
std::string by_rule(const UsbDevice& device, const Node& node) {
    const bool is_hidraw = node.path.starts_with("/dev/hidraw");  // below the device of the numbers
    return fmt::format(
        "echo 'SUBSYSTEM==\"{0}\", {1}{{idVendor}}==\"{2}\", {1}{{idProduct}}==\"{3}\", "
        "TAG+=\"uaccess\"' | sudo tee -a /etc/udev/rules.d/70-palpate.rules; sudo "
        "udevadm control --reload; plug it in again",
        is_hidraw ? "hidraw" : "usb", is_hidraw ? "ATTRS" : "ATTR", device.vendor, device.product);
}

Fault forbidden(const UsbDevice& device, const KnownUsb& kind, const Node& node,
                const Facts& facts) {
    const std::string by_group = way_to_node(node, facts);
    return {"device-permission", true,
            fmt::format("{} is plugged in, but you may not open it ({})", called(device, kind),
                        node.path),
            by_group.empty() ? by_rule(device, node) : by_group};
}

/// The vendor's library is there, but not what it was built for.
bool lacks_terminal_libraries(const devices::DeviceFinding& finding) {
    return finding.missing.find("libncurses.so.5") != std::string::npos ||
           finding.missing.find("libtinfo.so.5") != std::string::npos;
}

Fault without_backend(const UsbDevice& device, const KnownUsb& kind,
                      const devices::DeviceFinding& finding) {
    const bool by_service = kind.through == Through::service;
    return {by_service ? "device-service" : "device-library", true,
            fmt::format("{} is plugged in, but its {} does not answer: {}", called(device, kind),
                        by_service ? "service" : "library", finding.missing),
            lacks_terminal_libraries(finding) ? "sudo apt install libncurses5 libtinfo5"
            : kind.backend == std::string_view("falcon")
                ? fmt::format("sudo apt install libftdi1-2; {}", kind.firmware)
            : by_service
                ? "sudo apt install spacenavd; sudo systemctl enable --now spacenavd"
                : fmt::format("install the vendor's library (docs/devices/{}.md){}{}", kind.backend,
                              kind.firmware ? "; " : "", kind.firmware ? kind.firmware : "")};
}

void judge_plugged(const UsbDevice& device, const Facts& facts, std::vector<Fault>& faults) {
    const KnownUsb* const kind = known(device);
    if (!kind) return;
    const Node* const closed = closed_node(device, *kind, facts.account);
    if (closed) faults.push_back(forbidden(device, *kind, *closed, facts));
    // A library that opens the bus finds nothing there as long as it may not.
    const bool is_explained = closed != nullptr && kind->through == Through::usb;
    const auto* const finding = finding_of(facts, kind->backend);
    if (finding && !finding->found && !is_explained)
        faults.push_back(without_backend(device, *kind, *finding));
    if (kind->through == Through::port && device.ports.empty()) {
        faults.push_back(
            {"device-port", true,
             called(device, *kind) +
                 " is plugged in, but has neither a serial port nor a hidraw node: the "
                 "kernel's drivers cdc_acm and usbhid are not loaded",
             "sudo modprobe -a cdc_acm usbhid; plug it in again"});
    }
    if (kind->through != Through::service && device.may_sleep) {
        faults.push_back({"device-sleep", false,
                          called(device, *kind) +
                              " may be put to sleep by the kernel while it is not used, and then "
                              "answers late",
                          fmt::format("echo on | sudo tee {}/power/control", device.folder)});
    }
}

}  // namespace

std::vector<Fault> device_faults(const Facts& facts) {
    std::vector<Fault> faults;
    for (const UsbDevice& device : facts.machine.usb) judge_plugged(device, facts, faults);
    const auto* const wanted = finding_of(facts, facts.wanted_device);
    if (wanted && !wanted->found) {
        faults.push_back({"device-missing", true,
                          fmt::format("{} cannot be used: {}", wanted->name, wanted->missing),
                          fmt::format("see docs/devices/{}.md: is it plugged in and switched on, "
                                      "and is its library or service installed?",
                                      wanted->name)});
    }
    return faults;
}

}  // namespace palpate::doctor
