#!/usr/bin/env python3
"""Every parameter of a test is listed as words. GoogleTest lists bytes or an address where it knows no better; an
operator<< of the parameter mends that (tests/support/parameter.hpp)."""

import os
import re
import subprocess
import sys
from pathlib import Path

programs = [path for path in sorted(Path(sys.argv[1]).glob("tests/**/*_tests"))
            if path.is_file() and os.access(path, os.X_OK)]
parameters, problems = 0, []
for program in programs:
    listed = subprocess.run([program, "--gtest_list_tests"], check=True, capture_output=True, text=True,
                            env=os.environ | {"QT_QPA_PLATFORM": "offscreen"}).stdout
    suite = ""
    for line in listed.splitlines():
        if not line.startswith(" "):
            suite = line.strip()
        parameters += "GetParam()" in line
        if re.search(r"\d-byte object|0x[0-9a-f]+ pointing to", line):
            problems.append(f"{program.name}: {suite}{line.strip()}")
print("\n".join(problems) or f"{parameters} parameters in {len(programs)} programs are words")
sys.exit(1 if problems or parameters == 0 else 0)
