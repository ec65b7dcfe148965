"""The interface of an experiment: from options it makes a table, figures and checked claims."""

import collections
import concurrent.futures
import csv
import dataclasses
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Optional

import numpy

GRANTED = 1e-9  # of the data's range: what G1 and G2 allow (docs/proxy.md)


class DoesNotApply(ValueError):
    """An experiment that cannot be made on the volumes that were chosen. `all` leaves it out."""


@dataclasses.dataclass
class Options:
    """What the user chose."""

    quick: bool = False  # seconds instead of minutes: fewer and smaller cases, every claim checked
    seed: int = 1
    seeds: int = 3  # how many are used where lines or hands are drawn at random, from `seed` on
    method: str = "exact"  # for an experiment that shows one
    subjects: tuple = ()  # instead of the experiment's own volumes
    ranges: tuple = ()  # of interest, for penetration: functions that give (low, high) in a volume
    data: Optional[Path] = None  # folder of the real volumes
    used: list = dataclasses.field(default_factory=list)  # of them: (file, SHA-256, where to get it)
    progress: Callable[[float], Any] = lambda part: None
    note: Callable[[str], Any] = lambda text: None

    def refuse_volumes(self, reason):
        if self.subjects:
            raise DoesNotApply(f"{reason} of its own: leave out --volume")

    def each(self, cases, begin=0, end=1):
        """The cases, one after the other, with reports of progress between two parts of the whole."""
        cases = list(cases)
        for number, case in enumerate(cases):
            self.progress(begin + (end - begin) * number / len(cases))
            yield case


Claim = collections.namedtuple("Claim", "statement held measured")  # which the run checks; never how fast the machine is
Figure = collections.namedtuple("Figure", "suffix caption drawn")  # its file is EXPERIMENT-SUFFIX; drawn by Matplotlib


class Page:
    """The text of an experiment, pages/MODULE.md: its title, and sections of paragraphs and captions. Names in braces are those of
    constants of the module, or of values that are given."""

    def __init__(self, module):
        text = (Path(__file__).parent / "pages" / f"{module.rpartition('.')[2]}.md").read_text(encoding="utf-8")
        _, self.title, *parts = re.split(r"^#+ (.*)$", text, flags=re.MULTILINE)
        self._module, self.sections = module, dict(zip(["", *parts[1::2]], map(str.strip, parts[::2])))

    def text(self, *sections, **values):
        """Paragraphs of some sections, or of what is before the first one; each in one line."""
        text = "\n\n".join(self.sections[name] for name in sections or [""]).format(**{**vars(sys.modules[self._module]), **values})
        return [" ".join(part.split()) for part in text.split("\n\n")]

    def figure(self, drawn, suffix="", **values):
        """The Figure whose caption is in the section `figure`, or `figure SUFFIX`."""
        return Figure(suffix, *self.text(f"figure {suffix}".rstrip(), **values), drawn)

    def claim(self, name, held, **values):
        """The Claim whose statement and measure are in the section `claim NAME`."""
        statement, measured = self.text(f"claim {name}", **values)
        return Claim(statement, bool(held), measured)

    def at_most(self, limit, found, name, **values):
        """The Claim that nothing that was found is above the limit; {most} is the largest."""
        most = largest(found)
        return self.claim(name, most <= limit, **{"limit": limit, "most": most, **values})


class Table(list):
    """Rows, each a dict of cells by column; an absent cell was not measured."""

    def where(self, **cells):
        return Table(row for row in self if all(row.get(name) == cell for name, cell in cells.items()))

    def only(self, holds):
        return Table(row for row in self if holds(row))

    def by(self, column):
        """(cell, its rows) for each of the cells of a column."""
        return [(cell, self.where(**{column: cell})) for cell in self.distinct(column)]

    def __getitem__(self, column):
        """A column as an array, NaN where nothing was measured; or a row by its number."""
        if not isinstance(column, str):
            return super().__getitem__(column)
        return numpy.array([row.get(column, numpy.nan) for row in self])

    def distinct(self, column):
        return list(dict.fromkeys(row[column] for row in self if column in row))

    @property
    def columns(self):
        return list(dict.fromkeys(name for row in self for name in row))

    def cells(self, form):
        """Rows of all columns as text, where form() makes text of a cell; an absent one is NaN."""
        return [[form(row.get(name, numpy.nan)) for name in self.columns] for row in self]


def known(name):
    """Of tables/NAME.csv, which begins with where its numbers come from: a Table."""
    def cell(text):
        return float(text) if text.replace(".", "", 1).isdecimal() else text

    with (Path(__file__).parent / "tables" / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        next(file)
        return Table({column: cell(text) for column, text in row.items() if text} for row in csv.DictReader(file))


@dataclasses.dataclass
class Result:
    table: Table
    figures: list
    claims: list
    paragraphs: list  # of text
    summary: Table = dataclasses.field(default_factory=Table)
    data: list = dataclasses.field(default_factory=list)  # (file, SHA-256, where to get it)

    def __post_init__(self):
        self.figures, self.claims, self.summary = list(self.figures), list(self.claims), Table(self.summary)


def in_parallel(function, items):
    """The results in the order of the items. Calls into the module leave the GIL, so that all processors work."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
        return list(threads.map(function, items))


def largest(values):
    """0 for none; NaN is left out."""
    return float(numpy.nanmax(values, initial=0)) if len(values) else 0.0
