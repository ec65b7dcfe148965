#!/usr/bin/env python3
"""The manual has a page for every command and an entry for every option; bash completes them; the
files for desktops can be parsed. Usage: manual_test.py PROGRAM MANUAL DESKTOP_FOLDER"""

import configparser
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
from pathlib import Path

program, manual, desktop = map(Path, sys.argv[1:4])


def options_of(*command):
    lines = subprocess.run([program, *command, "--help"], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    return {option for line in lines if line.startswith("  -")
            for option in re.findall(r"--[a-z][a-z-]*", line.split("  ")[1])}


def completed(line):
    """What bash offers at the end of the line."""
    script = (f"source {manual.resolve()}/palpate; COMP_LINE='{line}'; COMP_POINT={len(line)}; _palpate; "
              'printf "%s\\n" "${COMPREPLY[@]}"')
    with tempfile.TemporaryDirectory() as folder:
        for name in ("a.ply", "a.csv", "a.png", "head.nrrd"):
            (Path(folder) / name).touch()
        (Path(folder) / "scans").mkdir()
        out = subprocess.run(["bash", "-c", script], check=True, capture_output=True, text=True,
                             cwd=folder)
    assert out.stderr == "", out.stderr
    return set(out.stdout.split())


page = (manual / "man1/palpate.1").read_text()
commands = re.findall(r"^\.B ([a-z]+)$", page, re.MULTILINE)
assert {"info", "touch", "view"} <= set(commands), commands
assert set(commands) <= completed("palpate "), completed("palpate ")
assert completed("palpate ex") == {"extract"}
for command in commands:
    page = (manual / f"man1/palpate-{command}.1").read_text()
    assert page.startswith(f".TH PALPATE-{command.upper()} 1"), page[:60]
    assert not re.search(r"^[.'](?![A-Z]{2}|B |fi|nf)", page, re.MULTILINE), f"{command}: no macro"
    found = options_of(command)
    assert "--help" in found
    entries = page.replace(r"\-", "-")
    missing = [option for option in found
               if not re.search(rf"^\.B .*{option}", entries, re.MULTILINE)]
    assert not missing, f"{command}: {missing} are not in the manual"
    bare = re.findall(r"^\.B (.*)\n\.", page, re.MULTILINE)
    assert not bare, f"{command}: {bare} have no text of their own"
    assert not re.search(r"^\.B \S*\{", page, re.MULTILINE), f"{command}: the value of a flag stands behind [="
    offered = completed(f"palpate {command} -")
    assert found == offered, f"{command}: {found ^ offered}"

VALUES = {  # line: what is offered, and nothing else
    "extract head.nrrd --field ": {"cubic", "linear"},
    "extract head.nrrd --field=l": {"linear"},
    "extract head.nrrd --solid a": {"above"},
    "extract head.nrrd -o ": {"a.ply", "scans"},
    "render head.nrrd --output ": {"a.png", "scans"},
    "replay head.nrrd --trajectory ": {"a.csv", "scans"},
    "replay head.nrrd --method gradient-": {"gradient-improved"},
    "touch head.nrrd --device sim": {"simulated"},
    "demo -o ": {"scans"},
    "info synthetic:tor": {"torus"},
    "info he": {"head.nrrd"},
    "info head.nrrd --smooth ": set(),
    "touch head.nrrd --facing l": {"left"},
    "tool burr": {"burr:"},
}
if "--seeds" in options_of("evaluate"):  # a build with Python
    VALUES |= {"evaluate dr": {"drift"}, "evaluate a": {"all"}, "evaluate drift -o ": {"scans"},
               "evaluate walk-through --method gradient-": {"gradient-improved"},
               "study he": {"head.nrrd"}, "study --analyse ": {"a.csv", "scans"}, "study --stan": {"--standard"},
               "ros head.nrrd --ros ": {"1", "2"}, "distribute a b --compression g": {"gzip"}}
for line, values in VALUES.items():
    assert completed(f"palpate {line}") == values, (line, completed(f"palpate {line}"))
assert "ct-bone-drilling" in completed("palpate replay head.nrrd --layers ct-b")
assert {"synthetic:sphere", "head.nrrd", "scans"} <= completed("palpate info ")

for file in ("palpate.svg", "palpate.metainfo.xml", "palpate-mime.xml"):
    xml.etree.ElementTree.parse(desktop / file)
entry = configparser.ConfigParser(interpolation=None)
entry.read(desktop / "palpate.desktop")
mime = (desktop / "palpate-mime.xml").read_text()
for kind in entry["Desktop Entry"]["MimeType"].rstrip(";").split(";"):
    assert kind in ("application/dicom", "image/tiff") or kind in mime, kind
print(f"manual: {len(commands)} commands")
