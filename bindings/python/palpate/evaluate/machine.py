"""Describes the machine and the build that numbers come from: processor, clock, load, kernel, governor, compiler, flags, commit and command.
Nothing in it identifies the machine itself."""

import os
import platform
import re
import subprocess
import time
from pathlib import Path

import palpate


def first(path, pattern, otherwise="unknown"):
    """The first match in a file."""
    try:
        found = re.search(pattern, Path(path).read_text(encoding="utf-8", errors="replace"), re.MULTILINE)
    except OSError:
        found = None
    return found.group(1).strip() if found else otherwise


LOAD = first("/proc/loadavg", r"^(\S+)")  # of other programs, as this is read when the command begins



def build():
    """How the module was built, as far as its build tree tells."""
    version = f"Palpate {palpate.__version__}"
    for cache in filter(Path.exists, (folder / "CMakeCache.txt" for folder in Path(palpate.__file__).resolve().parents)):
        kind = first(cache, r"^CMAKE_BUILD_TYPE:\w+=(\w+)$", "no build type")
        flags = " ".join(first(cache, rf"^CMAKE_CXX_FLAGS{name}:\w+=(.*)$", "")
                         for name in ("", f"_{kind.upper()}")).strip()
        compiler = first(cache, r"^CMAKE_CXX_COMPILER:\w+=(.*)$")
        source = first(cache, r"^CMAKE_HOME_DIRECTORY:\w+=(.*)$")
        return (f"{version}, commit {output('git', '-C', source, 'rev-parse', '--short', 'HEAD')}, "
                f"{kind} ({flags}), {output(compiler, '--version')}")
    return f"{version}, installed"


def output(*command):
    """The first line that a program prints."""
    try:
        ran = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return ran.stdout.split("\n")[0]


def described(command):
    """Sentences for the end of a page of results."""
    model = first("/proc/cpuinfo", r"^model name\s*:\s*(.*)$")
    clock = first("/proc/cpuinfo", r"^cpu MHz\s*:\s*(\d+)")
    governor = first("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", r"(\w+)", "not visible")
    system = first("/etc/os-release", r'^PRETTY_NAME="?([^"\n]*)')
    return (f"Measured on {time.strftime('%Y-%m-%d', time.gmtime())} on an {model} ({os.cpu_count()} processors, {clock} MHz at the time, "
            f"frequency governor {governor}, load {LOAD} at the start), {system}, Linux {platform.release()}. {build()}. "
            f"Command: `{command}`.")
