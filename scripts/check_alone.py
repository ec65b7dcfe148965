#!/usr/bin/env python3
"""Compiles every public header and every source of the libraries alone with clang, without writing an
object: each has to include what it uses and to compile without warnings. Presets that compile several
sources together cannot see either. Programs and tests are left out unless they are named: presets `dev`
and `clang` compile each of their sources alone."""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "clang"
sys.path.insert(0, str(ROOT / "tests" / "project"))
sys.dont_write_bytecode = True

from includes import includes_of, resolve  # noqa: E402

# Large headers of other projects, precompiled for the sources that include them anyway, directly or
# through our headers. So a source sees nothing that it would not see alone.
LARGE = ("Eigen/Core", "Eigen/Geometry", "Eigen/LU", "gtest/gtest.h", "nlohmann/json.hpp",
         "CLI/CLI.hpp", "pybind11/pybind11.h", "pybind11/numpy.h", "pybind11/eigen.h", "pybind11/stl.h")
# The options that decide what those headers are and mean; other definitions do not reach them.
DECISIVE = ("-std", "-f", "-DEIGEN", "-DGTEST", "-DJSON", "-DCLI", "-DPYBIND", "-DNDEBUG")
WORTHWHILE = 4  # sources that share a set of them
LEFT_OUT = ("tests", "apps", "bindings", "evaluation", "doctor", "examples")  # unless named

Source = collections.namedtuple("Source", "file options shared key")


def reached(path, known):
    """What a file of ours includes from other projects, directly or through our headers."""
    if path not in known:
        known[path] = found = set()
        for _, name in includes_of(path):
            ours = resolve(ROOT, path, name)
            found |= reached(ROOT / ours, known) if ours else {name}
    return known[path]


def options_of(command):
    """The options that decide how a source is read: no optimisation, no debug information."""
    words = shlex.split(command)[1:]
    kept = []
    for word, following in zip(words, words[1:] + [""]):
        if word == "-isystem":
            kept += [word, following]
        elif word.startswith(("-D", "-I", "-std", "-W")):
            kept.append(word)
    return kept + ["-fPIC"]


def sources_of(database, wanted):
    """A list of Source from compile_commands.json, a file of ours once. `wanted`: files and folders, or
    nothing for the libraries."""
    known, seen = {}, set()
    for entry in database:
        file = pathlib.Path(entry["file"])
        if file.suffix != ".cpp" or file in seen or BUILD in file.parents:
            continue
        places = {str(place) for place in (file.relative_to(ROOT), *file.relative_to(ROOT).parents)}
        if not places & wanted if wanted else places & set(LEFT_OUT):
            continue
        seen.add(file)
        options = options_of(entry["command"])
        # ITK brings an Eigen of its own: its sources are compiled as they are.
        there = set() if any("/ITK" in word for word in options) else reached(file, known)
        large = tuple(name for name in LARGE if name in there)
        shared = [word for before, word in zip([""] + options, options)
                  if "-isystem" in (before, word) or word.startswith(DECISIVE)]
        yield Source(file, options, shared, (large, tuple(shared)))


def headers_of(sources):
    """A list of Source from the public headers, read with the options of the core's sources. Without those
    that a source includes first, after the same large headers: they are compiled with it."""
    core = next(one for one in sources if one.file.is_relative_to(ROOT / "src"))
    known, compiled = {}, set()
    for source in sources:
        first = next((name for _, name in includes_of(source.file)), "")
        compiled.add((resolve(ROOT, source.file, first), source.key[0]))
    for header in sorted((ROOT / "include").rglob("*.hpp")):
        there = reached(header, known)
        large = tuple(name for name in LARGE if name in there)
        if (header.relative_to(ROOT), large) not in compiled:
            yield core._replace(file=header, key=(large, core.key[1]))


def clang(*arguments):
    return subprocess.run(["clang++", *arguments], capture_output=True, text=True, check=False)


def precompile(folder, number, source):
    """The path of the precompiled headers of a source's key."""
    header = folder / f"{number}.hpp"
    header.write_text("".join(f"#include <{name}>\n" for name in source.key[0]), encoding="utf-8")
    result = clang(*source.shared, "-x", "c++-header", "-Xclang", "-fpch-instantiate-templates",
                   "-o", f"{header}.pch", str(header))
    if result.returncode != 0:
        sys.exit(f"check_alone.py: {header}:\n{result.stderr}")
    return f"{header}.pch"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="default: all cores")
    parser.add_argument("files", nargs="*", metavar="FILE",
                        help="sources to check or folders of them, relative to the repository (default: "
                        "the libraries and all public headers)")
    given = parser.parse_args()

    configured = subprocess.run(["cmake", "--preset", "clang"], cwd=ROOT, stdout=subprocess.PIPE,
                                text=True, check=False)
    if configured.returncode != 0:
        sys.exit(configured.stdout)
    database = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
    sources = list(sources_of(database, set(given.files)))
    if not sources:
        sys.exit("check_alone.py: no such source")
    if not given.files:
        sources += headers_of(sources)

    groups = collections.defaultdict(list)
    for source in sources:
        groups[source.key].append(source)
    folder = BUILD / "alone"
    folder.mkdir(exist_ok=True)
    bad = 0
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        headers = {key: pool.submit(precompile, folder, number, group[0])
                   for number, (key, group) in enumerate(groups.items())
                   if key[0] and len(group) >= WORTHWHILE}

        def compile_alone(source):
            header = headers.get(source.key)
            precompiled = ["-include-pch", header.result()] if header else []
            return source, clang(*source.options, *precompiled, "-fsyntax-only", "-x", "c++",
                                 "-Wno-pragma-once-outside-header", str(source.file))

        for source, result in pool.map(compile_alone, sources):
            if result.returncode != 0:
                bad += 1
                print(f"== {source.file.relative_to(ROOT)}\n{result.stderr}", flush=True)
    print(f"check_alone: {len(sources)} sources and headers, {len(headers)} sets of precompiled headers, "
          f"{bad} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
