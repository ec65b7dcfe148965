#!/usr/bin/env python3
"""The udev rules give a person at the screen access to each device, and to no other."""

import fnmatch
import re
import sys
import unittest
from pathlib import Path

RULES = Path(sys.argv.pop(1)).read_text(encoding="utf-8")


def rules():
    for line in RULES.splitlines():
        if line and not line.startswith("#"):
            yield re.findall(r'(\w+)(?:\{(\w+)\})?([=!:+]=|=)"([^"]*)"(?:,\s*|$)', line), line


def holds(match, event):
    key, name, operator, value = match
    of = {"SUBSYSTEM": lambda: [event["subsystem"]], "KERNEL": lambda: [event["kernel"]], "ACTION": lambda: ["add"],
          "ENV": lambda: [event.get("env", {}).get(name, "")],
          # ATTR is of the device itself, ATTRS of it or one that it is plugged into.
          "ATTR": lambda: [event.get("attributes", {}).get(name, "")],
          "ATTRS": lambda: [a.get(name, "") for a in (event.get("attributes", {}), event.get("parent", {}))]}[key]()
    found = any(fnmatch.fnmatchcase(text, value) for text in of)
    return found if operator == "==" else not found


def tags(event):
    given = set()
    for parts, line in rules():
        assert parts, line
        matches = [p for p in parts if p[2] in ("==", "!=")]
        if all(holds(m, event) for m in matches):
            given |= {value for key, _, operator, value in parts if (key, operator) == ("TAG", "+=")}
            if any(key == "GOTO" for key, *_ in parts):
                return given
    return given


def on_the_bus(vendor, product):
    return {"subsystem": "usb", "kernel": "1-2", "env": {"DEVTYPE": "usb_device"},
            "attributes": {"idVendor": vendor, "idProduct": product}}


def behind(subsystem, kernel, vendor, product):
    return {"subsystem": subsystem, "kernel": kernel, "parent": {"idVendor": vendor, "idProduct": product}}


class Rules(unittest.TestCase):
    def test_each_device_may_be_opened(self):
        for name, event in {
                "serial Touch": behind("tty", "ttyACM0", "2988", "0302"),
                "HID Touch": behind("hidraw", "hidraw0", "2988", "0302"),
                "USB Touch": on_the_bus("2988", "0304"),
                "omega": on_the_bus("1451", "0402"), "sigma": on_the_bus("1451", "0403"),
                "lambda": on_the_bus("1451", "040c"), "Falcon": on_the_bus("0403", "cb48"),
                "SpaceMouse": behind("hidraw", "hidraw0", "256f", "c635"),
                "SpaceNavigator": behind("input", "event7", "046d", "c626")}.items():
            with self.subTest(name):
                self.assertEqual(tags(event), {"uaccess"})

    def test_no_other_device_is_opened(self):
        for event in (on_the_bus("0403", "6001"), behind("tty", "ttyACM0", "2341", "0043"),
                      behind("hidraw", "hidraw0", "046d", "c52b"), behind("input", "mouse0", "256f", "c635")):
            self.assertEqual(tags(event), set())


if __name__ == "__main__":
    unittest.main()
