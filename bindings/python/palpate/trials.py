"""Trials with people: which of two touches had more of a setting? A staircase or constant differences in random order, a CSV from which
an interrupted session continues, and the fit of a psychometric function (docs/tutorials/user_study.md).

    python3 -m palpate.trials run head.nrrd@34.5 p01.csv --setting stiffness --standard 0.3 --device haply
    python3 -m palpate.trials analyse p01.csv p02.csv
"""

import argparse
import csv
import dataclasses
import difflib
import math
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn, Optional, Union

import numpy

from .errors import InputError, OutputError, exit_status

_Path = Union[str, Path]
_Row = dict[str, float]

COLUMNS = ("trial", "difference", "first", "second", "answer", "correct")
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
        if not (self.standard > 0 and all(0 < d < math.inf for d in (self.difference, *self.differences)) and self.repeats > 0):
            raise ValueError("standard, differences and repeats have to be above 0")
        if not max((self.difference, *self.differences)) <= self.most < math.inf:
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
    """Rows of a session: dicts of numbers. With a plan, they have to be its trials. Raises InputError."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            lines = list(csv.reader(file))
    except (OSError, UnicodeError) as error:
        raise InputError(f"{path}: {getattr(error, 'strerror', None) or 'is no text'}: check the name") from error
    rows = []
    for number, line in enumerate(lines[1:], 2):
        try:
            row = dict(zip(COLUMNS, map(float, line)))
            if len(line) != len(COLUMNS):
                raise ValueError
        except ValueError as error:
            raise InputError(f"{path}, line {number}: {len(COLUMNS)} numbers are needed") from error
        trial = next_trial(plan, [r["correct"] for r in rows]) if plan else None
        if plan and (trial is None or any(abs(row[name] - value) > 1e-9 for name, value in dataclasses.asdict(trial).items())):
            raise InputError(f"{path}, line {number}: this is no trial of the plan; use another file for another plan")
        rows.append(row)
    if lines[:1] != [list(COLUMNS)]:
        raise InputError(f"{path}: no session of trials")
    return rows


def session(path: _Path, plan: Plan, ask: Callable[[Trial], int]) -> list[_Row]:
    """Asks all trials that are missing in the file. ask(trial): 1 or 2, the touch that had more. Every answer is in the file before the
    next trial begins."""
    path = Path(path)
    if not path.exists() or path.stat().st_size == 0:
        _append(path, ",".join(COLUMNS))
    rows = read(path, plan)
    while trial := next_trial(plan, [row["correct"] for row in rows]):
        answer = ask(trial)
        row = {**dataclasses.asdict(trial), "answer": answer, "correct": int((answer == 2) == (trial.second > trial.first))}
        _append(path, ",".join(repr(row[name]) for name in COLUMNS))
        rows.append(row)
    return rows


def _append(path: Path, line: str) -> None:
    try:
        with path.open("a", encoding="utf-8") as file:
            file.write(line + "\n")
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from error


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
             key: Callable[[str], str] = input) -> Callable[[Trial], int]:
    """Asks by two touches of a device, one after the other, and a key. Each touch is recorded in the
    folder. A trial in which nothing was felt is asked again. largest: value of the setting. Raises ValueError if the device cannot
    render it as it is."""
    import palpate
    if not 0 < seconds < math.inf:
        raise ValueError("the seconds of a touch have to be above 0")
    loaded, folder = palpate.load(volume), Path(folder)

    def opened(value):
        setup = palpate.Setup(isovalue=level, device=device)
        put(setup.render, name, value)
        return palpate.Run(loaded, setup), setup.render.stiffness or 0

    def felt(value, file):
        run, stiffness = opened(value)
        file.unlink(missing_ok=True)  # of a trial that was interrupted
        with run:
            run.record(file)
            time.sleep(seconds)
            run.stop_recording()
            if run.problem:
                raise RuntimeError(f"device: {run.problem}")
            now = run.snapshot()
            if now and now.stiffness < stiffness:  # a device may tell its limits only once it is connected
                raise ValueError(f"stiffness [N/mm] = {stiffness:g}: the device renders only {now.stiffness:g} stably")
        return bool(palpate.read_recording(file).trace.force.any())

    def ask(trial):
        folder.mkdir(parents=True, exist_ok=True)
        while True:
            both = True
            for number, value in enumerate((trial.first, trial.second), 1):
                print(f"Trial {trial.trial + 1}: touch {number}", file=sys.stderr, flush=True)
                both &= felt(value, folder / f"{trial.trial}-{number}.csv")
            if both:
                break
            key("Nothing was felt in one of them. Press Enter to touch both again. ")
        while (answer := key("Which one was more, 1 or 2? ").strip()) not in ("1", "2"):
            pass
        return int(answer)

    opened(largest)  # Run refuses what the device cannot render stably
    return ask


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"palpate: {message} (see {self.prog} --help)\n")


def main(words: Optional[Sequence[str]] = None) -> int:
    parser = _Parser(prog="python3 -m palpate.trials", description="Two-alternative trials over a setting of touch")
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="ask the trials that are missing in FILE; it continues after an interruption")
    run.add_argument("volume", help="VOLUME@ISOVALUE, such as head.nrrd@34.5 or head.nrrd@20%%; without @ the suggested level")
    run.add_argument("file", help="CSV of the session")
    run.add_argument("--setting", default="stiffness", help="name in RenderSetup, such as force.damping [stiffness]")
    run.add_argument("--standard", type=float, required=True, help="value of the setting that others are compared with")
    run.add_argument("--difference", type=float, default=0.5, help="of the staircase's first trial, as a part of the standard [0.5]")
    run.add_argument("--most", type=float, default=1, help="largest difference that is asked, as a part of the standard [1]")
    run.add_argument("--differences", type=float, nargs="+", default=(), help="constant ones in random order instead of a staircase")
    run.add_argument("--repeats", type=int, default=20, help="of each constant difference [20]")
    run.add_argument("--seed", type=int, default=1, help="another one for each participant [1]")
    run.add_argument("--device", default="simulated:hand=press")
    run.add_argument("--seconds", type=float, default=3, help="of each touch [3]")
    analyse = commands.add_parser("analyse", help="fit a psychometric function to each session")
    analyse.add_argument("files", nargs="+")
    chosen = parser.parse_args(words)
    try:
        if chosen.command == "run":
            volume, at, level = chosen.volume.rpartition("@")
            volume, level = (volume, level) if at else (level, None)
            plan = Plan(chosen.standard, chosen.difference, tuple(chosen.differences), chosen.repeats, chosen.seed, chosen.most)
            largest = plan.standard * (1 + (max(plan.differences) if plan.differences else plan.most))
            touches = Path(chosen.file).with_suffix(".touches")
            session(chosen.file, plan, touching(volume, level, chosen.device, chosen.setting, chosen.seconds, touches, largest))
            return 0
        print("file,trials,threshold,low,high,slope")
        for file in chosen.files:
            rows = read(file)
            print(file, len(rows), *(f"{value:.4g}" for value in fit(rows)), sep=",")
    except KeyboardInterrupt as error:
        print("\nthe same command continues", file=sys.stderr)
        return exit_status(error)
    except (ValueError, OSError, RuntimeError, EOFError) as error:
        print(f"palpate: {error}", file=sys.stderr)
        return exit_status(error)
    return 0


if __name__ == "__main__":
    sys.exit(main())
