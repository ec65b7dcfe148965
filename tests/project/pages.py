#!/usr/bin/env python3
"""Pages name tests and files that exist: `Suite.name` of a test in C++, a bare name of one in words, and paths
from the top of the sources or the last parts of one. `pages.py ROOT PROGRAM` also compares the options of commands with
the help of the program."""

import functools
import re
import subprocess
import sys
from pathlib import Path

import repository

TEST = re.compile(r"\b(?:TEST|TEST_F|TEST_P|TYPED_TEST(?:_P)?|\w+_TEST|RC_GTEST_\w+)\(\s*(\w+)\s*,\s*(\w+)")
PYTHON = re.compile(r"\bdef (?:test_)?(\w+)\(")
NAMED = re.compile(r"(?:\w+/)?([A-Z]\w*|[a-z]+_[a-z]+)\.([a-z]\w*_\w+_\w+)")  # a suite and at least three words
FILE = re.compile(r"(?:[\w.-]+/)+[\w.-]+\.(?:cpp|hpp|h|c|py|sh|cmake|map|md|csv|json)")
COMMAND = re.compile(r"\bpalpate ([a-z]+)(?: (sculpt|beating))?\b([^`\n|>#]*)")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
MADE_UP = re.compile(r"NAME|FOLDER|PREFIX|XX|^(?:out|palpate-demo|share|p01-threshold.touches|public)/")  # placeholders, outputs, other projects


def known(root):
    """The tests of the sources as (suite, name), their bare names, and the paths of all files."""
    tests, names, paths = set(), set(), set()
    for path in repository.files(root, folders=(*repository.FOLDERS, ".github")):
        paths.add(str(path.relative_to(root)))
        if path.suffix in (".cpp", ".hpp", ".c", ".py") and "tests" in path.parts:
            text = path.read_text(encoding="utf-8")
            tests.update(TEST.findall(text))
            names.update(PYTHON.findall(text))
    return tests, names | {name for _, name in tests}, paths


def problems(text, tests, names, paths):
    """(line, problem) of every name in code marks that leads nowhere."""
    text = re.sub(r"```.*?```", lambda block: "\n" * block[0].count("\n"), text, flags=re.DOTALL)
    for match in re.finditer(r"`([^`\n]+)`", text):
        code, line = match[1], text.count("\n", 0, match.start()) + 1
        named = NAMED.fullmatch(code)
        if named and named[2] not in ("hpp", "cpp") and (named[1], named[2]) not in tests:
            yield line, f"{code}: there is no such test"
        if re.fullmatch(r"[a-z]+(?:_[a-z0-9]+){6,}", code) and code.removeprefix("test_") not in names:
            yield line, f"{code}: there is no test of this name"
        if FILE.fullmatch(code) and not MADE_UP.search(code) and not any(("/" + path).endswith("/" + code) for path in paths):
            yield line, f"{code}: there is no such file"


@functools.cache
def help_of(program, *command):
    """The help of a command, or nothing where there is no such command, or this build lacks it (commands in Python)."""
    if command and not re.search(rf"^  {command[0]} ", help_of(program), re.MULTILINE):
        return ""
    return subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=False).stdout


def options_that_are_none(text, help_of_command):
    """(line, problem) of every option that stands behind a command which does not have it."""
    for match in COMMAND.finditer(text):
        known_words = help_of_command(*filter(None, match.groups()[:2]))
        for option in OPTION.findall(match[3]) if known_words else ():
            if not re.search(rf"{option}\b(?!-)", known_words):
                yield text.count("\n", 0, match.start()) + 1, f"palpate {match[1]} has no option {option}"


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: pages.py ROOT [PROGRAM]")
    root, everything, found = Path(sys.argv[1]).resolve(), known(Path(sys.argv[1]).resolve()), []
    for path in repository.files(root, (".md",)):
        text = path.read_text(encoding="utf-8")
        here = list(problems(text, *everything))
        if len(sys.argv) == 3 and path.name != "CHANGELOG.md":
            here += options_that_are_none(text, functools.partial(help_of, sys.argv[2]))
        found += [f"{path.relative_to(root)}:{line}: {problem}" for line, problem in here]
    repository.finish(found, "pages")


if __name__ == "__main__":
    main()
