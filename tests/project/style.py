#!/usr/bin/env python3
"""Style that can be counted: length of files, public headers and functions, names that say
nothing, and paths of the machine that somebody built on."""

import re
from pathlib import Path

import repository

FILE_LINES = 500
HEADER_LINES = 300
FUNCTION_LINES = 60
TEXT = (".cpp", ".hpp", ".c", ".h", ".py", ".sh", ".cmake", ".txt", ".json", ".md", ".in", ".gp")
COUNTED = (".cpp", ".hpp", ".py", ".sh", ".cmake")
EMPTY_FOLDERS = {"util", "utils", "common", "misc", "third_party", "thirdparty"}
EMPTY_CLASS = re.compile(r"^\s*(?:class|struct)\s+(\w*(?:Manager|Helper))\b")
THROWS = re.compile(r"\bprint\(stderr")
HOME = re.compile(r"/(?:home|Users)/\w[\w.-]*/|(?<![\w.])/roo[t]/")  # not a hit of its own

# The code is formatted (the format check holds that), so indentation can be trusted: a function
# ends at the first closing brace as deep as its head.
HEAD_ENDS = re.compile(r"\)\s*(?:const|noexcept|override|final|mutable|&{1,2}|\s)*"
                       r"(?:->[^{;]*)?(?:\s:\s.*)?\{$", re.DOTALL)
CONTROL = re.compile(r"\s*(?:\}\s*)?(?:if|else|for|while|switch|do|catch|try|namespace|return|case)"
                     r"\b")


def head_start(lines, end):
    """First line of the statement whose last line is `end`."""
    start = end
    while start > 0:
        above = lines[start - 1].rstrip()
        if not above or above.endswith((";", "{", "}", ":")) or re.match(r"\s*(//|#)", above):
            break
        start -= 1
    return start


def functions(text):
    """(first line, number of lines) of every function body that spans more than a line."""
    lines = text.splitlines()
    for end, line in enumerate(lines):
        if not line.endswith("{"):
            continue
        start = head_start(lines, end)
        head = "\n".join(lines[start:end + 1])
        if CONTROL.match(head) or not HEAD_ENDS.search(head):
            continue
        indent = re.match(r"\s*", lines[start]).group()
        for close in range(end + 1, len(lines)):
            if lines[close].startswith(indent + "}"):
                yield start + 1, close - start + 1
                break


def check_length(relative, text):
    count = len(text.splitlines())
    limit = HEADER_LINES if relative.parts[0] == "include" else FILE_LINES
    if count > limit:
        yield f"{relative}: {count} lines, at most {limit}"
    if relative.suffix in repository.CPP:
        for line, length in functions(text):
            if length > FUNCTION_LINES:
                yield f"{relative}:{line}: a function of {length} lines, at most {FUNCTION_LINES}"


def machine_paths(root):
    """Paths that only this checkout's machine has, besides anybody's home."""
    paths = {str(root), str(Path.home())} - {"/"}
    return [re.compile(r"(?<![\w.})-])" + re.escape(path) + r"(?![\w.-])") for path in paths]


def check_lines(relative, text, here):
    for number, line in enumerate(text.splitlines(), 1):
        if HOME.search(line) or any(path.search(line) for path in here):
            yield f"{relative}:{number}: a path of one machine"
        match = EMPTY_CLASS.match(line) if relative.suffix in repository.CPP else None
        if match:
            yield f"{relative}:{number}: {match.group(1)} does not say what it is"
        if THROWS.search(line) and relative.parts[0] == "apps":
            yield f"{relative}:{number}: fmt::print() throws where stderr is full or closed; use say()"


def check(root):
    problems = []
    here = machine_paths(root)
    for path in repository.files(root):
        relative = path.relative_to(root)
        for folder in relative.parts[:-1]:
            if folder in EMPTY_FOLDERS:
                problems.append(f"{relative}: the folder {folder} does not say what it holds")
        if path.suffix not in TEXT and path.suffix:
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # data, not source
        if path.suffix in COUNTED or path.name == "CMakeLists.txt":
            problems += check_length(relative, text)
        problems += check_lines(relative, text, here)
    return problems


if __name__ == "__main__":
    repository.finish(check(repository.root_from_arguments()), "style")
