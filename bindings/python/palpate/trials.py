"""Trials with people: which of two touches had more of a setting? A staircase or constant differences in random order, a CSV from which
an interrupted session continues, and the fit of a psychometric function (docs/tutorials/user_study.md).

    palpate study head.nrrd@34.5 p01.csv --setting stiffness --standard 0.3 --device haply
    palpate study --analyse p01.csv p02.csv
"""

import contextlib
import csv
import dataclasses
import difflib
import fcntl
import io
import math
import numbers
import os
import re
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Optional, Union

import numpy

from .command_line import ABOVE_ZERO, Kind, Parser, answer_to, remark, run, say, tell, whole, without_secrets
from .errors import DeviceError, InputError, OutputError
from .thresholds import Observer as Observer, fit as fit, psychometric as psychometric
from .whole_files import make_folder, sync

_Path = Union[str, Path]
_Row = dict[str, Any]

COLUMNS = ("trial", "difference", "first", "second", "answer", "correct", "felt", "plan")
_TEXTS = ("felt", "plan")
_WITHOUT_PLAN = COLUMNS[:-1]  # of versions that did not write it
_WHOLE = ("repeats", "seed", "down", "reversals", "trials", "trials_at_most")  # of a plan
_LISTS = ("differences", "steps")


@dataclasses.dataclass(frozen=True)
class Plan:
    """standard: of the setting; seed: of the order, and of which touch is the stronger one; most: the largest difference that is asked.
    Differences are parts of the standard.

    A staircase begins with `difference`. It becomes harder by one step after `down` right answers in a row, and easier after a wrong one.
    steps: the factors before and after the first two reversals. It ends after so many reversals, trials, or trials_at_most at `most`.
    differences and repeats: constant ones instead."""

    standard: float
    difference: float = 0.5
    differences: Sequence[float] = ()
    repeats: int = 20
    seed: int = 1
    most: float = 1.0
    down: int = 3
    steps: Sequence[float] = (2.0, 1.3)
    reversals: int = 12
    trials: int = 120
    trials_at_most: int = 20

    def __post_init__(self) -> None:
        asked = self.differences if len(self.differences) else (self.difference,)
        if not (self.standard > 0 and all(0 < d < math.inf for d in asked) and self.repeats > 0):
            raise ValueError("standard, differences and repeats have to be above 0")
        if not max(asked) <= self.most < math.inf:
            raise ValueError(f"differences have to be at most {self.most:g}, the largest one that the plan allows")
        if len(self.steps) != 2 or not all(1 < step < math.inf for step in self.steps):
            raise ValueError("steps have to be two factors above 1")
        if not min(self.down, self.reversals, self.trials, self.trials_at_most) > 0:
            raise ValueError("down, reversals, trials and trials_at_most have to be above 0")

    @property
    def text(self) -> str:
        """As in a file: `standard=0.2 seed=1 ...`, without what this kind of plan does not use."""
        def shown(name: str) -> str:
            value = getattr(self, name)
            if name in _WHOLE:
                return str(int(value))
            return "/".join(repr(float(one)) for one in numpy.atleast_1d(value))

        return " ".join(f"{name}={shown(name)}" for name in _members(len(self.differences) > 0))

    @classmethod
    def of_text(cls, text: str) -> "Plan":
        """Raises ValueError."""
        given = dict(part.partition("=")[::2] for part in text.split())
        if tuple(given) != _members("differences" in given):
            raise ValueError("this is no plan")

        def value(name: str, shown: str) -> Any:
            if name in _LISTS:
                return tuple(map(float, shown.split("/")))
            return int(shown) if name in _WHOLE else float(shown)

        return cls(**{name: value(name, shown) for name, shown in given.items()})


def _members(constant: bool) -> tuple[str, ...]:
    own = ("differences", "repeats") if constant else ("difference", "down", "steps", "reversals", "trials", "trials_at_most")
    return ("standard", "seed", "most", *own)


@dataclasses.dataclass(frozen=True)
class Trial:
    trial: int
    difference: float
    first: float
    second: float


def staircase(plan: Plan, correct: Sequence[float]) -> tuple[float, list[float], int]:
    """(the next difference, the differences at reversals, trials at the largest one) after answers that were right or not."""
    difference, reversals, row, way, at_most = plan.difference, [], 0, 0, 0
    for right in correct:
        at_most += difference >= plan.most
        row = row + 1 if right else 0
        turn = 1 if not right else -1 if row == plan.down else 0
        if turn:
            row = 0
            if way and turn != way:
                reversals.append(difference)
            way, difference = turn, min(plan.most, difference * plan.steps[len(reversals) >= 2]**turn)
    return difference, reversals, at_most


def next_trial(plan: Plan, correct: Sequence[float]) -> Optional[Trial]:
    """The trial after these answers, or None at the end: the same for the same plan and answers, so that a session continues."""
    done = len(correct)
    if len(plan.differences):
        every = numpy.repeat(plan.differences, plan.repeats)
        if done == len(every):
            return None
        difference = float(numpy.random.default_rng([plan.seed, 0]).permutation(every)[done])
    else:
        difference, reversals, at_most = staircase(plan, correct)
        if len(reversals) >= plan.reversals or done >= plan.trials or at_most >= plan.trials_at_most:
            return None
    pair = [plan.standard, plan.standard * (1 + difference)]
    if numpy.random.default_rng([plan.seed, 1, done]).random() < 0.5:
        pair.reverse()
    return Trial(done, difference, *pair)


def _row(line: Sequence[str], columns: Sequence[str]) -> _Row:
    """Raises ValueError."""
    if len(line) != len(columns):
        raise ValueError
    row: _Row = {"plan": "", **{name: text if name in _TEXTS else float(text) for name, text in zip(columns, line)}}
    if not (0 < row["difference"] < math.inf and row["answer"] in (1, 2) and row["correct"] == _is_right(row, row["answer"])):
        raise ValueError
    return row


def _is_right(row: _Row, answer: float) -> int:
    return int((answer == 2) == (row["second"] > row["first"]))


def read(path: _Path, plan: Optional[Plan] = None) -> list[_Row]:
    """Rows of a session: dicts of numbers, and the texts `felt` and `plan`. They have to be the trials of their plan, and of the one that
    is given. Warns if a file of an older version has no plan and none is given. Raises InputError."""
    try:
        text = Path(path).read_bytes().decode(errors="surrogateescape")  # names of files may be any bytes
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}: check the name") from error
    rows = _rows(path, text, plan)
    if rows and not (plan or rows[0]["plan"]):
        warnings.warn(f"{path}: the plan of its trials is missing, because an older version wrote this file: they are taken as they are",
                      stacklevel=2)
    return rows


def _rows(path: _Path, text: str, plan: Optional[Plan], felt: Optional[str] = None) -> list[_Row]:
    try:
        lines = list(csv.reader(io.StringIO(text, newline="")))
    except csv.Error as error:
        raise InputError(f"{path}: no session of trials") from error
    columns = tuple(lines[0]) if lines else ()
    if columns not in (COLUMNS, _WITHOUT_PLAN):
        raise InputError(f"{path}: no session of trials")
    rows: list[_Row] = []
    for number, line in enumerate(lines[1:], 2):
        where = f"{path}, line {number}"
        try:
            row = _row(line, columns)
        except ValueError as error:
            texts = [name for name in columns if name in _TEXTS]
            raise InputError(f"{where}: {len(columns) - len(texts)} numbers and what was {' and '.join(texts)} are needed") from error
        if felt is not None and row["felt"] != felt:
            raise InputError(f"{path}: is a session with {row['felt']}, not with {felt}: use another file")
        _check_row(where, row, [r["correct"] for r in rows], plan)
        rows.append(row)
    return rows


def _check_row(where: str, row: _Row, before: Sequence[float], plan: Optional[Plan]) -> None:
    """A row of the plan in it and of the one that is given, after these right and wrong answers. Raises InputError."""
    try:
        own = Plan.of_text(row["plan"]) if row["plan"] else plan
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{where}: this is no plan of trials: {row['plan']}") from error
    if plan and own and own.text != plan.text:
        raise InputError(f"{where}: this is no trial of the plan ({plan.text}) but of another one ({row['plan']}); "
                         "use another file for another plan")
    if own is None:
        return
    trial = next_trial(own, before)
    if trial is None or any(abs(row[name] - value) > 1e-9 for name, value in dataclasses.asdict(trial).items()):
        raise InputError(f"{where}: this is no trial of the plan; use another file for another plan")


def _line(cells: Sequence[Any]) -> str:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def _answered(trial: Trial, answer: int, felt: str, plan: Plan) -> _Row:
    row = dataclasses.asdict(trial)
    return {**row, "answer": answer, "correct": _is_right(row, answer), "felt": felt, "plan": plan.text}


class _Table:
    """The open file of a session, which has whole lines only."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.file = path.open("a+b", buffering=0)
        except OSError as error:
            raise OutputError(f"{path}: cannot be written: {error.strerror}") from error
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self.file.close()
            raise OutputError(f"{path}: another session writes to it: wait for its end, or use another file") from error

    def is_empty(self) -> bool:
        return os.fstat(self.file.fileno()).st_size == 0

    def write(self, text: str) -> None:
        """The whole text or nothing. Raises OutputError."""
        before, rest = os.fstat(self.file.fileno()).st_size, text.encode(errors="surrogateescape")
        try:
            while rest:
                rest = rest[self.file.write(rest):]
            sync(self.path)
        except OSError as error:
            with contextlib.suppress(OSError):
                self.file.truncate(before)
            raise OutputError(f"{self.path}: cannot be written: {error.strerror}") from error

    def end_the_last_line(self, plan: Plan, felt: str) -> None:
        """A killed session, or an editor, may have left it without its end. A line of which more is missing is removed: its trial is
        asked again. Raises InputError for a file that is no session of this plan."""
        self.file.seek(0)
        text = self.file.read().decode(errors="surrogateescape")
        before, end, last = text.rpartition("\n")
        if not last:
            return
        if any(line.startswith(last) and line != f"{last}\n" for line in self._next_lines(before + end, plan, felt)):
            self.file.truncate(len((before + end).encode(errors="surrogateescape")))
            warnings.warn(f"{self.path}: the last line was cut off: its trial is asked again", stacklevel=3)
        else:
            _rows(self.path, text, plan, felt)
            self.write("\n")

    def _next_lines(self, text: str, plan: Plan, felt: str) -> list[str]:
        """All lines that can follow."""
        if not text:
            return [_line(COLUMNS)]
        rows = _rows(self.path, text, plan, felt)
        trial, columns = next_trial(plan, [row["correct"] for row in rows]), _columns(rows)
        return [_line([_answered(trial, answer, felt, plan)[name] for name in columns]) for answer in (1, 2)] if trial else []


def _columns(rows: Sequence[_Row]) -> tuple[str, ...]:
    return COLUMNS if not rows or rows[0]["plan"] else _WITHOUT_PLAN


def session(path: _Path, plan: Plan, ask: Callable[[Trial], int], felt: str = "") -> list[_Row]:
    """Asks all trials that are missing in the file. ask(trial): 1 or 2, the touch that had more. Every answer is in the file before the
    next trial begins. `felt`: which setting of what, the same for all trials of a file. Raises InputError, OutputError."""
    path = Path(path)
    table = _Table(path)
    with table.file:
        table.end_the_last_line(plan, felt)
        if table.is_empty():
            table.write(_line(COLUMNS))
            sync(path.parent)
        rows = _rows(path, path.read_bytes().decode(errors="surrogateescape"), plan, felt)
        columns = _columns(rows)
        while trial := next_trial(plan, [row["correct"] for row in rows]):
            answer = ask(trial)
            if isinstance(answer, bool) or not isinstance(answer, numbers.Real) or answer not in (1, 2):  # True == 1
                raise ValueError(f"ask() has to return 1 or 2, not {answer!r}")
            row = _answered(trial, int(answer), felt, plan)
            table.write(_line([row[name] for name in columns]))
            rows.append(row if "plan" in columns else {**row, "plan": ""})
    return rows


def put(render: Any, name: str, value: float) -> None:
    """A setting by its name in RenderSetup, such as stiffness or friction.static_coefficient. Raises ValueError."""
    import palpate
    *path, last = name.split(".")
    owner = render
    for part in path:
        if part in ("friction", "penetrability") and getattr(owner, part, None) is None:
            setattr(owner, part, getattr(palpate, part.capitalize())())
        owner = getattr(owner, part, None)
    if last not in getattr(owner, "_fields", ()):
        near = difflib.get_close_matches(last, getattr(owner, "_fields", ()), 1)
        raise ValueError(f"there is no setting {name} in RenderSetup"
                         + (f" (did you mean {'.'.join([*path, *near])}?)" if near else ""))
    try:
        setattr(owner, last, value)
    except TypeError as error:
        raise ValueError(str(error)) from error


def _refuse_without_difference(name: str, largest: float) -> None:
    """Raises ValueError for a setting that changes nothing in a touch, which is with a point, as replay() refuses it."""
    import palpate
    ball = palpate.Field(palpate.load("synthetic:sphere:8x8x8").volume)
    for value in (largest, largest / 2):  # the default is never refused: one of them is another value
        setup = palpate.RenderSetup()
        put(setup, name, value)
        try:
            palpate.replay(ball, "50%", [0.0], [[0.0, 0.0, 0.0]], setup=setup)
        except ValueError as error:
            # The limits of the device, not those of a replay, decide on the rest.
            what, nothing, why = str(error).partition(" does nothing: ")
            if nothing:
                why = why.removesuffix(": choose another tool")
                raise ValueError(f"{name}: two touches would feel the same: {what} does nothing: {why}") from error


def touching(volume: _Path, level: Union[float, str, None], device: str, name: str, seconds: float, folder: _Path, largest: float,
             key: Callable[[str], str] = answer_to) -> Callable[[Trial], int]:
    """Asks by two touches of a device, one after the other, and a key. Each touch is recorded in the
    folder. A trial in which nothing was felt is asked again. largest: value of the setting. Raises ValueError if the device cannot
    render it as it is."""
    import palpate
    if not 0 < seconds < math.inf:
        raise ValueError("the seconds of a touch have to be above 0")
    loaded, folder = palpate.load(volume), Path(folder)
    made: set[Path] = set()  # recordings of the trial that is asked

    def opened(value):
        setup = palpate.Setup(isovalue=level, device=device)
        put(setup.render, name, value)
        run = palpate.Run(loaded, setup)
        asked, most = setup.render.force.limit, run.device.limits.maximum_force
        if asked == value and asked > most:
            raise ValueError(f"{name} = {value:g}: the device renders at most {most:g}")
        return run, setup.render.stiffness or 0

    def touched_for(run):
        """The newest snapshot, after so many seconds of the session. A busy machine may do its first tick late."""
        begun = None
        while True:
            time.sleep(0.005)
            now = run.snapshot()
            begun = now.tick.time if now and begun is None else begun
            if now and now.tick.time >= begun + seconds:
                return now

    def felt(value, file):
        run, stiffness = opened(value)
        if file in made:
            file.unlink(missing_ok=True)
        elif os.path.lexists(file):
            raise OutputError(f"{file}: is there already, of another session or of one that was killed; move it elsewhere")
        with run:
            run.record(file)
            made.add(file)
            now = touched_for(run)
            run.stop_recording()
            if run.problem:
                raise DeviceError(f"device: {run.problem}")
            if now.stiffness < stiffness:  # a device may tell its limits only once it is connected
                raise ValueError(f"stiffness [N/mm] = {stiffness:g}: the device renders only {now.stiffness:g} stably")
        return bool(palpate.read_recording(file).trace.force.any())

    def answer(trial):
        while True:
            both = True
            for number, value in enumerate((trial.first, trial.second), 1):
                remark(f"Trial {trial.trial + 1}: touch {number}")
                both &= felt(value, folder / f"{trial.trial}-{number}.csv")
            if both:
                break
            key("Nothing was felt in one of them. Press Enter to touch both again. ")
        while (given := key("Which one was more, 1 or 2? ").strip()) not in ("1", "2"):
            pass
        return int(given)

    def ask(trial):
        make_folder(folder)
        made.clear()
        try:
            return answer(trial)
        except BaseException:  # the trial is asked anew when the session continues
            for file in made:
                file.unlink(missing_ok=True)
            raise

    _refuse_without_difference(name, largest)
    opened(largest)  # Run refuses what the device cannot render stably
    return ask


PARSER = Parser("study", "Find the least difference that people can feel, by trials of two touches", (
    "head.nrrd@34.5 p01.csv --standard 0.3 --difference 0.5",
    "head.nrrd@34.5 p02.csv --setting friction.static_coefficient --standard 0.2 --differences 0.5 1 --repeats 10",
    "--analyse p01.csv p02.csv"))
PARSER.add("volume", kind=Kind("VOLUME@ISOVALUE"), optional=True, help="Volume and isovalue, such as head.nrrd@34.5 or head.nrrd@20%. Without @ it is the suggested one")
PARSER.add("file", kind=Kind("FILE.csv"), optional=True, help="Table of the session. The same command continues an interrupted session")
PARSER.add("--analyse", kind=Kind("FILE.csv"), nargs="+", help="Fit a psychometric function to each of these sessions instead")
PARSER.add("--setting", kind=Kind("NAME"), default="stiffness", help="Number in RenderSetup that differs, such as force.damping")
PARSER.add("--standard", kind=ABOVE_ZERO, help="Value of the setting that others are compared with")
PARSER.add("--difference", kind=ABOVE_ZERO, default=0.5, help="First difference of the staircase, as a part of the standard")
PARSER.add("--most", kind=ABOVE_ZERO, default=1.0, help="Largest difference, as a part of the standard")
PARSER.add("--differences", kind=ABOVE_ZERO, nargs="+", default=(), help="Constant differences in random order, instead of a staircase")
PARSER.add("--repeats", kind=whole(1), default=20, help="Trials of each constant difference")
PARSER.add("--seed", kind=whole(0, 2**64 - 1), default=1, help="Seed of the order, another one for each participant")
PARSER.add("-d", "--device", kind=Kind("TEXT"), default="simulated:hand=press", help="Device, as for palpate touch")
PARSER.add("--seconds", kind=ABOVE_ZERO, default=3.0, help="Duration of each touch [s]")


def _ask(chosen: Any) -> None:
    volume, at, level = chosen.volume.rpartition("@")
    if "/" in level or re.fullmatch(r"[^/]*://[^/]*", volume):  # of a folder's name, or behind the password of an address
        volume, at, level = "", "", chosen.volume
    if chosen.differences:
        PARSER.warn_of_no_effect(["difference"], "--differences has them all")
    else:
        PARSER.warn_of_no_effect(["repeats"], "it is for --differences")
    plan = Plan(chosen.standard, chosen.difference, tuple(chosen.differences), chosen.repeats, chosen.seed, chosen.most)
    largest = plan.standard * (1 + (max(plan.differences) if plan.differences else plan.most))
    rows = session(chosen.file, plan, touching(volume if at else level, level if at else None, chosen.device, chosen.setting,
                                               chosen.seconds, Path(chosen.file).with_suffix(".touches"), largest),
                   f"{chosen.setting} of {without_secrets(chosen.volume)} by {chosen.device} for {chosen.seconds:g} s")
    remark(f"The session is complete: {len(rows)} trials. To fit a threshold: palpate study --analyse {chosen.file}")


def _analyse(files: Sequence[str]) -> None:
    lines = [_line(("file", "trials", "threshold", "low", "high", "slope"))]
    for file in files:
        rows = read(file)
        try:
            lines.append(_line((file, len(rows), *(f"{value:.4g}" for value in fit(rows)))))
        except ValueError as error:
            raise InputError(f"{file}: {error}") from error
    say("".join(lines), end="")


def main(words: Sequence[str]) -> int:
    chosen = PARSER.arguments(words)
    if chosen.analyse:
        if idle := sorted(PARSER.given - {"analyse"}):
            PARSER.error(f"--analyse stands alone, without {idle[0]}")
        return run(lambda: _analyse(chosen.analyse))
    for name, value in (("VOLUME", chosen.volume), ("FILE", chosen.file), ("--standard", chosen.standard)):
        if value is None:
            PARSER.error(f"{name}: it is needed, as in {PARSER.examples[0]}")
    return run(lambda: _ask(chosen), "interrupted; the same command continues")
