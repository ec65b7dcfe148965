#!/usr/bin/env python3
"""The zip for Windows: made of a build folder, unpacked, and used from there under Wine. A C program is
built with its header and import library; the command line feels, records and validates; nothing in it
needs a DLL that Windows does not have."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

SOURCE, BUILD, CC, OBJDUMP = (pathlib.Path(word) for word in sys.argv[1:])
WINE = SOURCE / "cmake/windows/wine.sh"
OF_WINDOWS = {"avrt.dll", "kernel32.dll", "msvcrt.dll", "winmm.dll", "ws2_32.dll", "mswsock.dll"}
# Wine's own files lie in the build folder, whatever folder a program is in.
SETTINGS = {**os.environ, "WINEPREFIX": str(BUILD / "wine")}


def run(*words, cwd, status=0):
    """What a command prints, both streams; it has to end with this status."""
    result = subprocess.run([str(word) for word in words], cwd=cwd, env=SETTINGS, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if result.returncode != status:
        sys.exit(f"{words} ended with {result.returncode}, not {status}:\n{result.stdout}")
    return result.stdout


def expect(pattern, text):
    if not re.search(pattern, text):
        sys.exit(f"no '{pattern}' in:\n{text}")


def main(folder):
    run(SOURCE / "scripts/package.sh", "windows", "--build", BUILD, folder, cwd=SOURCE)
    archive, = folder.glob("palpate-*-windows.zip")
    with zipfile.ZipFile(archive) as files:
        files.extractall(folder)
    top = folder / archive.stem
    binaries = top / "bin"
    for file in (binaries / "palpate-c.dll", binaries / "palpate.exe"):
        needed = re.findall(r"DLL Name: (\S+)", run(OBJDUMP, "-p", file, cwd=folder))
        foreign = {name.lower() for name in needed} - OF_WINDOWS
        if not needed or foreign:
            sys.exit(f"{file.name} needs {foreign or 'nothing at all'}")

    # Static: MinGW's own libraries are not on Windows either.
    run(CC, "-std=c99", "-static", "-I", top / "include", top / "examples/game_loop.c",
        top / "lib/libpalpate-c.dll.a", "-o", binaries / "game_loop.exe", cwd=folder)
    expect(r"felt for 30 of", run(WINE, "game_loop.exe", "synthetic:torus",
                                  "simulated:touchx,hand=hold,depth=4,seconds=600", "30", cwd=binaries))

    palpate = [WINE, "palpate.exe"]
    expect("openhaptics", run(*palpate, "devices", cwd=binaries))
    expect("96 x 108 x 110", run(*palpate, "info", "../share/palpate/visible_human_head.nrrd",
                                 cwd=binaries))
    run(*palpate, "record", "../share/palpate/visible_human_head.nrrd", "--layers", "sample-head",
        "--device", "simulated", "--seconds", "2", "--output", "felt.csv", "--quiet", cwd=binaries)
    expect("bit for bit", run(*palpate, "replay", "felt.csv", "--validate", cwd=binaries))
    (binaries / "head.nii").write_bytes(bytes(348))
    expect("head.nii: .*reads NRRD", run(*palpate, "info", "head.nii", cwd=binaries, status=3))
    print(f"{archive.name}: {archive.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        main(pathlib.Path(name))
