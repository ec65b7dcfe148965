"""drift: does the proxy stay on the isosurface? (Corenthy et al. 2012, Fig. 10)"""

import itertools

import numpy

from . import figures, sampling
from .experiment import GRANTED, Page, Result, Table, largest
from .hands import Ring
from .subjects import CONTESTANTS, GUARDED, reals, synthetic

PAGE = Page(__name__)
SHOWN_SPEED, SHOWN_RATE = 200, 1000  # of the hand in the figure



def go_round(subject, ring, contestant, speed, rate, turns):
    """A row of the table for each turn of one proxy. The hand comes from outside, so that every method starts in contact from
    the free side."""
    felt, start = contestant.felt(subject), ring.at([0.0])
    proxy = contestant.proxy(subject, ring.centre + 2 * (start[0] - ring.centre))
    proxy.follow(start)
    step, arc, worst, updates = speed / rate, 0.0, 0.0, 0
    for turn in range(1, turns + 1):
        most = int((turn * ring.length - arc) / step) + 2
        arcs = numpy.add.accumulate(numpy.concatenate([[arc], numpy.full(most, step)]))
        inside = int(numpy.searchsorted(arcs, turn * ring.length))
        arc = arcs[inside]
        trace = proxy.follow(ring.at(arcs[:inside]))
        off = felt.excess(trace.density)
        worst = max(worst, largest(numpy.where(trace.constrained, abs(off), off)))
        updates += inside
        yield {"volume": subject.name, "method": contestant.name, "speed_mm_s": speed, "rate_hz": rate, "turn": turn,
               "density": trace.density[-1] if inside else 0.0, "isovalue": subject.isovalue, "worst_deviation_of_range": worst,
               "constrained_share": numpy.count_nonzero(trace.constrained) / max(1, inside), "updates": updates}


def summary_of(last):
    for name, rows in last.by("method"):
        worst = rows["worst_deviation_of_range"]
        yield {"method": name, "largest deviation [part of the range]": f"{largest(worst):.2g}",
               "median of the runs [95 % interval]": sampling.in_words(worst, "{:.2g}"), "runs": len(rows),
               "updates": f"{sum(rows['updates']):,.0f}"}


def in_words(rows, stay):
    """The contestants that are always on the isosurface, or the others."""
    return ", ".join(name for name, own in rows.by("method")
                     if stay == (largest(own["worst_deviation_of_range"]) <= GRANTED)) or "none"


def figure_of(table, last):
    drawn, (left, right) = figures.panels(columns=2, height=2.7)
    shown = table.where(volume=table[0]["volume"], speed_mm_s=SHOWN_SPEED, rate_hz=SHOWN_RATE)
    rates = sorted(last.distinct("rate_hz"))
    left.axhline(shown[0]["isovalue"], color=figures.GREY, lw=0.8, ls="--")
    for name, rows in shown.by("method"):
        figures.curve(left, name, rows["turn"], rows["density"], markevery=0.25)
        figures.curve(right, name, rates, [max(1e-17, largest(last.where(method=name, rate_hz=rate)["worst_deviation_of_range"]))
                                           for rate in rates])
    left.set(title=f"{table[0]['volume']}, off the surface:\n{in_words(shown, False)}", xlabel="turns around the surface",
             xlim=(0, None), ylabel="density at the SCP [data units]")
    right.set(title=f"always on it:\n{in_words(last, True)}", xlabel="update rate [Hz]", xscale="log", yscale="log",
              ylabel="largest deviation [part of the range]", ylim=(1e-17, 10))
    figures.limit(right, GRANTED, "granted (G2)")
    figures.label_ends(left, right)
    return PAGE.figure(drawn)


def claims_of(last, own_volumes):
    for method in GUARDED:
        rows = last.where(method=method)
        yield PAGE.at_most(GRANTED, rows["worst_deviation_of_range"], "stays", method=method, updates=sum(rows["updates"]))
    if own_volumes:
        worst = largest(last.where(method="gradient", volume="cylinder")["worst_deviation_of_range"])
        yield PAGE.claim("loses", worst > 0.01, worst=worst)


def run(options):
    turns, speeds, rates, names = (20, (200, 1000), (100, 1000), ("sphere:40x40x40",)) if options.quick else (
        200, (50, 200, 1000), (100, 1000, 10000), ("sphere", "torus", "marschner-lobb"))
    table, last = Table(), Table()
    subjects = options.subjects or [synthetic("cylinder", 0.53), *map(synthetic, names), *reals(["lobster"], options)]
    bodies = [(subject, Ring(subject, 2 * subject.voxel)) for subject in subjects]
    for body, speed, rate, contestant in options.each(itertools.product(bodies, speeds, rates, CONTESTANTS.values())):
        shown = speed == SHOWN_SPEED and rate == SHOWN_RATE
        rows = list(go_round(*body, contestant, speed, rate, turns))
        last.append(rows[-1])
        # Every turn of the figure's hand at first, then every other one. The last turn is enough for the others.
        table.extend(row for row in rows if row is rows[-1] or shown and (row["turn"] <= 10 or row["turn"] % 2 == 0))
    text = PAGE.text(turns=turns, bodies=len(bodies), speeds=len(speeds), rates=len(rates))
    return Result(table, [figure_of(table, last)], claims_of(last, not options.subjects), text, summary_of(last))
