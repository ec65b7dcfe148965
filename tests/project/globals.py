#!/usr/bin/env python3
"""Rule 4: no globals, no singletons. The core library may hold no symbol in writable memory."""

import subprocess
import sys

import repository

# Sections that are writable when the program runs. .data.rel.ro is not: the loader closes it once
# addresses are filled in (tables of virtual functions, constant arrays of pointers).
WRITABLE = (".data", ".bss", ".tdata", ".tbss", "*COM*")
CLOSED = (".data.rel.ro",)
# Written by the compiler for exceptions, pointers that nothing changes. No name in a source has a
# dot, so this hides nothing of ours.
COMPILER = ("DW.ref.",)


def problems_in(listing):
    """Writable symbols in the output of nm --format=sysv."""
    problems = []
    source = ""
    for line in listing.splitlines():
        columns = [column.strip() for column in line.split("|")]
        if len(columns) < 7:
            if line.startswith("Symbols from"):
                source = line.removeprefix("Symbols from ").rsplit("[", 1)[-1].rstrip("]:")
            continue
        name, section = columns[0], columns[-1]
        if section.startswith(WRITABLE) and not section.startswith(CLOSED):
            if not name.startswith(COMPILER):
                problems.append(f"{source}: {name} is writable ({section})")
    return problems


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: globals.py NM LIBRARY")
    listing = subprocess.run([sys.argv[1], "--demangle", "--defined-only", "--format=sysv",
                              sys.argv[2]], check=True, capture_output=True, text=True).stdout
    if "|" not in listing:
        sys.exit(f"{sys.argv[2]}: no symbols found, so nothing was checked")
    repository.finish(problems_in(listing), "no globals in the core")


if __name__ == "__main__":
    main()
