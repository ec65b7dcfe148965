"""Experiments that are still C++: the program palpate-evaluate leaves their table, figures and claims in
a folder, and this reads them."""

import csv
import json
import math
import subprocess
from pathlib import Path

import palpate

from .experiment import Claim, Figure, Result, Table

TITLES = {"scaling": "What does the cost grow with, and what does the explicit approach cost?",
          "streaming": "How long does a hand wait for a volume that is read as it is felt?"}


class Failed(Exception):
    """status: of the program, which has said why."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


def program():
    package = Path(palpate.__file__).parent
    for folder in (package / "libexec/palpate", *(p / "libexec/palpate" for p in package.parents)):
        if (folder / "palpate-evaluate").exists():
            return folder / "palpate-evaluate"
    raise Failed(5, "the program palpate-evaluate is missing: build all targets, or install the package palpate")


def cell(text):
    try:
        return float(text) if text else math.nan
    except ValueError:
        return text


def run(name, options, volumes, folder):
    """Raises Failed."""
    words = [program(), "evaluate", name, "--output", folder, "--method", options.method, "--seed", str(options.seed)]
    words += ["--quick"] * options.quick + [f"--volume={volume}" for volume in volumes]
    words += ["--data", options.data] if options.data else []
    ran = subprocess.run(words, stderr=subprocess.PIPE, text=True)
    lines = ran.stderr.splitlines()
    for line in lines[:-1] if ran.returncode else lines:
        options.note(line.removeprefix("palpate: note: "))
    if ran.returncode:
        raise Failed(ran.returncode, (lines or ["failed"])[-1].removeprefix("palpate: "))
    path = folder / f"{name}.json"
    found = json.loads(path.read_text(encoding="utf-8"))
    path.unlink()
    with (folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        table = Table({column: cell(text) for column, text in row.items()} for row in csv.DictReader(file))
    return Result(table, [Figure("", f["caption"], file=f["file"]) for f in found["figures"]],
                  [Claim(**claim) for claim in found["claims"]], [found["paragraph"]], Table(found["summary"]))
