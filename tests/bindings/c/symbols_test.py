#!/usr/bin/env python3
"""libpalpate-c exports the functions that its header declares, under their version, and no other
symbol of its own."""

import pathlib
import re
import subprocess
import sys

nm, library, root = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
header = (root / "include/palpate-c/palpate.h").read_text(encoding="utf-8")
declared = set(re.findall(r"^PALPATE_API [^;(]*?\b(palpate_\w+)\(", header, re.MULTILINE))
versions = re.findall(r"^(PALPATE_[\d.]+) \{(.*?)^\}", (root / "bindings/c/palpate-c.map").read_text(),
                      re.MULTILINE | re.DOTALL)
listed = {name: version for version, names in versions
          for name in re.findall(r"^ +(palpate_\w+);", names, re.MULTILINE)}
output = subprocess.run([nm, "-D", "--defined-only", "--with-symbol-versions", library], check=True,
                        capture_output=True, text=True).stdout
exported = {line.split()[2] for line in output.splitlines() if line.split()[1] != "A"}
wanted = {f"{name}@@{version}" for name, version in listed.items()}
problems = []
if len(declared) < 50:
    problems.append(f"the header declares {len(declared)} functions: is the pattern right?")
problems += [f"declared, not in palpate-c.map: {name}" for name in sorted(declared - set(listed))]
problems += [f"in palpate-c.map, not declared: {name}" for name in sorted(set(listed) - declared)]
problems += [f"not exported: {name}" for name in sorted(wanted - exported)]
problems += [f"exported, not listed: {name}" for name in sorted(exported - wanted)]
if problems:
    sys.exit("\n".join(problems))
print(f"{len(exported)} functions, nothing else")
