"""streaming: how long does a hand wait for a volume that is read while it is touched? The judge is in evaluation/stroke.cpp."""

import collections
import itertools

import numpy
import palpate

from . import figures
from .experiment import Page, Result, Table, largest

PAGE = Page(__name__)
FAILURES = 0.05  # of the requests of a network
MEMORY = 128  # [MB] that bricks and decoded pieces may take
LEVELS = ("finest level", "coarse first")
COLOURS = (figures.BLUE, figures.GREEN, figures.ORANGE, figures.VERMILION)  # of latencies


Plan = collections.namedtuple("Plan", "latencies speeds seconds rate")  # [ms], [voxel/s], of a stroke, [Hz]
QUICK = Plan((0, 50), (300, 3000), 1.5, 1000)
FULL = Plan((0, 20, 100, 200), (100, 300, 1000, 5000, 20000), 10, 2500)


def row_of(plan, levels, latency, speed, seed):
    felt = palpate.streaming_stroke(latency_s=1e-3 * latency, failures=FAILURES if latency else 0, speed_mm_s=speed * palpate.BALL_VOXEL,
                                    coarse_first=levels == LEVELS[1], seconds=plan.seconds, rate=plan.rate, memory_bytes=MEMORY * 10**6,
                                    seed=seed)
    ticks, contact = felt["ticks"], felt["first_contact_s"]
    depths = {"deepest_voxel": felt["deepest_voxel"], "beyond_allowed_voxel": felt["beyond_voxel"]}
    return {"levels": levels, "latency_ms": latency, "speed_voxel_s": speed, "ticks": ticks,
            **{f"{name}_share": felt[name] / max(1, ticks) for name in ("touching", "waiting", "coarse")},
            **{name: depth if depth > -1e8 else numpy.nan for name, depth in depths.items()},
            "first_contact_s": contact if contact >= 0 else numpy.nan, "most_mb": 1e-6 * felt["most_bytes"],
            "requests": felt["requests"], "retries": felt["retries"], "read_mb": 1e-6 * felt["read_bytes"]}


def summary_of(table, plan):
    """Ticks that wait [%], a row for each latency."""
    for levels, latency in itertools.product(LEVELS, plan.latencies):
        yield {"levels": levels, "request [ms]": latency,
               **{f"waits at {row['speed_voxel_s']:g} voxel/s [%]": round(100 * row["waiting_share"], 1)
                  for row in table.where(levels=levels, latency_ms=latency)}}


def lines(panels, table, column, factor, label):
    """A line for each latency, against the hand's speed; a panel for each kind of levels."""
    for axes, levels in zip(panels, LEVELS):
        for (latency, rows), colour in zip(table.where(levels=levels).by("latency_ms"), COLOURS):
            axes.plot(rows["speed_voxel_s"], factor * rows[column], "o-", color=colour, label=f"{latency:g} ms per request")
        axes.set(xscale="log", title=levels)
    panels[0].set_ylabel(label)


def spared(table):
    """The least part of its waiting that coarser levels spare a hand, of all strokes with a latency that wait at the finest level."""
    waits, waits_coarse = ({(row["latency_ms"], row["speed_voxel_s"]): row["waiting_share"] for row in table.where(levels=levels)}
                           for levels in LEVELS)
    return min((1 - waits_coarse[case] / share for case, share in waits.items() if case[0] > 0 and share > 0), default=0)


def title_of(table):
    part = int(100 * spared(table))
    return (f"With latency, coarser levels spare a hand at least {part} % of its waiting" if part > 0 else
            "Coarser levels do not spare every hand waiting")


def figures_of(table):
    drawn, panels = figures.panels(columns=2, height=2.6, sharey=True, title=title_of(table))
    lines(panels, table, "waiting_share", 100, "ticks that wait [%]")
    for axes in panels:
        axes.set(xlabel="speed of the hand [voxel/s]", ylim=(-3, 103))
    figures.label_ends(panels[1])
    yield PAGE.figure(drawn)
    drawn, (above, below) = figures.panels(2, 2, height=4.2, sharex=True, sharey="row",
                                           title="The memory stays below its bound, whatever the hand does")
    lines(above, table, "read_mb", 1e-3, "read in a stroke [GB]")
    lines(below, table, "most_mb", 1, "memory [MB]")
    for axes in below:
        axes.set(title="", xlabel="speed of the hand [voxel/s]", ylim=(0, 1.25 * MEMORY))
        figures.limit(axes, MEMORY, "bound", ":")
    above[0].set_ylim(0, None)
    figures.label_ends(above[1])
    yield PAGE.figure(drawn, "traffic")


def claims_of(table):
    judged = table.only(lambda row: row.get("beyond_allowed_voxel", numpy.nan) < numpy.inf)  # not NaN
    beyond, moved = judged["beyond_allowed_voxel"].max(initial=-numpy.inf), (judged["ticks"] * (1 - judged["waiting_share"])).sum()
    left = PAGE.text("not judged", left=len(table) - len(judged)) if len(judged) < len(table) else [""]
    yield PAGE.claim("path", judged and beyond <= 0, room=-beyond, judged=len(judged), strokes=len(table), moved=moved, left=left[0])
    yield PAGE.at_most(MEMORY, table["most_mb"], "memory")


def text_of(table, plan):
    latency, slow, fast = plan.latencies[-1], plan.speeds[0], plan.speeds[-1]
    waits = [100 * table.where(levels=levels, latency_ms=latency, speed_voxel_s=speed)[0]["waiting_share"]
             for speed, levels in itertools.product((slow, fast), LEVELS)]
    return PAGE.text(failures=100 * FAILURES, rate=plan.rate, seconds=plan.seconds, latency=latency, slow=slow, fast=fast, waits=waits,
                     contact=largest(table.where(latency_ms=latency, speed_voxel_s=fast)["first_contact_s"]))


def run(options):
    options.refuse_volumes("streaming has a volume")
    plan = QUICK if options.quick else FULL
    cases = options.each(itertools.product(LEVELS, plan.latencies, plan.speeds))
    table = Table(row_of(plan, *case, options.seed) for case in cases)
    return Result(table, figures_of(table), claims_of(table), text_of(table, plan), summary_of(table, plan))
