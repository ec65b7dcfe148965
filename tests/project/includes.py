#!/usr/bin/env python3
"""Rule 1: includes run one way. A stage of the core includes only stages above it, the core needs
the standard library and Eigen, and each folder sees only the folders it may."""

import re

import repository

# The flow. `surface` looks at the field from the side: no stage may include it.
STAGES = ("names progress volume tool mesh_tool tool_body samples field edit editor lattice cubic density proxy tool_proxy "
          "penetrability force layers reach renderer exchange device session settings servo").split()
OBSERVERS = {"surface": "density"}  # name -> last stage that it may include
UMBRELLA = "palpate"                # include/palpate/palpate.hpp, for users of the library

# Which folders each folder may include from, besides itself. A folder that is named covers those
# inside it that have no line of their own. include/palpate/X/ holds the public headers of X and
# belongs to it, the rest of include/ to the core. `tests` sees everything.
LIBRARIES = ("include", "io", "baselines", "scenes", "filters", "stream", "devices", "run")
WINDOW = ("apps/options", "apps/viewer/model", "apps/viewer/scene", "apps/viewer/slices",
          "apps/viewer/panel", "apps/viewer/window")
MAY_SEE = {
    "include": (),
    "src": ("include",),
    "baselines": ("include",),
    "baselines/paper.cpp": ("include", "src", "baselines"),  # the walk that it shares with the core
    "scenes": ("include",),
    "filters": ("include",),
    "io": ("include", "scenes", "io/helper"),
    "io/helper": ("include", "io"),
    "stream": ("include", "io"),
    "stream/objects": ("include", "io", "stream"),
    "stream/formats": ("include", "io", "stream", "stream/objects"),
    "stream/loader": ("include", "io", "stream"),
    "stream/writer": ("include", "io", "stream", "stream/objects", "stream/formats", "stream/loader"),
    "devices": ("include", "io", "scenes"),
    "devices/device_thread.cpp": ("include", "src", "devices"),  # the servo's clocks and privileges
    "run": ("include", "io", "baselines", "scenes", "filters", "stream", "devices"),
    "bindings/c": ("include", "io", "devices", "run"),
    "bindings/web": ("include", "io", "io/helper", "scenes", "devices"),
    "pictures": ("include", "io", "io/helper"),
    "pictures/vtk": ("include",),
    "pictures/helper": ("include", "io", "io/helper", "pictures", "pictures/vtk"),
    "evaluation": ("include", "io", "scenes", "stream", "evaluation/explicit_helper"),
    "evaluation/explicit_helper": ("include", "io", "io/helper"),
    "doctor": ("include", "io", "scenes", "devices", "run", "pictures"),
    "bridge": ("include",),
    "apps/options": LIBRARIES,
    "apps/palpate": (*LIBRARIES, "pictures", "doctor", "bridge", "apps/options"),
    "apps/viewer": (*LIBRARIES, *WINDOW),
    "apps/viewer/model": (*LIBRARIES, "pictures", "apps/options"),
    "apps/viewer/scene": ("include", "pictures", "pictures/vtk", "apps/viewer/model"),
    "apps/viewer/slices": ("include", "pictures", "apps/viewer/model"),
    "apps/viewer/panel": (*LIBRARIES, "pictures", "apps/options", "apps/viewer/model"),
    "apps/viewer/window": (*LIBRARIES, *WINDOW),
    "bindings/python": (*LIBRARIES, "stream/formats", "evaluation"),
    "benchmarks": (*LIBRARIES, *WINDOW, "pictures", "tests"),
    "examples": LIBRARIES,
}
# Folders whose inner folders are alternatives, which do not know of each other: the backends. The
# folder itself knows them all: its table lists them.
ALTERNATIVES = ("devices",)
# Folders that build from the standard library and Eigen alone.
PURE = ("include", "src", "baselines", "scenes")

# What a stage needs of the system beyond the standard library, in its sources only.
SYSTEM = {"servo": ("fcntl.h", "pthread.h", "sched.h", "sys/mman.h", "sys/prctl.h", "unistd.h",
                    "avrt.h", "timeapi.h", "windows.h")}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
STANDARD = re.compile(r"^[a-z_0-9]+$")


def includes_of(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1)


def resolve(root, path, name):
    """The file of ours that an include names, relative to the root, or None."""
    for base in (root / "include", root / "src", root, path.parent, root / "tests"):
        target = (base / name).resolve()
        if target.is_file() and root in target.parents:
            return target.relative_to(root)
    return None


def owner_of(relative):
    """The folder that a file of ours belongs to, as its parts."""
    if relative.parts[:2] == ("include", "palpate"):
        return relative.parts[2:-1] or ("include",)
    return relative.parts[:-1]


def zone_of(relative):
    """The line of MAY_SEE whose rules hold for a file of ours: the innermost."""
    if relative.as_posix() in MAY_SEE:
        return relative.as_posix()
    parts = owner_of(relative)
    for depth in range(len(parts), 0, -1):
        if "/".join(parts[:depth]) in MAY_SEE:
            return "/".join(parts[:depth])
    return parts[0]


def check_folders(relative, target):
    """What is wrong when a file includes another because of the folders they are in, or None."""
    own, other = owner_of(relative), owner_of(target)
    zone, seen = zone_of(relative), zone_of(target)
    if seen not in (zone, *MAY_SEE[zone]):
        return f"{zone}/ may not see {seen}/"
    if relative.parts[0] == "include" and target.parts[0] != "include":
        return "a public header includes public headers only"
    if own[0] == other[0] and own[0] in ALTERNATIVES and len(own) > 1 and len(other) > 1:
        if own[1] != other[1]:
            return f"{'/'.join(own[:2])}/ may not know of {'/'.join(other[:2])}/ beside it"
    return None


def stage_of(relative):
    """include/palpate/NAME.hpp, src/NAME.cpp and src/NAME/... belong to stage NAME."""
    below = relative.parts[2:] if relative.parts[0] == "include" else relative.parts[1:]
    return below[0].split(".")[0]


def against_the_flow(own, other):
    """What is wrong when a file of stage `own` includes one of stage `other`, or None."""
    if own == other or own == UMBRELLA:
        return None
    if other == UMBRELLA:
        return "the core may not include palpate.hpp, which includes all of it"
    if other in OBSERVERS:
        return f"no stage may include {other}, which only observes"
    last = OBSERVERS.get(own, own)
    if STAGES.index(other) > STAGES.index(last):
        return f"{own} may not include {other}, which comes after {last}"
    return None


def check_stage(relative):
    name = stage_of(relative)
    known = name in STAGES or name in OBSERVERS
    if relative.parts[0] == "include":
        known = known or name == UMBRELLA
    return None if known else f"{name} is not a stage of the flow (tests/project/includes.py)"


def check_include(root, path, name):
    """What is wrong with one include, or None."""
    relative = path.relative_to(root)
    zone = zone_of(relative)
    if ".." in name.split("/"):
        return "includes name a path from the top, never .."
    target = resolve(root, path, name)
    if target is None:
        system = zone == "src" and name in SYSTEM.get(stage_of(relative), ())
        outside = not (STANDARD.match(name) or name.startswith("Eigen/") or system)
        if zone in PURE and (outside or name.startswith("palpate/")):
            return f"{zone}/ needs the standard library and Eigen, nothing else"
        return None
    if zone == "tests":
        return None
    if zone not in MAY_SEE:
        return f"{zone}/ is in no line of MAY_SEE (tests/project/includes.py)"
    wrong = check_folders(relative, target)
    if wrong:
        return wrong
    if zone in ("include", "src"):
        return against_the_flow(stage_of(relative), stage_of(target))
    return None


def check_umbrella(root):
    """palpate.hpp includes every public header, the stages in the order of the flow."""
    umbrella = root / "include/palpate/palpate.hpp"
    if not umbrella.exists():
        return []
    listed = [name[len("palpate/"):-len(".hpp")] for _, name in includes_of(umbrella)
              if name.startswith("palpate/")]
    stages = [name for name in listed if name in STAGES]
    problems = []
    if stages != sorted(stages, key=STAGES.index):
        problems.append("include/palpate/palpate.hpp: not in the order of the flow")
    for header in sorted(umbrella.parent.glob("*.hpp")):
        if header.stem not in listed + [UMBRELLA]:
            problems.append(f"include/palpate/palpate.hpp: {header.name} is missing")
    return problems


def check_windows(root):
    """A source that stream/CMakeLists.txt compiles for Windows needs no source that it leaves out: of each of
    stream's headers that it includes, the source is in the list, unless a *_windows.cpp stands in for it."""
    cmake = root / "stream/CMakeLists.txt"
    listed = re.search(r"if\(WIN32\).*?set\(sources ([^)]*)\)", cmake.read_text(), re.S) if cmake.exists() else None
    if not listed:
        return []
    sources = [root / "stream" / name for name in listed[1].split()]
    headers = {source: [resolve(root, source, name) for _, name in includes_of(source)] for source in sources}
    stood_in = {header for source in sources if source.stem.endswith("_windows") for header in headers[source]}
    problems = []
    for source in sources:
        for header in headers[source]:
            if header is None or owner_of(header)[0] != "stream" or header in stood_in:
                continue
            needed = (root / header).with_suffix(".cpp")
            if needed.exists() and needed not in sources:
                problems.append(f"stream/CMakeLists.txt: {source.name} needs {needed.name} on Windows")
    return problems


def check(root):
    problems = check_umbrella(root) + check_windows(root)
    for path in repository.files(root, repository.CPP):
        relative = path.relative_to(root)
        if zone_of(relative) in ("include", "src"):
            wrong = check_stage(relative)
            if wrong:
                problems.append(f"{relative}: {wrong}")
                continue
        for number, name in includes_of(path):
            wrong = check_include(root, path, name)
            if wrong:
                problems.append(f"{relative}:{number}: includes {name}: {wrong}")
    return problems


if __name__ == "__main__":
    repository.finish(check(repository.root_from_arguments()), "includes run one way")
