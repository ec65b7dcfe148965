#!/usr/bin/env python3
"""Each device, as the kernel shows it: `palpate devices` and `palpate doctor` name it, and the udev rules give access.
The kernel is umockdev's: the same system calls, answered from a description of a device.

usage: plugged_in_test.py PALPATE 70-palpate.rules"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PALPATE = sys.argv.pop(1)
sys.path.insert(0, str(Path(__file__).parent))
import udev_rules_test  # noqa: E402  (takes the rules' file from the arguments)

# What lsusb shows of each device, and the node below which a program reaches it.
DEVICES = {
    "serial Touch": ("2988", "0302", "Touch", "openhaptics", "3D Systems Touch", "tty/ttyACM0"),
    "USB Touch": ("2988", "0304", "Touch", "openhaptics", "3D Systems Touch (USB)", None),
    "omega": ("1451", "0402", "omega.x haptic device", "forcedimension", "Force Dimension omega", None),
    "sigma": ("1451", "0403", "sigma.x haptic device", "forcedimension", "Force Dimension sigma", None),
    "Falcon": ("0403", "cb48", "FALCON HAPTIC", "falcon", "Novint Falcon", None),
    "SpaceMouse": ("256f", "c635", "SpaceMouse Compact", "spacenav", "3Dconnexion mouse", "hidraw/hidraw0"),
}
BUS = "/devices/pci0000:00/0000:00:14.0/usb1/1-2"


def description(vendor, product, name, node):
    """Of one device, and of its serial port or hidraw node, as umockdev-record writes it."""
    lines = [f"P: {BUS}", "N: bus/usb/001/007", "E: DEVTYPE=usb_device", "E: SUBSYSTEM=usb", f"A: idVendor={vendor}\\n",
             f"A: idProduct={product}\\n", f"A: product={name}\\n", "A: busnum=1\\n", "A: devnum=7\\n",
             "A: power/control=on\\n", "", f"P: {BUS}/1-2:1.0", "E: DEVTYPE=usb_interface", "E: SUBSYSTEM=usb",
             "A: bInterfaceClass=03\\n", ""]
    if node:
        subsystem, kernel = node.split("/")
        hid = f"/0003:{vendor.upper()}:{product.upper()}.0001" if subsystem == "hidraw" else ""
        lines += [f"P: {BUS}/1-2:1.0{hid}/{node}", f"N: {kernel}", f"E: DEVNAME=/dev/{kernel}", f"E: SUBSYSTEM={subsystem}", ""]
    return "\n".join(lines)


def with_device(text, *arguments):
    with tempfile.NamedTemporaryFile("w", suffix=".umockdev") as file:
        file.write(text + "\n")
        file.flush()
        return subprocess.run(["umockdev-run", "--device", file.name, "--", PALPATE, *arguments], capture_output=True,
                              text=True, check=False)


class PluggedIn(unittest.TestCase):
    def test_each_device_is_named_below_its_backend_and_below_no_other(self):
        for case, (vendor, product, name, backend, called, node) in DEVICES.items():
            with self.subTest(case):
                ran = with_device(description(vendor, product, name, node), "devices", "--json")
                self.assertEqual(ran.returncode, 0, ran.stderr)
                plugged = {one["name"]: one["plugged_in"] for one in json.loads(ran.stdout) if one["plugged_in"]}
                self.assertEqual(plugged, {backend: [f"{called}, {vendor}:{product}, calls itself {name}"]})

    def test_the_doctor_says_what_each_device_lacks(self):
        for case, (vendor, product, name, _, called, node) in DEVICES.items():
            with self.subTest(case):
                ran = with_device(description(vendor, product, name, node), "doctor", "--json", "--seconds", "0")
                faults = [f for f in json.loads(ran.stdout)["faults"] if f["meaning"].startswith(f"{called} ({name})")]
                self.assertEqual(len(faults), 1, ran.stdout)
                self.assertIn(faults[0]["name"], ("device-library", "device-service"))

    def test_the_rules_give_access_to_each_device(self):
        for case, (vendor, product, _, _, _, node) in DEVICES.items():
            event = udev_rules_test.behind(*node.split("/"), vendor, product) if node else \
                udev_rules_test.on_the_bus(vendor, product)
            self.assertIn("uaccess", udev_rules_test.tags(event), case)


if __name__ == "__main__":
    unittest.main()
