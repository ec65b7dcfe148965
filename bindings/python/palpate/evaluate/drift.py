"""drift: does the proxy stay on the isosurface? (Corenthy et al. 2012, Fig. 10)

A hand goes around a body again and again, just below its surface. The density at the SCP says whether
the proxy is still on the isosurface in contact, and outside when it is free.
"""

import itertools

import numpy
import palpate

from . import figures, sampling
from .experiment import GRANTED, Claim, Figure, Result, Table, largest
from .hands import Ring
from .subjects import CONTESTANTS, real, synthetic

TITLE = "Does the proxy stay on the isosurface?"
SHOWN_SPEED, SHOWN_RATE = 200, 1000  # of the hand in the figure


def subjects_of(options, data):
    if options.subjects:
        return list(options.subjects)
    own = [synthetic("cylinder", 0.53)]
    if options.quick:
        return [*own, synthetic("sphere:40x40x40")]
    own += [synthetic(name) for name in ("sphere", "torus", "marschner-lobb")]
    lobster = real("lobster", options)
    return [*own, lobster] if lobster else own


def is_noted(turn, turns, shown):
    """Of the figure's hand every turn, of the others the last one is enough."""
    return turn == turns or (shown and (turn <= 10 or turn % 2 == 0))


def go_round(subject, ring, contestant, speed, rate, turns):
    """A row of the table for each turn of one proxy."""
    felt = contestant.felt(subject)
    start = ring.at([0.0])
    # The hand comes from outside, so that every method starts in contact from the free side.
    proxy = palpate.Proxy(felt.field, felt.isovalue, ring.centre + 2 * (start[0] - ring.centre),
                          contestant.method)
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
        yield {"volume": subject.name, "method": contestant.name, "speed_mm_s": speed, "rate_hz": rate,
               "turn": turn, "density": trace.density[-1] if inside else 0.0,
               "isovalue": subject.isovalue, "worst_deviation_of_range": worst,
               "constrained_share": numpy.count_nonzero(trace.constrained) / max(1, inside),
               "updates": updates}


def in_words(rows, stay):
    """The contestants that are always on the isosurface, or the others."""
    names = [name for name in CONTESTANTS if stay == (
        largest(rows.where(method=name)["worst_deviation_of_range"]) <= GRANTED)]
    return ", ".join(names) or "none"


def figure_of(table, last):
    drawn, (left, right) = figures.panels(columns=2, height=2.7)
    volume = table[0]["volume"]
    shown = table.where(volume=volume, speed_mm_s=SHOWN_SPEED, rate_hz=SHOWN_RATE)
    left.axhline(shown[0]["isovalue"], color=figures.GREY, lw=0.8, ls="--")
    for name in CONTESTANTS:
        rows = shown.where(method=name)
        figures.curve(left, name, rows["turn"], rows["density"], markevery=0.25)
        rates = sorted(last.distinct("rate_hz"))
        worst = [max(1e-17, largest(last.where(method=name, rate_hz=rate)["worst_deviation_of_range"]))
                 for rate in rates]
        figures.curve(right, name, rates, worst)
    left.set(title=f"{volume}: {in_words(shown, False)} leaves the surface", xlabel="turns around the surface", xlim=(0, None),
             ylabel="density at the SCP [data units]")
    right.set(title=f"always on it: {in_words(last, True)}", xlabel="update rate [Hz]", xscale="log", yscale="log",
              ylabel="largest deviation [part of the range]", ylim=(1e-17, 10))
    right.axhline(GRANTED, color=figures.GREY, lw=0.8, ls="--")
    right.text(rates[0], 1.5 * GRANTED, "granted (G2)", color=figures.GREY, fontsize=7)
    figures.label_ends(left, right)
    return Figure("", "Left: density at the SCP after each turn, at 200 mm/s and 1 kHz. The isovalue is "
                  "dashed. Right: the largest deviation from the isovalue in any update, over all volumes "
                  "and speeds.", drawn)


def claims_of(last, own_volumes):
    claims = []
    for method in ("exact", "paper", "smooth"):
        rows = last.where(method=method)
        worst = largest(rows["worst_deviation_of_range"])
        claims.append(Claim(
            f"{method} stays on the isosurface to {GRANTED:g} of the data's range, at every rate and speed",
            worst <= GRANTED, f"largest deviation {worst:.2g} in {sum(rows['updates']):,.0f} updates"))
    if own_volumes:
        worst = largest(last.where(method="gradient", volume="cylinder")["worst_deviation_of_range"])
        claims.append(Claim("gradient loses the cylinder's isosurface by more than a hundredth of the "
                            "data's range", worst > 0.01, f"largest deviation {worst:.2g}"))
    return claims


def summary_of(last):
    return Table({"method": name,
                  "largest deviation": f"{largest(rows['worst_deviation_of_range']):.2g}",
                  "median of the runs [95 % interval]":
                      sampling.in_words(rows["worst_deviation_of_range"], "{:.2g}"),
                  "runs": len(rows), "updates": f"{sum(rows['updates']):,.0f}"}
                 for name, rows in ((name, last.where(method=name)) for name in CONTESTANTS))


def run(options):
    turns = 20 if options.quick else 200
    speeds, rates = ((200, 1000), (100, 1000)) if options.quick else ((50, 200, 1000), (100, 1000, 10000))
    table, last, data = Table(), Table(), []
    subjects = subjects_of(options, data)
    cases = list(itertools.product(subjects, speeds, rates, CONTESTANTS.values()))
    rings = {subject.name: Ring(subject, 2 * subject.voxel) for subject in subjects}
    for number, (subject, speed, rate, contestant) in enumerate(cases):
        shown = speed == SHOWN_SPEED and rate == SHOWN_RATE
        for row in go_round(subject, rings[subject.name], contestant, speed, rate, turns):
            options.progress((number + row["turn"] / turns) / len(cases))
            if is_noted(row["turn"], turns, shown):
                table.append(row)
        last.append(row)
    return Result(table, [figure_of(table, last)], claims_of(last, not options.subjects), [
        f"A hand goes around each body {turns} times, 2 voxels below its surface, with penetrability off. "
        f"There are {len(subjects)} volumes, {len(speeds)} speeds of the hand and {len(rates)} update "
        "rates. The deviation is the distance of the density at the SCP from the isovalue, as a part of "
        "the data's range. A proxy that is free counts only if it is in the solid.",
        "The exact method and the method of the paper move inside linear pieces, so only rounding errors "
        "are left, however far the hand moves per tick. On the smooth field, the deviation is the "
        "accuracy of the computed roots. The gradient method follows a plane and leaves the surface. "
        "Moving the SCP back along the gradient helps where the gradient leads back to the same surface.",
        "Nothing in this experiment is random. The intervals of the medians come from resampling the runs, "
        "which differ in volume, speed and rate."], summary_of(last), data)
