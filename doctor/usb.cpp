// Reads /sys/bus/usb/devices, and has the table of the devices that Palpate can use. The numbers
// are those of the vendors' udev rules and of the drivers named in docs/devices; no Haply device is
// in it, because its numbers are not published.
#include "doctor/usb.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace palpate::doctor {
namespace {

namespace fs = std::filesystem;
using Through = KnownUsb::Through;

constexpr const char* falcon_firmware =
    "a Falcon needs its vendor's firmware after each power-up: firmware=PATH";
constexpr const char* touch_firmware =
    "run the vendor's Touch Diagnostic once: it pairs and calibrates the device";

constexpr const char* dimension_firmware =
    "run the SDK's own example (HapticInit) first: a device that it cannot initialise needs the "
    "vendor's firmware update";

// If there are two rows for a vendor, the one with a product comes first.
constexpr std::array<KnownUsb, 20> table{{
    {"1451", "0402", "forcedimension", "Force Dimension omega", Through::usb, dimension_firmware},
    {"1451", "0403", "forcedimension", "Force Dimension sigma", Through::usb, dimension_firmware},
    {"1451", "040c", "forcedimension", "Force Dimension lambda", Through::usb, dimension_firmware},
    {"1451", nullptr, "forcedimension", "Force Dimension device", Through::usb, dimension_firmware},
    {"0403", "cb48", "falcon", "Novint Falcon", Through::usb, falcon_firmware},
    {"2988", "0304", "openhaptics", "3D Systems Touch (USB)", Through::usb, touch_firmware},
    {"2988", nullptr, "openhaptics", "3D Systems Touch", Through::port, touch_firmware},
    {"0301", "2988", "openhaptics", "3D Systems Touch", Through::port, touch_firmware},
    {"256f", nullptr, "spacenav", "3Dconnexion mouse", Through::service, nullptr},
    {"046d", "c603", "spacenav", "3Dconnexion SpaceMouse", Through::service, nullptr},
    {"046d", "c605", "spacenav", "3Dconnexion CADman", Through::service, nullptr},
    {"046d", "c606", "spacenav", "3Dconnexion SpaceMouse Classic", Through::service, nullptr},
    {"046d", "c621", "spacenav", "3Dconnexion SpaceBall 5000", Through::service, nullptr},
    {"046d", "c623", "spacenav", "3Dconnexion SpaceTraveler", Through::service, nullptr},
    {"046d", "c625", "spacenav", "3Dconnexion SpacePilot", Through::service, nullptr},
    {"046d", "c626", "spacenav", "3Dconnexion SpaceNavigator", Through::service, nullptr},
    {"046d", "c627", "spacenav", "3Dconnexion SpaceExplorer", Through::service, nullptr},
    {"046d", "c628", "spacenav", "3Dconnexion SpaceNavigator", Through::service, nullptr},
    {"046d", "c629", "spacenav", "3Dconnexion SpacePilot Pro", Through::service, nullptr},
    {"046d", "c62b", "spacenav", "3Dconnexion SpaceMouse Pro", Through::service, nullptr},
}};

std::string first_line(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    line.resize(std::min<std::size_t>(line.size(), 200));
    // The name of a device is foreign text, and is printed on a terminal.
    std::erase_if(line, [](unsigned char c) { return c < ' ' || c == 0x7F; });
    return line;
}

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// Three digits, as in /dev/bus/usb/001/004.
std::string place(const std::string& number) {
    const unsigned long value = std::strtoul(number.c_str(), nullptr, 10);
    std::array<char, 24> text{};
    std::snprintf(text.data(), text.size(), "%03lu", value);
    return text.data();
}

void add_nodes(std::vector<Node>& nodes, const fs::path& root, const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        nodes.push_back(node_at(root, "/dev/" + i->path().filename().string()));
    }
}

/// The serial ports and hidraw nodes of a device, below the folders of its interfaces:
/// 1-2:1.0/tty/ttyACM0, 1-2:1.0/0003:2988:0302.0001/hidraw/hidraw0.
std::vector<Node> ports_of(const fs::path& root, const fs::path& device) {
    std::vector<Node> ports;
    std::error_code error;
    const std::string own = device.filename().string() + ":";
    for (fs::directory_iterator i(device.parent_path(), error), end; !error && i != end;
         i.increment(error)) {
        if (i->path().filename().string().rfind(own, 0) != 0) continue;
        add_nodes(ports, root, i->path() / "tty");
        std::error_code none;
        for (fs::directory_iterator hid(i->path(), none), last; !none && hid != last;
             hid.increment(none)) {
            add_nodes(ports, root, hid->path() / "hidraw");
        }
    }
    std::ranges::sort(ports, {}, &Node::path);
    return ports;
}

}  // namespace

const KnownUsb* known(const UsbDevice& device) {
    const auto* const found = std::ranges::find_if(table, [&](const KnownUsb& one) {
        return device.vendor == one.vendor &&
               (one.product == nullptr || device.product == one.product);
    });
    return found == table.end() ? nullptr : found;
}

std::vector<PluggedIn> plugged_in(const std::vector<UsbDevice>& devices) {
    std::vector<PluggedIn> found;
    for (const UsbDevice& device : devices) {
        const KnownUsb* const kind = known(device);
        if (!kind) continue;
        std::string name = std::string(kind->name) + ", " + device.vendor + ":" + device.product;
        if (!device.name.empty()) name += ", calls itself " + device.name;
        found.push_back({kind->backend, name});
    }
    return found;
}

Node node_at(const fs::path& root, const std::string& path) {
    Node node;
    node.path = path;
    struct stat status {};
    const fs::path file = root / fs::path(path).relative_path();
    if (::stat(file.c_str(), &status) != 0) return node;
    node.mode = status.st_mode & 0777U;
    node.owner = status.st_uid;
    node.group = status.st_gid;
    node.opens = root == "/" && ::access(file.c_str(), R_OK | W_OK) == 0;
    return node;
}

std::vector<UsbDevice> read_usb(const fs::path& root) {
    std::vector<UsbDevice> devices;
    std::error_code error;
    for (fs::directory_iterator i(root / "sys/bus/usb/devices", error), end; !error && i != end;
         i.increment(error)) {
        const fs::path& folder = i->path();
        UsbDevice device;
        device.vendor = lower(first_line(folder / "idVendor"));
        if (device.vendor.empty()) continue;  // an interface
        device.product = lower(first_line(folder / "idProduct"));
        device.name = first_line(folder / "product");
        device.folder = "/sys/bus/usb/devices/" + folder.filename().string();
        device.node = node_at(root, "/dev/bus/usb/" + place(first_line(folder / "busnum")) + "/" +
                                        place(first_line(folder / "devnum")));
        device.ports = ports_of(root, folder);
        device.may_sleep = first_line(folder / "power/control") == "auto";
        devices.push_back(device);
    }
    std::ranges::sort(devices, {}, &UsbDevice::folder);
    return devices;
}

}  // namespace palpate::doctor
