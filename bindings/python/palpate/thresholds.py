"""Thresholds of people from the answers of palpate.trials: a psychometric function, its fit, and observers whose threshold is known."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy

GUESS, LAPSE = 0.5, 0.02  # of two alternatives; answers beside the question, assumed
AT = 0.5 ** (1 / 3)  # of the right answers without lapses, to which a staircase of three down and one up converges (Levitt 1971)
SLOPE, SPREAD = 2.0, 1.0  # the usual slope, and how far slopes lie from it: standard deviation of the logarithm


def psychometric(difference: Any, threshold: float, slope: float) -> Any:
    """The part of right answers: a Weibull function of log difference, which is 78.2 % at the threshold, and 79.4 % without lapses."""
    reach = -numpy.log(2 * (1 - AT))
    return GUESS + (1 - GUESS - LAPSE) * (1 - numpy.exp(-reach * (numpy.asarray(difference) / threshold)**slope))


def _likelihood(rows: Sequence[Mapping[str, Any]], thresholds: Any, slopes: Any) -> Any:
    """Its logarithm, with the prior of the slope: for each threshold and slope."""
    difference, correct = (numpy.array([row[name] for row in rows], dtype=float) for name in ("difference", "correct"))
    found = numpy.zeros((len(thresholds), len(slopes))) - 0.5 * (numpy.log(slopes / SLOPE) / SPREAD)**2
    for one in numpy.unique(difference):
        right = psychometric(one, thresholds[:, None], slopes).clip(1e-9, 1 - 1e-9)
        answers = correct[difference == one] > 0.5
        found += answers.sum() * numpy.log(right) + (~answers).sum() * numpy.log1p(-right)
    return found


def _quantiles(grid: Any, weights: Any, parts: Sequence[float]) -> list[float]:
    """On a grid whose logarithm is even."""
    below = (numpy.cumsum(weights) - 0.5 * weights) / weights.sum()
    return [float(numpy.exp(numpy.interp(part, below, numpy.log(grid)))) for part in parts]


def fit(rows: Sequence[Mapping[str, Any]]) -> tuple[float, float, float, float]:
    """(threshold, low, high, slope): medians, and the 95 % interval of the threshold. Raises ValueError.

    They are those of the posterior distribution, on a grid. A staircase chooses its differences by earlier answers alone, so the likelihood
    is that of trials whose differences were given. A bootstrap by trials does not know that, and its intervals are too narrow. Every
    threshold is as likely beforehand (in logarithms). The threshold is NaN if it is not within the differences that were asked. low is 0
    and high infinite if the answers do not exclude a threshold far below or above these differences."""
    asked, correct = (numpy.array([row[name] for row in rows], dtype=float) for name in ("difference", "correct"))
    if len(asked) < 10 or not 0 < correct.mean() < 1:
        raise ValueError("10 trials or more are needed, with right and with wrong answers")
    thresholds = numpy.geomspace(asked.min() / 30, asked.max() * 30, 501)
    slopes = numpy.geomspace(SLOPE / 20, SLOPE * 20, 61)
    with numpy.errstate(over="ignore"):  # steep slopes far from the threshold
        found = _likelihood(rows, thresholds, slopes)
    weights = numpy.exp(found - found.max())
    of_threshold, of_slope = weights.sum(axis=1), weights.sum(axis=0)
    low, threshold, high = _quantiles(thresholds, of_threshold, (0.025, 0.5, 0.975))
    excluded = math.exp(-2) * of_threshold.max()  # two standard deviations from the middle of a normal distribution
    if of_threshold[0] > excluded:
        low = 0.0
    if of_threshold[-1] > excluded:
        high = math.inf
    if not asked.min() <= threshold <= asked.max():
        threshold = math.nan
    return threshold, low, high, _quantiles(slopes, of_slope, (0.5,))[0]


class Observer:
    """Answers like a person with a known threshold and slope."""

    def __init__(self, threshold: float, slope: float = 2.0, seed: int = 1) -> None:
        self.threshold, self.slope, self.random = threshold, slope, numpy.random.default_rng(seed)

    def __call__(self, trial: Any) -> int:
        right = self.random.random() < psychometric(trial.difference, self.threshold, self.slope)
        return 2 if right == (trial.second > trial.first) else 1
