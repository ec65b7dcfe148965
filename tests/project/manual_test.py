#!/usr/bin/env python3
"""The manual has a page for every command and an entry for every option; bash completes them; the
files for desktops can be parsed. Usage: manual_test.py PROGRAM MANUAL DESKTOP_FOLDER"""

import configparser
import re
import subprocess
import sys
import xml.etree.ElementTree
from pathlib import Path

program, manual, desktop = map(Path, sys.argv[1:4])


def options_of(*command):
    lines = subprocess.run([program, *command, "--help"], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    return {option for line in lines if line.startswith("  -")
            for option in re.findall(r"--[a-z][a-z-]*", line.split("  ")[1])}


def completed(*words):
    """What bash offers for the last word."""
    script = (f"source {manual}/palpate; COMP_WORDS=({' '.join(words)} ''); "
              f"COMP_CWORD={len(words)}; _palpate; echo ${{COMPREPLY[@]}}")
    return set(subprocess.run(["bash", "-c", script], check=True, capture_output=True,
                              text=True).stdout.split())


page = (manual / "man1/palpate.1").read_text()
commands = re.findall(r"^\.B ([a-z]+)$", page, re.MULTILINE)
assert {"info", "touch", "view"} <= set(commands), commands
assert set(commands) <= completed("palpate"), completed("palpate")
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
    assert found == completed("palpate", command), f"{command}: {found ^ completed('palpate', command)}"

for file in ("palpate.svg", "palpate.metainfo.xml", "palpate-mime.xml"):
    xml.etree.ElementTree.parse(desktop / file)
entry = configparser.ConfigParser(interpolation=None)
entry.read(desktop / "palpate.desktop")
mime = (desktop / "palpate-mime.xml").read_text()
for kind in entry["Desktop Entry"]["MimeType"].rstrip(";").split(";"):
    assert kind in ("application/dicom", "image/tiff") or kind in mime, kind
print(f"manual: {len(commands)} commands")
