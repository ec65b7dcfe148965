"""streaming: how long does a hand wait for a volume that is read while it is touched?

A hand goes through a volume of 1.9 TB that is read as over a slow network. The judge knows the formula of the volume and follows the path
of the proxy step by step (evaluation/stroke.cpp).
"""

import dataclasses
import itertools

import numpy
import palpate

from . import figures
from .experiment import Claim, Figure, Result, Table, at_most, largest, paragraphs

TITLE = "How long does a hand wait for a volume that is read while it is touched?"
FAILURES = 0.05  # of the requests of a network
MEMORY = 128e6  # [bytes] that bricks and decoded pieces may take
LEVELS = ("finest level", "coarse first")
COLOURS = (figures.BLUE, figures.GREEN, figures.ORANGE, figures.VERMILION)  # of latencies


@dataclasses.dataclass
class Plan:
    latencies: tuple  # [ms]
    speeds: tuple  # [voxel/s]
    seconds: float  # of a stroke
    rate: float  # [Hz]


def plan_of(quick):
    return Plan((0, 50), (300, 3000), 1.5, 1000) if quick else Plan((0, 20, 100, 200), (100, 300, 1000, 5000, 20000), 10, 2500)


def row_of(plan, levels, latency, speed, seed):
    felt = palpate.streaming_stroke(latency_s=1e-3 * latency, failures=FAILURES if latency else 0, speed_mm_s=speed * palpate.BALL_VOXEL,
                                    coarse_first=levels == LEVELS[1], seconds=plan.seconds, rate=plan.rate, memory_bytes=int(MEMORY),
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


def lines(panels, table, plan, column, factor, label):
    """A line for each latency, against the hand's speed; a panel for each kind of levels."""
    for axes, levels in zip(panels, LEVELS):
        for latency, colour in zip(plan.latencies, COLOURS):
            rows = table.where(levels=levels, latency_ms=latency)
            axes.plot(rows["speed_voxel_s"], factor * rows[column], "o-", color=colour, label=f"{latency:g} ms per request")
        axes.set(xscale="log", title=levels)
    panels[0].set_ylabel(label)


def waiting_figure(table, plan):
    drawn, panels = figures.panels(columns=2, height=2.6, sharey=True, title="Coarser levels spare a fast hand most of its waiting")
    lines(panels, table, plan, "waiting_share", 100, "ticks that wait [%]")
    for axes in panels:
        axes.set(xlabel="speed of the hand [voxel/s]", ylim=(-3, 103))
    figures.label_ends(panels[1])
    return Figure("", """Ticks that wait for samples, against the hand's speed, for each latency of the network. Left: only the finest level
        is felt. Right: a coarser level while the finer one has not loaded, or if the hand is too fast for it.""", drawn)


def traffic_figure(table, plan):
    drawn, panels = figures.panels(2, 2, height=4.2, sharex=True, sharey="row",
                                   title="The memory stays below its bound, whatever the hand does")
    lines(panels[0], table, plan, "read_mb", 1e-3, "read in a stroke [GB]")
    lines(panels[1], table, plan, "most_mb", 1, "memory [MB]")
    for axes in panels[1]:
        axes.set(title="", xlabel="speed of the hand [voxel/s]", ylim=(0, 1.25e-6 * MEMORY))
        figures.limit(axes, 1e-6 * MEMORY, "bound", ":")
    panels[0, 0].set_ylim(0, None)
    figures.label_ends(panels[0, 1])
    return Figure("traffic", """Above: samples read in a stroke. Below: the most memory that bricks and decoded pieces took, with the bound
        as a dotted line.""", drawn)


def claims_of(table):
    beyond = numpy.nanmax(table["beyond_allowed_voxel"])
    return [Claim("no point of the proxy's path lies in a ball deeper than the samples' rounding and the interpolation at the level felt "
                  "may take", bool(beyond <= 0), f"at most {beyond:.2f} voxel beyond, {table['ticks'].sum():.0f} ticks"),
            at_most(1e-6 * MEMORY, table["most_mb"], "bricks and decoded pieces never take more memory than they may",
                    f"at most {{:.1f}} of {1e-6 * MEMORY:.0f} MB")]


def paragraphs_of(table, plan):
    latency, slow, fast = plan.latencies[-1], plan.speeds[0], plan.speeds[-1]

    def waits(levels, speed):
        return f"{100 * table.where(levels=levels, latency_ms=latency, speed_voxel_s=speed)[0]['waiting_share']:.0f} %"

    contact = largest(table.where(latency_ms=latency, speed_voxel_s=fast)["first_contact_s"])
    return paragraphs(f"""
        A hand goes to and fro through a row of balls of 256 voxels in a volume of 12288^3 samples. They are computed when they are asked
        for, after the latency of a network that fails in {100 * FAILURES:.0f} % of the requests. It starts with nothing in memory, and
        bricks and pieces may take {1e-6 * MEMORY:.0f} MB. Ticks come in real time, at {plan.rate:g} Hz.

        At {latency:g} ms per request and {slow:g} voxel/s, {waits(LEVELS[0], slow)} of the ticks wait for samples where only the finest
        level is felt, and {waits(LEVELS[1], slow)} where coarser ones are allowed. At {fast:g} voxel/s it is {waits(LEVELS[0], fast)} and
        {waits(LEVELS[1], fast)}. The first contact at that speed came within {contact:.1f} s of opening the store.""")


def run(options):
    options.refuse_volumes("streaming has a volume")
    plan = plan_of(options.quick)
    cases = options.each(itertools.product(LEVELS, plan.latencies, plan.speeds))
    table = Table(row_of(plan, *case, options.seed) for case in cases)
    return Result(table, [waiting_figure(table, plan), traffic_figure(table, plan)], claims_of(table), paragraphs_of(table, plan),
                  Table(summary_of(table, plan)))
