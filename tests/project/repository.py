"""Shared by the rule checks: which files are ours, and how a check ends."""

import sys
from pathlib import Path

FOLDERS = ("include src baselines scenes filters io stream devices run doctor bridge bindings pictures evaluation apps tests "
           "benchmarks examples data cmake docs scripts .ci").split()
CPP = (".cpp", ".hpp")


def files(root, suffixes=None, folders=FOLDERS):
    """Our files below `root`, build directories and hidden files left out."""
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                if suffixes is None or path.suffix in suffixes:
                    yield path
    if folders is FOLDERS:
        yield from (p for p in sorted(root.glob("*")) if p.is_file()
                    and (suffixes is None or p.suffix in suffixes))


def finish(problems, rule):
    """Prints the problems and exits: 1 where there are any."""
    for problem in problems:
        print(problem)
    print(f"{rule}: {len(problems)} problem(s)")
    sys.exit(1 if problems else 0)


def root_from_arguments():
    if len(sys.argv) != 2:
        sys.exit(f"usage: {Path(sys.argv[0]).name} ROOT (the top of the sources)")
    return Path(sys.argv[1]).resolve()
