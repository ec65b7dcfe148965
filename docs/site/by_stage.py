#!/usr/bin/env python3
"""Puts headers into Doxygen's groups, so that no header has to say it: its first line names its stage
("// Stage 20, servo: ..."), its folder its library. With a file: prints it as Doxygen is to read it, with
the same line numbers. With --groups and a folder: defines the groups, in the order of the flow, with the
openers of the headers.
"""

import re
import sys
from pathlib import Path

STAGE = re.compile(r"Stage (\d+), (\w+): ")
OBSERVERS = ("names", "progress", "setting", "settings", "surface", "tool", "tool_proxy")  # in no stage: beside the flow
LIBRARIES = {"scenes": "named synthetic volumes and motions", "baselines": "all proxy methods by name",
             "filters": "volumes from volumes", "io": "readers and writers of files",
             "stream": "stores that are read by the box", "devices": "devices by name",
             "run": "live runs, replay, sources", "palpate-c": "the C interface"}


def opening(text):
    """What a header says at its top, as one text."""
    if text.startswith("/*"):
        lines = text[2:text.index("*/")].split("\n")
        return "\n".join(re.sub(r"^ ?\* ?", "", line) for line in lines).strip()
    lines = text.split("\n")
    head = next(i for i, line in enumerate(lines) if not line.startswith("//"))
    return "\n".join(line[2:].strip() for line in lines[:head])


def group_of(path, text):
    """(number in the order, name, title); nothing for palpate.hpp, which includes the others."""
    folder = path.parent.name
    if folder in LIBRARIES:
        return 100 + list(LIBRARIES).index(folder), folder, f"{folder}: {LIBRARIES[folder]}"
    stage = STAGE.match(opening(text))
    if stage:
        return int(stage[1]), stage[2], f"{stage[1]}. {stage[2]}"
    if path.stem in OBSERVERS:
        return 50 + OBSERVERS.index(path.stem), path.stem, f"{path.stem} (beside the flow)"
    return None


def documented_c(lines):
    """Plain comments of C as Doxygen's: behind a declaration or before it."""
    for line in lines:
        if line.lstrip().startswith("/* ----"):
            yield line
        elif re.match(r"\s*/\*", line):
            yield line.replace("/*", "/**", 1)
        elif re.search(r"[;,)\w] +/\* ", line) and not line.startswith("#"):
            yield line.replace("/* ", "/**< ", 1)
        else:
            yield line


def for_doxygen(path, text):
    group = group_of(path, text)
    if group is None:
        return text
    lines = text.split("\n")
    begin, end = f" /** @addtogroup {group[1]} */ /** @{{ */", "/** @} */ "
    if path.suffix == ".h":
        first = lines.index("#endif", lines.index("#define PALPATE_API"))
        last = max(i for i, line in enumerate(lines) if line == "#ifdef __cplusplus")
        lines[first + 1:last] = documented_c(lines[first + 1:last])
        lines[first + 1] += begin
        lines[last - 1] += end
        return "\n".join(lines)
    inside = [i for i, line in enumerate(lines) if re.match(r"namespace palpate\b[\w:]* \{", line)]
    for i in inside:
        lines[i] += begin
    for i, line in enumerate(lines):
        if re.match(r"\}  // namespace palpate", line):
            lines[i] = end + line
    return "\n".join(lines)


def define_groups(include):
    groups = {}
    for header in sorted(include.rglob("*.h*")):
        text = header.read_text(encoding="utf-8")
        group = group_of(header, text)
        if group is None and header.name != "palpate.hpp":
            sys.exit(f"{header}: its first line names no stage, and its folder is no library here")
        if group:
            words = STAGE.sub("", opening(text)).replace("@", "\\@")
            words = words[0].upper() + words[1:]
            groups.setdefault(group, []).append(f"@par {header.relative_to(include)}\n{words}\n")
    for (_, name, title), says in sorted(groups.items()):
        print(f"/** @defgroup {name} {title}\n\n" + "\n".join(says) + "*/\n")


if __name__ == "__main__":
    if sys.argv[1] == "--groups":
        define_groups(Path(sys.argv[2]))
    else:
        source = Path(sys.argv[1])
        sys.stdout.write(for_doxygen(source, source.read_text(encoding="utf-8")))
