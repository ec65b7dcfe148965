#!/usr/bin/env python3
"""Compares figures in pages with the CSV that they come from. A comment marks a figure, below the paragraph,
list or table that contains it:
    <!-- figure 0.51: docs/results/performance.csv, max mean_ns / 1000, method=smooth -->
It names the number as the page writes it, the file, one of min, max, sum and only, the column, a factor, and the
rows. The block has to contain the number, and the CSV has to give it to the digits that are written.
"""

import csv
import math
import re
import sys
from pathlib import Path

import repository

MARK = re.compile(r"<!-- figure (.*?) -->")
FORM = re.compile(r"(?P<number>\S+): (?P<file>\S+\.csv), (?P<what>min|max|sum|only) (?P<column>\w+)"
                  r"(?: (?P<sign>[*/]) (?P<factor>[\d.e]+))?(?P<rows>(?:, \w+=[^,]+)*)")
NEEDED = {"README.md": 7, "docs/performance.md": 4, "docs/streaming.md": 1, "docs/tools.md": 6}  # pages, and at least so many marks


def digits_after_point(number):
    """The exponent of the last digit that is written: -2 of 0.51, -12 of 4.0e-11."""
    mantissa, _, power = number.lower().partition("e")
    return int(power or 0) - len(mantissa.partition(".")[2])


def measured(root, mark):
    """The number that the CSV gives for a mark."""
    wanted = [condition.split("=", 1) for condition in mark["rows"].split(", ")[1:]]
    with open(root / mark["file"], encoding="utf-8", newline="") as file:
        values = [float(row[mark["column"]]) for row in csv.DictReader(file)
                  if all(row[name] == value for name, value in wanted) and row[mark["column"]]]
    if not values or mark["what"] == "only" and len(values) != 1:
        raise ValueError(f"{len(values)} rows are meant")
    value = {"min": min, "max": max, "sum": math.fsum, "only": max}[mark["what"]](values)
    factor = float(mark["factor"] or 1)
    return value / factor if mark["sign"] == "/" else value * factor


def block_above(text, end):
    """The paragraph, list or table that ends before the comments at `end`."""
    lines = MARK.sub("", text[:end]).rstrip().splitlines()
    first = len(lines)
    while first > 0 and lines[first - 1].strip():
        first -= 1
    return "\n".join(lines[first:])


def problem(root, text, match):
    """What is wrong with a mark, or nothing."""
    mark = FORM.fullmatch(match[1])
    if not mark:
        return "is not NUMBER: FILE, min|max|sum|only COLUMN [* or / FACTOR][, COLUMN=VALUE]"
    if not re.search(rf"(?<![\d.,]){re.escape(mark['number'])}(?![\d]|[.,]\d)", block_above(text, match.start())):
        return f"the text above does not say {mark['number']}"
    try:
        value = measured(root, mark)
        said, last = float(mark["number"].replace(",", "")), digits_after_point(mark["number"])
    except (OSError, KeyError, ValueError) as e:
        return f"{type(e).__name__}: {e}"
    return None if abs(value - said) <= 0.5000001 * 10.0 ** last else f"the CSV says {value:.6g}"


def main():
    root = Path(sys.argv[1]).resolve() if len(sys.argv) == 2 else sys.exit("usage: figures.py ROOT")
    problems, marks = [], {}
    for path in repository.files(root, (".md",)):
        name, text = str(path.relative_to(root)), path.read_text(encoding="utf-8")
        for match in MARK.finditer(text):
            marks[name] = marks.get(name, 0) + 1
            wrong = problem(root, text, match)
            if wrong:
                problems.append(f"{name}:{text.count(chr(10), 0, match.start()) + 1}: figure {match[1]}: {wrong}")
    problems += [f"{name}: has {marks.get(name, 0)} marked figures, at least {least} are expected"
                 for name, least in NEEDED.items() if (root / name).exists() and marks.get(name, 0) < least]
    repository.finish(problems, "figures")


if __name__ == "__main__":
    main()
