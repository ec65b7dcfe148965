"""performance: what does an update cost? (Corenthy et al. 2012, Table 1)"""

import collections
import dataclasses
import itertools

import numpy
import palpate

from . import figures, sampling
from .experiment import Page, Result, Table, known, largest
from .subjects import CONTESTANTS, reals, synthetic

PAGE = Page(__name__)
METHODS = {"exact": "exact", "paper": "the paper's method", "smooth": "exact on the smooth field"}
RESOLUTIONS = {"LR": 0.5, "HR": 3}  # voxels per millimetre of hand
PAPER = known("paper")
NAMES = {"neuron": "other-neuron"}  # of a volume that is not the one of its name in the paper
STAND_INS = {"daisy-pollen": "daisy-pollen", "ct-head": "visible-male", "lobster": "lobster", "neuron": "neuron", "orange": "orange"}
OURS = {"mean_us": numpy.nan, "speed_mm_s": 50, "constrained_share": 0.6}  # on volumes that the paper does not have
TOLERANCE = 0.15  # of the target, for speed and share
DEPTH = 0.5  # [mm] of hand below the surface
BATCH = 50
SHARES = {"p50": 0.5, "p99": 0.99, "p999": 0.999, "max": 1}
TIMES = {"max_ns": ("max", figures.VERMILION, "D"), "cold_p50_ns": ("p50, caches emptied", figures.SKY, "o"),
         "p999_ns": ("p99.9", figures.ORANGE, "v"), "p99_ns": ("p99", figures.GREEN, "^"), "mean_ns": ("mean", figures.BLACK, "x"),
         "p50_ns": ("p50", figures.BLUE, ".")}


Effort = collections.namedtuple("Effort", "trajectories trajectory_s passes cold")


def cases_of(options):
    """(volume, the row of the paper's table that it is measured for, if any)."""
    if options.subjects:
        return [(subject, None) for subject in options.subjects]
    head = [(synthetic("shepp-logan:64x64x64"), "visible-male")] if options.quick else []
    return [(synthetic("cylinder", 0.53), "cylinder"), *head,
            *((dataclasses.replace(subject, name=NAMES.get(subject.name, subject.name)), STAND_INS[subject.name])
              for subject in reals(STAND_INS, options))]


def moved_rows(hand):
    """All but those in which a proxy is put."""
    moved = numpy.ones(len(hand["hips"]), dtype=bool)
    moved[hand["first"]] = False
    return moved


def timed(subject, names, hand, passes, cold=0):
    """Arrays of times [ns] by contestant. All take turns in each pass, so that others' work on the machine meets all. A proxy does the same
    work in every pass, so what differs between passes is the machine's. cold: about so many updates more, after emptied caches."""
    felt = {name: (CONTESTANTS[name].felt(subject).field, subject.isovalue, hand["hips"], hand["first"], CONTESTANTS[name].method)
            for name in names}
    taken = {name: {"batch": [], "single": []} for name in names}
    for _, (name, of) in itertools.product(range(passes), felt.items()):
        taken[name]["batch"].append(palpate.update_times(*of, batch=BATCH))
        taken[name]["single"].append(palpate.update_times(*of).astype(numpy.float32))
    for name, of in felt.items():
        every = max(1, moved_rows(hand).sum() // cold) if cold else 0
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


def rows_of(subject, row, resolution, effort, seed):
    """The rows of one volume at one resolution: the same trajectories for all contestants."""
    scale = RESOLUTIONS[resolution] * subject.voxel
    paper = PAPER.where(volume=row, resolution=resolution)[0] if row else OURS
    speed, share = paper["speed_mm_s"], paper["constrained_share"]
    hand = palpate.explore(subject.field, subject.isovalue, name=subject.name, depth_mm=DEPTH * scale, seed=seed,
                           trajectories=effort.trajectories, trajectory_s=effort.trajectory_s, wanted=(speed * scale, share))
    taken = timed(subject, METHODS, hand, effort.passes, effort.cold)
    clock = numpy.median(palpate.update_times(subject.field, subject.isovalue, hand["hips"], hand["first"], batch=0)[:1001])
    for name in METHODS:
        numbers = numbers_of(taken[name], hand, clock)
        ratio, low, high = sampling.ratio_of_means(taken[name]["batch"], taken["exact"]["batch"], weights_of(hand))
        yield {"volume": subject.name, "note": "" if row in (None, subject.name) else f"stands in for {row}",
               "size": "x".join(map(str, subject.field.geometry.size)), "resolution": resolution,
               "voxels_per_mm": RESOLUTIONS[resolution], "method": name, "target_from": "paper" if row else "ours",
               "paper_row": row or "", "target_speed_mm_s": speed, "speed_mm_s": hand["speed_mm_s"] / scale,
               "target_constrained_share": share, "depth_mm": hand["depth_mm"] / scale, **numbers, "paper_mean_us": paper["mean_us"],
               "paper_over_ours": 1000 * paper["mean_us"] / numbers["mean_ns"],
               "over_exact": ratio, "over_exact_low": low, "over_exact_high": high}


def summary_of(table):
    """The paper's Table 1 beside the same rows here."""
    for exact in table.where(method="exact", target_from="paper"):
        same = table.where(volume=exact["volume"], resolution=exact["resolution"])
        paper, smooth = (same.where(method=name)[0] for name in ("paper", "smooth"))
        volume, row = exact["volume"], exact["paper_row"]
        yield {"volume": volume if volume == row else f"{volume} for {row}", "resolution": exact["resolution"],
               "size, in the paper / here": f"{PAPER.where(volume=row)[0]['size']} / {exact['size']}",
               "hand, in the paper / here [cm/s]": f"{exact['target_speed_mm_s'] / 10:.4g} / {exact['speed_mm_s'] / 10:.4g}",
               "contact, in the paper / here [%]": f"{100 * exact['target_constrained_share']:.4g} / {100 * exact['constrained_share']:.4g}",
               "haptic loop in the paper, mean [µs]": exact["paper_mean_us"],
               "update by exact, mean [µs]": exact["mean_ns"] / 1000, "p99.9 [µs]": exact["p999_ns"] / 1000,
               **{f"{what}, mean over that of exact [95 % interval]":
                  "{over_exact:.2f} [{over_exact_low:.2f}, {over_exact_high:.2f}]".format(**of)
                  for what, of in (("the paper's method here", paper), ("exact on the smooth field", smooth))}}


def figure_of(table):
    """LR and HR of a volume side by side."""
    drawn, panels = figures.panels(rows=3, height=7, width=5.2, sharex=True, sharey=True,
                                   title="An update takes a small part of a tick, at its slowest, too")
    for axes, (name, title) in zip(panels, METHODS.items()):
        rows = table.where(method=name)
        at = numpy.array([2.6 * (i // 2) + i % 2 for i in range(len(rows))])
        axes.vlines(at, rows["p50_ns"] / 1000, rows["max_ns"] / 1000, color="#d0d0d0", lw=1)
        axes.plot(at, rows["paper_mean_us"], "*", color=figures.PURPLE, ms=6, label="loop in the paper")
        for column, (text, colour, marker) in TIMES.items():
            axes.plot(at, rows[column] / 1000, marker, color=colour, mfc="none" if column == "cold_p50_ns" else colour, ms=4, label=text)
        axes.set(title=title, yscale="log", ylim=(0.02, 3000), ylabel="time of an update [µs]")
        figures.limit(axes, 1000, "a tick at 1 kHz")
    panels[-1].set_xticks(at, [f"{row['resolution']}\n{row['volume'] if i % 2 == 0 else ''}" for i, row in enumerate(rows)], fontsize=6.5)
    figures.label_ends(*panels)
    return PAGE.figure(drawn)


def claims_of(table, options):
    for method in ("exact", "smooth"):
        yield PAGE.at_most(0, table.where(method=method)["unfinished_updates"], "finished", method=method)
    exact = table.where(method="exact")
    off = max(largest(abs(exact[name] / exact[f"target_{name}"] - 1)) for name in ("speed_mm_s", "constrained_share"))
    if not options.subjects:
        yield PAGE.claim("target", off <= TOLERANCE, tolerance=100 * TOLERANCE, off=100 * off)
    elif off > TOLERANCE:
        options.note(*PAGE.text("far from the target", off=100 * off))


def text_of(table, effort):
    def most(column, unit=1000, form="{:.1f} µs"):
        *others, last = [f"{form.format(largest(table.where(method=name)[column]) / unit)} ({title})" for name, title in METHODS.items()]
        return f"{', '.join(others)} and {last}"

    return PAGE.text("", *(["cold"] if effort.cold else []), own_share=100 * OURS["constrained_share"], passes=effort.passes,
                     means=most("mean_ns", 1, "{:.0f} ns"), p999s=most("p999_ns"), longest=most("max_ns"),
                     interrupted=largest(table["interrupted_max_ns"]) / 1000, cold=most("cold_p50_ns"))


def run(options):
    effort = Effort(4, 1.5, 9, 0) if options.quick else Effort(24, 5, 9, 200)
    cases = options.each(itertools.product(cases_of(options), RESOLUTIONS))
    table = Table(row for volume, resolution in cases for row in rows_of(*volume, resolution, effort, options.seed))
    return Result(table, [figure_of(table)], claims_of(table, options), text_of(table, effort), summary_of(table))
