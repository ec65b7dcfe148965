#!/usr/bin/env python3
"""Compares the functions and names of the backends with docs/devices/interfaces.md, both ways."""

import re
import sys
import unittest
from pathlib import Path

ROOT = Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/devices/interfaces.md").read_text(encoding="utf-8")

# The vendors' names of types, and ours, as plain C.
TYPES = {"uchar": "unsigned char", "ushort": "unsigned short", "uint": "unsigned int",
         "HHD": "unsigned int", "HDenum": "unsigned int", "HDerror": "unsigned int", "HDint": "int",
         "HDdouble": "double", "HDstring": "const char*", "HDushort": "unsigned short",
         "HDSchedulerHandle": "unsigned long", "HDErrorInfo": "ErrorInfo", "Handle": "unsigned int",
         "HDSchedulerCallback": "unsigned int(*)(void*)", "Callback": "unsigned int(*)(void*)",
         "ftdi_context": "void", "ftdi_device_list": "void", "ftdi_bits_type": "int",
         "ftdi_stopbits_type": "int", "ftdi_parity_type": "int"}
ARGUMENTS = r"((?:[^()]|\([^()]*\))*)"


def section(name):
    return re.search(rf"^## {name}$(.*?)(?=^## |\Z)", PAGE, re.S | re.M).group(1)


def source(name):
    return (ROOT / name).read_text(encoding="utf-8")


def plain(kind):
    """A type without an argument's name: `double matrix[3][3]` is `double(*)[3]`."""
    kind = re.sub(r"\w+\[\w+\]\[(\w+)\]$", r"(*)[\1]", kind.strip())
    kind = re.sub(r"\w+\[\w+\]$", "*", kind)
    kind = re.sub(r"\(\*\w+\)", "(*)", kind)
    kind = re.sub(r"(?<=[\w*] )\w+$|(?<=[*&])\w+$",
                  lambda m: m.group() if m.group() in ("int", "char", "long", "short") else "", kind)
    kind = re.sub(r"\w+", lambda m: TYPES.get(m.group(), m.group()), kind)
    return re.sub(r"\s*([*()\[\]])\s*", r"\1", kind).strip()


def signature(result, arguments):
    parts = re.split(r",(?![^()]*\))", " ".join(arguments.split()))
    return plain(result) + "(" + ", ".join(plain(p) for p in parts if p.strip()) + ")"


def functions_of_page(name):
    lines = re.search(r"```c\n(.*?)```", section(name), re.S).group(1).splitlines()
    found = [re.fullmatch(rf"(.*?)(\w+)\({ARGUMENTS}\)", line).groups() for line in lines]
    return {function: signature(result, arguments) for result, function, arguments in found}


def functions_of_backend(header, loader):
    members = {name: signature(result, arguments) for result, name, arguments in
               re.findall(rf"^    ([\w *]+?)\(\*(\w+)\)\({ARGUMENTS}\);", source(header), re.M)}
    looked_up = re.findall(r'library\.(?:need|take)\((\w+), "(\w+)"\)', source(loader))
    assert sorted(members) == sorted(member for member, _ in looked_up), "declared and looked up"
    return {function: members[member] for member, function in looked_up}


def functions_of_stand_in(name):
    found = re.findall(rf"^MOCK_EXPORT ([\w *:]+?)((?:dhd|drd|hd)[A-Z]\w+|ftdi_\w+)\({ARGUMENTS}\) \{{", source(name), re.M)
    return {function: signature(result, arguments) for result, function, arguments in found}


def constants_of_page(name):
    return {constant: int(value, 0) for constant, value in
            re.findall(r"^\| `(\w+)` \| (\w+) \|", section(name), re.M)}


def constants_of_header(name):
    """`position = 0x2050;  // HD_CURRENT_POSITION`. Those without a vendor's name are marked `ours`."""
    found = {}
    for line in source(name).splitlines():
        number = re.search(r"\b\w+ = (0x[0-9A-Fa-f]+|\d+)\b", line)
        if number and "// ours" not in line and not re.search(r"^\s*(double|Vec3|bool)\b", line):
            vendor = re.search(r"// ([A-Z][A-Z0-9_]{3,})\b", line)
            assert vendor, f"{name}: no vendor's name beside: {line.strip()}"
            found[vendor.group(1)] = int(number.group(1), 0)
    return found


class Interface:
    longMessage = True
    maxDiff = None
    constants = 10  # at least

    def test_the_functions_that_are_declared_and_looked_up_are_those_of_the_page(self):
        self.assertGreater(len(functions_of_page(self.name)), 10)
        self.assertEqual(functions_of_backend(self.header, self.loader), functions_of_page(self.name))

    def test_the_constants_are_those_of_the_page(self):
        self.assertGreater(len(constants_of_page(self.name)), self.constants)
        self.assertEqual(constants_of_header(self.header), constants_of_page(self.name))

    def test_the_stand_in_exports_what_the_page_says(self):
        self.assertEqual(functions_of_stand_in(self.stand_in), functions_of_page(self.name))


class ForceDimension(Interface, unittest.TestCase):
    name, stand_in = "Force Dimension", "tests/devices/forcedimension/mock_dhd.cpp"
    header, loader = "devices/forcedimension/dhd.hpp", "devices/forcedimension/dhd.cpp"


class OpenHaptics(Interface, unittest.TestCase):
    name, stand_in = "OpenHaptics", "tests/devices/openhaptics/mock_hd.cpp"
    header, loader = "devices/openhaptics/hd.hpp", "devices/openhaptics/hd.cpp"


class Libftdi(Interface, unittest.TestCase):
    name, stand_in, constants = "libftdi", "tests/devices/falcon/mock_ftdi.cpp", 3
    header, loader = "devices/falcon/ftdi.hpp", "devices/falcon/ftdi.cpp"


class Spacenavd(unittest.TestCase):
    def test_the_numbers_are_those_of_the_page(self):
        named = re.findall(r"= (\w+)[,;]\s*// ((?:UEV|REQ)_\w+)", source("devices/spacenav/puck.hpp"))
        self.assertEqual({name: int(value, 0) for value, name in named}, constants_of_page("spacenavd"))


class Haply(unittest.TestCase):
    # What the messages and we ourselves say in words of the same form.
    OTHERS = {"palpate", "inverse", "inverse3", "mount", "handedness", "basis", "preset", "transform"}

    def test_the_members_are_those_of_the_page(self):
        page = set(re.findall(r"`(\w+)`", section("Haply")))
        used = set(re.findall(r'"([a-z_]+)"', source("devices/haply/protocol.cpp")))
        self.assertEqual(page - used, set(), "on the page only")
        self.assertEqual(used - page - self.OTHERS, set(), "in the source only")


if __name__ == "__main__":
    unittest.main()
