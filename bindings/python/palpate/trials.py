"""Trials with people: which of two touches had more of a setting? A staircase or constant differences in random order, a CSV from which
an interrupted session continues, and the fit of a psychometric function (docs/tutorials/user_study.md).

    palpate study head.nrrd@34.5 p01.csv --setting stiffness --standard 0.3 --device haply
    palpate study --analyse p01.csv p02.csv
"""

import csv
import dataclasses
import difflib
import fcntl
import io
import math
import os
import re
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Optional, Union

import numpy

from .command_line import ABOVE_ZERO, Kind, Parser, answer_to, remark, run, say, tell, whole, without_secrets
from .errors import DeviceError, InputError, OutputError
from .whole_files import make_folder, sync

_Path = Union[str, Path]
_Row = dict[str, Any]

COLUMNS = ("trial", "difference", "first", "second", "answer", "correct", "felt")
GUESS, LAPSE = 0.5, 0.02  # of two alternatives; answers beside the question, assumed
DOWN = 3  # right answers in a row that make it harder: converges to 79.4 % without lapses (Levitt 1971)
AT = 0.5 ** (1 / DOWN)
REVERSALS, MOST, AT_CEILING = 12, 120, 20  # of a staircase: it ends after so many of them, trials, or trials at its largest difference
STEPS = (2.0, 1.3)  # factors before and after the first two reversals


@dataclasses.dataclass(frozen=True)
class Plan:
    """standard: of the setting; difference: of the first trial of a staircase, as a part of the standard; differences and repeats:
    constant ones instead; seed: of their order and of which touch is the stronger one; most: the largest difference that is asked."""

    standard: float
    difference: float = 0.5
    differences: Sequence[float] = ()
    repeats: int = 20
    seed: int = 1
    most: float = 1.0

    def __post_init__(self) -> None:
        asked = self.differences if len(self.differences) else (self.difference,)
        if not (self.standard > 0 and all(0 < d < math.inf for d in asked) and self.repeats > 0):
            raise ValueError("standard, differences and repeats have to be above 0")
        if not max(asked) <= self.most < math.inf:
            raise ValueError(f"differences have to be at most {self.most:g}, the largest one that the plan allows")


@dataclasses.dataclass(frozen=True)
class Trial:
    trial: int
    difference: float
    first: float
    second: float


def staircase(difference: float, correct: Sequence[float], most: float = math.inf) -> tuple[float, list[float], int]:
    """(the next difference, the differences at reversals, trials at `most`) after answers that were right or not."""
    reversals, row, way, ceiling = [], 0, 0, 0
    for right in correct:
        ceiling += difference >= most
        row = row + 1 if right else 0
        turn = 1 if not right else -1 if row == DOWN else 0
        if turn:
            row = 0
            if way and turn != way:
                reversals.append(difference)
            way, difference = turn, min(most, difference * STEPS[len(reversals) >= 2]**turn)
    return difference, reversals, ceiling


def next_trial(plan: Plan, correct: Sequence[float]) -> Optional[Trial]:
    """The trial after these answers, or None at the end: the same for the same plan and answers, so that a session continues."""
    done = len(correct)
    if len(plan.differences):
        every = numpy.repeat(plan.differences, plan.repeats)
        if done == len(every):
            return None
        difference = float(numpy.random.default_rng([plan.seed, 0]).permutation(every)[done])
    else:
        difference, reversals, ceiling = staircase(plan.difference, correct, plan.most)
        if len(reversals) >= REVERSALS or done >= MOST or ceiling >= AT_CEILING:
            return None
    pair = [plan.standard, plan.standard * (1 + difference)]
    if numpy.random.default_rng([plan.seed, 1, done]).random() < 0.5:
        pair.reverse()
    return Trial(done, difference, *pair)


def read(path: _Path, plan: Optional[Plan] = None) -> list[_Row]:
    """Rows of a session: dicts of numbers, and a text `felt`. With a plan, they have to be its trials. Raises InputError."""
    try:
        with open(path, encoding="utf-8", errors="surrogateescape", newline="") as file:  # names of files may be any bytes
            lines = list(csv.reader(file))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}: check the name") from error
    except csv.Error as error:
        raise InputError(f"{path}: no session of trials") from error
    rows = []
    for number, line in enumerate(lines[1:], 2):
        try:
            row: _Row = dict(zip(COLUMNS, [*map(float, line[:-1]), *line[-1:]]))
            if len(line) != len(COLUMNS):
                raise ValueError
        except ValueError as error:
            raise InputError(f"{path}, line {number}: {len(COLUMNS) - 1} numbers and what was felt are needed") from error
        trial = next_trial(plan, [r["correct"] for r in rows]) if plan else None
        if plan and (trial is None or any(abs(row[name] - value) > 1e-9 for name, value in dataclasses.asdict(trial).items())):
            raise InputError(f"{path}, line {number}: this is no trial of the plan; use another file for another plan")
        rows.append(row)
    if lines[:1] != [list(COLUMNS)]:
        raise InputError(f"{path}: no session of trials")
    return rows


def _line(cells: Sequence[Any]) -> str:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def session(path: _Path, plan: Plan, ask: Callable[[Trial], int], felt: str = "") -> list[_Row]:
    """Asks all trials that are missing in the file. ask(trial): 1 or 2, the touch that had more. Every answer is in the file before the
    next trial begins. `felt`: which setting of what, the same for all trials of a file. Raises InputError, OutputError."""
    path = Path(path)
    try:
        file = path.open("ab", buffering=0)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise OutputError(f"{path}: another session writes to it: wait for its end, or use another file") from error

        def put_down(line: Sequence[Any]) -> None:
            try:
                file.write(_line(line).encode(errors="surrogateescape"))
                sync(path)
            except OSError as error:
                raise OutputError(f"{path}: cannot be written: {error.strerror}") from error

        if file.tell() == 0:
            put_down(COLUMNS)
            sync(path.parent)
        rows = read(path, plan)
        for other in rows:
            if other["felt"] != felt:
                raise InputError(f"{path}: is a session with {other['felt']}, not with {felt}: use another file")
        while trial := next_trial(plan, [row["correct"] for row in rows]):
            answer = ask(trial)
            if answer not in (1, 2):
                raise ValueError(f"ask() has to return 1 or 2, not {answer!r}")
            right = int((answer == 2) == (trial.second > trial.first))
            row = {**dataclasses.asdict(trial), "answer": answer, "correct": right, "felt": felt}
            put_down([row[name] for name in COLUMNS])
            rows.append(row)
    return rows


def psychometric(difference: Any, threshold: float, slope: float) -> Any:
    """The part of right answers: a Weibull function of log difference, which is 78.2 % at the threshold, and 79.4 % without lapses."""
    reach = -numpy.log(2 * (1 - AT))
    return GUESS + (1 - GUESS - LAPSE) * (1 - numpy.exp(-reach * (numpy.asarray(difference) / threshold)**slope))


def fit(rows: Sequence[_Row], resamples: int = 200, seed: int = 1) -> tuple[float, float, float, float]:
    """(threshold, low, high, slope): of highest likelihood, with the 95 % interval of a bootstrap by trials. The threshold is NaN if it is
    not within the differences that were asked. Raises ValueError."""
    from scipy.optimize import minimize  # not needed to run a session
    difference, correct = (numpy.array([row[name] for row in rows], dtype=float) for name in ("difference", "correct"))
    if len(difference) < 10 or not 0 < correct.mean() < 1:
        raise ValueError("10 trials or more are needed, with right and with wrong answers")

    def best(of):
        def unlikely(guess):
            right = psychometric(difference[of], *numpy.exp(guess)).clip(1e-9, 1 - 1e-9)
            # A weak prior keeps the slope in sight of what is usual, where answers say little about it.
            return -numpy.log(numpy.where(correct[of] > 0.5, right, 1 - right)).sum() + 0.5 * ((guess[1] - math.log(2)) / 0.7)**2
        return numpy.exp(minimize(unlikely, [math.log(numpy.median(difference)), math.log(2)], method="Nelder-Mead").x)

    random, every = numpy.random.default_rng(seed), numpy.arange(len(difference))
    drawn = [best(random.choice(every, len(every)))[0] for _ in range(resamples)]
    threshold, slope = best(every)
    if not difference.min() <= threshold <= difference.max():
        threshold = math.nan
    return float(threshold), *map(float, numpy.quantile(drawn, (0.025, 0.975))), float(slope)


class Observer:
    """Answers like a person with a known threshold and slope."""

    def __init__(self, threshold: float, slope: float = 2.0, seed: int = 1) -> None:
        self.threshold, self.slope, self.random = threshold, slope, numpy.random.default_rng(seed)

    def __call__(self, trial: Trial) -> int:
        right = self.random.random() < psychometric(trial.difference, self.threshold, self.slope)
        return 2 if right == (trial.second > trial.first) else 1


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
        most = getattr(run.device.limits, {"force.limit": "maximum_force", "force.torque_limit": "maximum_torque"}.get(name, ""), math.inf)
        if value > most:
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
