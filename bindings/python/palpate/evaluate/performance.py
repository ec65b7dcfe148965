"""performance: what does an update cost? (Corenthy et al. 2012, Table 1)

The time of a proxy update while a hand explores and touches, at two resolutions, on the paper's volumes or on similar ones where those are
not available.
"""

import dataclasses
import itertools
from typing import Optional

import numpy
import palpate

from . import figures, sampling
from .experiment import Claim, Figure, Result, Table, at_most, largest, paragraphs
from .subjects import CONTESTANTS, Subject, reals, synthetic

TITLE = "What does an update cost?"
METHODS = {"exact": "exact", "paper": "the paper's method", "smooth": "exact on the smooth field"}
RESOLUTIONS = {"LR": 0.5, "HR": 3}  # voxels per millimetre of hand
# The paper's Table 1, its haptic loop on a Core 2 Duo at 3 GHz with a PHANToM Omni: size, and at LR and HR the mean time of the loop [us],
# the hand's mean speed [mm/s], and the share of the updates in contact.
PAPER = {"cylinder": ("100x100x30", (52, 95.4, 0.7209), (72, 30.4, 0.9316)),
         "daisy-pollen": ("192x180x168", (46, 39.8, 0.6159), (94, 43.1, 0.5513)),
         "visible-male": ("128x256x256", (66, 103.2, 0.7941), (103, 54.0, 0.5680)),
         "lobster": ("301x324x56", (45, 48.9, 0.6236), (83, 31.4, 0.5014)),
         "neuron": ("1024x1024x39", (46, 30.3, 0.7572), (61, 24.8, 0.4509)),
         "orange": ("256x256x64", (55, 47.0, 0.8935), (71, 30.2, 0.6060))}
STAND_INS = {"daisy-pollen": "daisy-pollen", "ct-head": "visible-male", "lobster": "lobster", "neuron": "neuron", "orange": "orange"}
OURS = (50, 0.6)  # speed [mm/s] and share on volumes that the paper does not have
TOLERANCE = 0.15  # of the target, for speed and share
DEPTH = 0.5  # [mm] of hand below the surface
BATCH = 50
SHARES = {"p50": 0.5, "p99": 0.99, "p999": 0.999, "max": 1}
TIMES = {"max_ns": ("max", figures.VERMILION, "D"), "cold_p50_ns": ("p50, caches emptied", figures.SKY, "o"),
         "p999_ns": ("p99.9", figures.ORANGE, "v"), "p99_ns": ("p99", figures.GREEN, "^"), "mean_ns": ("mean", figures.BLACK, "x"),
         "p50_ns": ("p50", figures.BLUE, ".")}


@dataclasses.dataclass
class Effort:
    trajectories: int
    trajectory_s: float
    passes: int
    cold: int  # so many updates are timed after the caches were emptied


@dataclasses.dataclass
class Case:
    """A volume and the row of the paper's table that it is measured for, if any."""

    subject: Subject
    row: Optional[str] = None

    @property
    def note(self):
        return "" if self.row in (None, self.subject.name) else f"stands in for {self.row}"


def cases_of(options):
    if options.subjects:
        return [Case(subject) for subject in options.subjects]
    cylinder = Case(synthetic("cylinder", 0.53), "cylinder")
    if options.quick:
        return [cylinder, Case(synthetic("shepp-logan:64x64x64"), "visible-male")]
    cases = [Case(subject, STAND_INS[subject.name]) for subject in reals(STAND_INS, options)]
    for case in cases:
        if case.subject.name == "neuron":
            case.subject = dataclasses.replace(case.subject, name="other-neuron")
    return [cylinder, *cases]


def moved_rows(hand):
    """All but those in which a proxy is put."""
    moved = numpy.ones(len(hand["hips"]), dtype=bool)
    moved[hand["first"]] = False
    return moved


def timed(subject, names, hand, effort):
    """Arrays of times [ns] by contestant. All take turns in each pass, so that others' work on the machine meets all. A proxy does the same
    work in every pass, so what differs between passes is the machine's."""
    felt = {name: (CONTESTANTS[name].felt(subject).field, subject.isovalue, hand["hips"], hand["first"], CONTESTANTS[name].method)
            for name in names}
    taken = {name: {"batch": [], "single": []} for name in names}
    for _, (name, of) in itertools.product(range(effort.passes), felt.items()):
        taken[name]["batch"].append(palpate.update_times(*of, batch=BATCH))
        taken[name]["single"].append(palpate.update_times(*of).astype(numpy.float32))
    for name, of in felt.items():
        every = max(1, moved_rows(hand).sum() // effort.cold) if effort.cold else 0
        taken[name]["cold"] = palpate.update_times(*of, cold=every) if every else []
        taken[name]["trace"] = palpate.follow_each(*of, threads=1)
    return taken


def weights_of(hand):
    """Updates in each batch."""
    counts = numpy.diff(numpy.append(hand["first"], len(hand["hips"]))) - 1
    return numpy.concatenate([numpy.minimum(BATCH, count - numpy.arange(0, count, BATCH)) for count in counts])


def numbers_of(taken, hand, clock=numpy.nan):
    """The mean: of each batch the median of its passes. Percentiles: over updates timed one by one, reading the clock included, of each the
    median of its passes."""
    trace, moved = taken["trace"], moved_rows(hand)
    medians = numpy.median(taken["single"], axis=0)
    return {"updates": int(moved.sum()), "mean_ns": numpy.average(numpy.median(taken["batch"], axis=0), weights=weights_of(hand)),
            **{f"{name}_ns": sampling.quantile(medians, share) for name, share in SHARES.items()},
            "interrupted_max_ns": numpy.max(taken["single"]), "cold_p50_ns": sampling.quantile(taken["cold"], 0.5),
            "clock_ns": clock, "constrained_share": trace.constrained[moved].mean(), "tetrahedra": int(trace.tetrahedra[moved].sum()),
            "tetrahedra_per_update": trace.tetrahedra[moved].mean(), "unfinished_updates": int(trace.unfinished[moved].sum())}


def rows_of(case, resolution, effort, seed):
    """The rows of one volume at one resolution: the same trajectories for all contestants."""
    subject, number = case.subject, list(RESOLUTIONS).index(resolution)
    scale = RESOLUTIONS[resolution] * subject.voxel
    paper, speed, share = PAPER[case.row][1 + number] if case.row else (numpy.nan, *OURS)
    hand = palpate.explore(subject.field, subject.isovalue, name=subject.name, depth_mm=DEPTH * scale, seed=seed,
                           trajectories=effort.trajectories, trajectory_s=effort.trajectory_s, wanted=(speed * scale, share))
    taken = timed(subject, METHODS, hand, effort)
    clock = numpy.median(palpate.update_times(subject.field, subject.isovalue, hand["hips"], hand["first"], batch=0)[:1001])
    for name in METHODS:
        numbers = numbers_of(taken[name], hand, clock)
        ratio, low, high = sampling.ratio_of_means(taken[name]["batch"], taken["exact"]["batch"], weights_of(hand))
        yield {"volume": subject.name, "note": case.note, "size": "x".join(map(str, subject.field.geometry.size)), "resolution": resolution,
               "voxels_per_mm": RESOLUTIONS[resolution], "method": name, "target_from": "paper" if case.row else "ours",
               "paper_row": case.row or "", "target_speed_mm_s": speed, "speed_mm_s": hand["speed_mm_s"] / scale,
               "target_constrained_share": share, "depth_mm": hand["depth_mm"] / scale, **numbers, "paper_mean_us": paper,
               "paper_over_ours": 1000 * paper / numbers["mean_ns"], "over_exact": ratio, "over_exact_low": low, "over_exact_high": high}


def summary_of(table):
    """The paper's Table 1 beside the same rows here."""
    for exact in table.where(method="exact", target_from="paper"):
        same = table.where(volume=exact["volume"], resolution=exact["resolution"])
        paper, smooth = (same.where(method=name)[0] for name in ("paper", "smooth"))
        volume, row = exact["volume"], exact["paper_row"]
        yield {"volume": volume if volume == row else f"{volume} for {row}", "resolution": exact["resolution"],
               "size in the paper": PAPER[row][0], "size here": exact["size"],
               "hand in the paper [cm/s]": exact["target_speed_mm_s"] / 10, "hand here [cm/s]": exact["speed_mm_s"] / 10,
               "contact in the paper [%]": 100 * exact["target_constrained_share"], "contact here [%]": 100 * exact["constrained_share"],
               "haptic loop in the paper, mean [µs]": exact["paper_mean_us"],
               "update by exact, mean [µs]": exact["mean_ns"] / 1000, "update by exact, p99.9 [µs]": exact["p999_ns"] / 1000,
               **{f"update by {what}, mean over that of exact [95 %]":
                  "{over_exact:.2f} [{over_exact_low:.2f}, {over_exact_high:.2f}]".format(**of)
                  for what, of in (("the paper's method here", paper), ("exact on the smooth field", smooth))}}


def label_times(axes, x, rows):
    """Names of the times beside those of the last row, pushed apart."""
    ends = [(rows[column][-1] / 1000, text, colour) for column, (text, colour, _) in TIMES.items()]
    height = -numpy.inf
    for value, text, colour in sorted(end for end in (*ends, (rows["paper_mean_us"][-1], "loop in the paper", figures.PURPLE))
                                      if not numpy.isnan(end[0])):
        height = max(numpy.log10(value), height + 0.33)
        axes.text(x, 10**height, text, color=colour, fontsize=6.5, va="center")


def figure_of(table):
    """LR and HR of a volume side by side."""
    drawn, panels = figures.panels(rows=3, height=7, width=5.2, sharex=True, sharey=True,
                                   title="An update takes a small part of a tick, at its slowest, too")
    for axes, (name, title) in zip(panels, METHODS.items()):
        rows = table.where(method=name)
        at = numpy.array([2.6 * (i // 2) + i % 2 for i in range(len(rows))])
        axes.vlines(at, rows["p50_ns"] / 1000, rows["max_ns"] / 1000, color="#d0d0d0", lw=1)
        axes.plot(at, rows["paper_mean_us"], "*", color=figures.PURPLE, ms=6)
        for column, (_, colour, marker) in TIMES.items():
            axes.plot(at, rows[column] / 1000, marker, color=colour, mfc="none" if column == "cold_p50_ns" else colour, ms=4)
        axes.set(title=title, yscale="log", ylim=(0.02, 3000), ylabel="time of an update [µs]", xlim=(-0.8, at[-1] + 2.4))
        figures.limit(axes, 1000, "a tick at 1 kHz")
        label_times(axes, at[-1] + 0.25, rows)
    panels[-1].set_xticks(at, [f"{row['resolution']}\n{row['volume'] if i % 2 == 0 else ''}" for i, row in enumerate(rows)], fontsize=6.5)
    return Figure("", """Time of a proxy update while a hand explores and touches as fast and as often as in each row of the paper's Table
        1, at 1 kHz and 0.5 (LR) and 3 (HR) voxels per millimetre of hand. Stars: the means that the paper gives for its haptic loop, on its
        machine. Open circles: the median when all caches were emptied before the update.""", drawn)


def claims_of(table, options):
    for method in ("exact", "smooth"):
        yield at_most(0, table.where(method=method)["unfinished_updates"], f"every update of {method} is finished within its tick",
                      "{:g} were not")
    exact = table.where(method="exact")
    off = max(largest(abs(exact[name] / exact[f"target_{name}"] - 1)) for name in ("speed_mm_s", "constrained_share"))
    said = f"largest distance {100 * off:.2g} %"
    if not options.subjects:
        yield Claim(f"the hand's mean speed and its share of contact by exact are within {100 * TOLERANCE:g} % of each row's target",
                    off <= TOLERANCE, said)
    elif off > TOLERANCE:
        options.note(f"performance: the hand cannot keep to its targets on this volume, which is very small or very ragged ({said} of the "
                     "target)")


def paragraphs_of(table, effort):
    def most(column, unit=1000, form=".1f"):
        return ", ".join(f"{largest(table.where(method=name)[column]) / unit:{form}}" for name in METHODS)

    cold = f"""

        Caches are warm, since the updates follow one another. After something else has used all caches, the median update of exact takes up
        to {largest(table.where(method="exact")["cold_p50_ns"]) / 1000:.1f} µs."""
    return paragraphs(f"""
        A simulated hand explores free space and then touches, at 1 kHz, {DEPTH:g} mm below the surface (less on bodies too fine for that).
        1 mm of hand is 0.5 voxel (LR) or 3 voxels (HR). Its mean speed and its share of contact are those of the same row of the paper's
        Table 1. On a volume that is not in it, they are {OURS[0]:g} mm/s and {100 * OURS[1]:g} %.

        The paper timed its whole haptic loop on a Core 2 Duo at 3 GHz. Here it is the proxy update, and the machines are many years apart,
        so only methods on this machine are compared: in alternating passes, with the ratio of the means and its 95 % interval. For
        exact, the paper's method and exact on the smooth field, the largest mean over all rows is {most("mean_ns", 1, ".0f")} ns, the
        largest p99.9 {most("p999_ns")} µs, and the longest update {most("max_ns")} µs of the 1000 µs that a tick has. Each update was timed
        {effort.passes} times and its median kept, since other programs share the machine; the largest single time, interruptions included,
        was {largest(table["interrupted_max_ns"]) / 1000:.0f} µs.{cold if effort.cold else ""}""")


def run(options):
    effort = Effort(4, 1.5, 9, 0) if options.quick else Effort(24, 5, 9, 200)
    cases = options.each(itertools.product(cases_of(options), RESOLUTIONS))
    table = Table(row for case in cases for row in rows_of(*case, effort, options.seed))
    return Result(table, [figure_of(table)], list(claims_of(table, options)), paragraphs_of(table, effort), Table(summary_of(table)))
