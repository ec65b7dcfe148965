// The devices on USB: which are plugged in, which of them Palpate knows, and who may open them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "doctor/facts.hpp"

namespace palpate::doctor {

/// A device that Palpate can use, as it shows on USB.
struct KnownUsb {
    const char* vendor;
    const char* product;  ///< null: every one of this vendor
    const char* backend;  ///< its name for --device
    const char* name;     ///< for people
    /// By what Palpate's backend reaches it.
    enum class Through : std::uint8_t {
        usb,      ///< the vendor's library opens the device on the bus
        port,     ///< the vendor's library opens a serial port or a hidraw node
        service,  ///< a service opens it, as root
    } through;
    const char* firmware;  ///< a hint for a device that does not answer; null: none
};

/// Null for a device that is not ours.
const KnownUsb* known(const UsbDevice& device);

/// One that is ours, in words.
struct PluggedIn {
    std::string backend;  ///< its name for --device
    std::string name;     ///< for people, with its numbers and what it calls itself
};
std::vector<PluggedIn> plugged_in(const std::vector<UsbDevice>& devices);

/// The devices below root/sys/bus/usb/devices, hubs too.
std::vector<UsbDevice> read_usb(const std::filesystem::path& root);

/// Mode, owner and group of root + path; `opens` for the machine itself only, since access() says
/// nothing about a folder of files that were made up.
Node node_at(const std::filesystem::path& root, const std::string& path);

}  // namespace palpate::doctor
