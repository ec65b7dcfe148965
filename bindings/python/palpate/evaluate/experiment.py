"""The interface of an experiment: from options it makes a table, figures and checked claims."""

import concurrent.futures
import dataclasses
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Optional

import numpy

GRANTED = 1e-9  # of the data's range: what G1 and G2 allow (docs/proxy.md)


@dataclasses.dataclass
class Options:
    """What the user chose."""

    quick: bool = False  # seconds instead of minutes: fewer and smaller cases, every claim checked
    seed: int = 1
    seeds: int = 3  # how many are used where lines or hands are drawn at random, from `seed` on
    method: str = "exact"  # for an experiment that shows one
    subjects: tuple = ()  # instead of the experiment's own volumes
    ranges: tuple = ()  # (low, high) of interest, for penetration
    data: Optional[Path] = None  # folder of the real volumes
    used: list = dataclasses.field(default_factory=list)  # of them: (file, SHA-256, where to get it)
    progress: Callable[[float], Any] = lambda part: None
    note: Callable[[str], Any] = lambda text: None

    def refuse_volumes(self, reason):
        if self.subjects:
            raise ValueError(f"{reason} of its own: leave out --volume")

    def each(self, cases, begin=0, end=1):
        """The cases, one after the other, with reports of progress between two parts of the whole."""
        cases = list(cases)
        for number, case in enumerate(cases):
            self.progress(begin + (end - begin) * number / len(cases))
            yield case


@dataclasses.dataclass
class Claim:
    """A statement that the run checks. It never depends on how fast the machine is."""

    statement: str
    held: bool
    measured: str


@dataclasses.dataclass
class Figure:
    """suffix: its file is EXPERIMENT-SUFFIX. drawn: of Matplotlib."""

    suffix: str
    caption: str
    drawn: Any

    def __post_init__(self):
        self.caption = joined(self.caption)


class Table(list):
    """Rows, each a dict of cells by column; an absent cell was not measured."""

    def where(self, **cells):
        return Table(row for row in self if all(row.get(name) == cell for name, cell in cells.items()))

    def only(self, holds):
        return Table(row for row in self if holds(row))

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


@dataclasses.dataclass
class Result:
    table: Table
    figures: list
    claims: list
    paragraphs: list  # of text
    summary: Table = dataclasses.field(default_factory=Table)
    data: list = dataclasses.field(default_factory=list)  # (file, SHA-256, where to get it)


def in_parallel(function, items):
    """The results in the order of the items. Calls into the module leave the GIL, so that all processors work."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
        return list(threads.map(function, items))


def joined(text):
    """Text that is broken into lines as the code is, in one line."""
    return " ".join(text.split())


def paragraphs(text):
    """The same for paragraphs, which are apart by empty lines."""
    return [joined(part) for part in text.strip().split("\n\n")]


def at_most(limit, values, statement, measured="largest {:.2g}"):
    """The Claim that no value is above the limit."""
    most = largest(values)
    return Claim(statement, most <= limit, measured.format(most))


def largest(values):
    """0 for none; NaN is left out."""
    return float(numpy.nanmax(values, initial=0)) if len(values) else 0.0
