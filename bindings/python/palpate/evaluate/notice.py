"""notice: what would a person notice?

Slow strokes over smooth bodies. Whatever the force does beside turning with the body comes from samples, facets and terraces.
It is compared with published thresholds of people.
"""

import dataclasses
import functools

import numpy
import scipy.signal

from . import figures
from .bodies import ball_by, of_a_user
from .experiment import Claim, Figure, Result, Table, largest
from .fidelity import degrees_between, stroke
from .subjects import CONTESTANTS, real

TITLE = "What would a person notice?"
METHODS = ("exact", "smooth", "gradient-improved")
SAMPLES = ("float32", "uint8 dequantized", "uint8 smoothed", "uint8")
# Force: Pang, Tan and Durlach 1991 [%]. Direction: Barbagli et al. 2006, touch alone [degrees]. Vibration of a rod in the hand, most
# sensitive people and frequencies: Brisben, Hsiao and Johnson 1999 [µm].
FORCE, DIRECTION, VIBRATION = 7.0, 25.6, 0.01
PRESS, RATE, MASS = 2.0, 1000, 0.05  # [N, Hz, kg] mean force, ticks, and what moves with the handle
SLOW, FAST = 20, 100  # [Hz]
SPEED = 60  # [voxel/s] of the hand: 5 cm/s where a voxel is 0.8 mm
# Measured beside Palpate 3688b00 on 27 November 2026 at -O3, a constant press of 2 N over the bone of a CT head. CHAI3D 3.3 is commit
# 7c76b1f2. Root mean squares [% of the force]: change per tick, above 20 Hz, above 100 Hz.
PEERS = {"Palpate, linear field": (5.30, 8.89, 3.67), "Palpate, smooth field": (0.78, 1.81, 0.41), "CHAI3D mesh": (3.47, 5.76, 2.26),
         "CHAI3D shaded mesh": (2.90, 3.62, 2.03), "Embree god object": (3.33, 5.96, 2.32)}


def steady(subject):
    """A hand around a scanned body, whose own motion has nothing above 5 Hz."""
    ring = of_a_user(subject)
    low = scipy.signal.butter(4, 5, fs=RATE, output="sos")

    def hand(parts):
        hands = ring.hand(parts)
        return scipy.signal.sosfiltfilt(low, hands, axis=0) if len(hands) > 100 else hands

    return dataclasses.replace(ring, hand=hand, samples="as scanned")


def bodies_of(options, data):
    """Functions that make one body each."""
    if options.subjects:
        return [functools.partial(steady, subject) for subject in options.subjects]
    found = [functools.partial(ball_by, "circle", grid, samples) for grid in ((64,) if options.quick else (128, 256))
             for samples in SAMPLES]
    head = None if options.quick else real("ct-head", options)
    return found + ([functools.partial(steady, head)] if head else [])


def root_mean_square(values):
    return float(numpy.sqrt((values**2).sum(axis=1).mean()))


def above(frequency, force):
    """A part of the force, root mean square [N]."""
    high = scipy.signal.butter(4, frequency, "highpass", fs=RATE, output="sos")
    return root_mean_square(scipy.signal.sosfiltfilt(high, force, axis=0))


def motion(force):
    """Of a free mass that the part of the force from 100 to 500 Hz drives, root mean square [µm]."""
    window = scipy.signal.windows.hann(len(force))[:, None]
    spectrum = numpy.fft.rfft((force - force.mean(axis=0)) * window, axis=0)
    frequency = numpy.fft.rfftfreq(len(force), 1 / RATE)
    heard = frequency >= FAST
    moved = spectrum[heard] / (MASS * (2 * numpy.pi * frequency[heard, None])**2)
    return float(1e6 * numpy.sqrt(2 * (abs(moved)**2).sum() / (window**2).sum() / len(force)))


def steps_of(body):
    way = numpy.linalg.norm(numpy.diff(body.hand(numpy.linspace(0, 1, 2001)), axis=0), axis=1).sum()
    return round(RATE * way / (SPEED * body.subject.voxel))


def row_of(body, name):
    trace, hands = stroke(body, CONTESTANTS[name], steps_of(body))
    pull = numpy.where(trace.constrained[:, None], trace.scp - hands[1:], 0)[RATE // 10:]
    strength = numpy.linalg.norm(pull, axis=1)
    force = PRESS / strength.mean() * pull
    off = degrees_between(pull[strength > 0], body.ideal(hands[1:][RATE // 10:][strength > 0])) if body.ideal else numpy.array([])
    change = numpy.linalg.norm(numpy.diff(force, axis=0), axis=1)
    return {"body": body.subject.name, "grid": body.grid, "samples": body.samples, "method": name, "ticks": len(force),
            "contact_share": trace.constrained.mean(), "change_rms_percent": 100 / PRESS * numpy.sqrt((change**2).mean()),
            "change_p99_percent": 100 / PRESS * numpy.quantile(change, 0.99),
            **{f"above_{at}_hz_percent": 100 / PRESS * above(at, force) for at in (SLOW, FAST)}, "motion_um": motion(force),
            "off_ideal_p99_deg": numpy.quantile(off, 0.99) if len(off) else numpy.nan}


def peer_rows():
    for name, known in PEERS.items():
        yield {"body": "ct-head, constant press", "grid": 256, "samples": "as scanned", "method": f"{name} (measured)",
               **dict(zip(("change_rms_percent", "above_20_hz_percent", "above_100_hz_percent"), known))}


def claims_of(table):
    balls = table.where(body="ball")
    fine = Table(row for row in balls.where(method="smooth") if row["samples"] in SAMPLES[:2])
    raw = balls.where(method="exact", samples="uint8")
    for rows, column, limit, said in ((fine, "change_p99_percent", FORCE, "the change of the force in a tick (p99)"),
                                      (fine, "off_ideal_p99_deg", DIRECTION, "the error of its direction (p99)"),
                                      (fine, "motion_um", VIBRATION, "the vibration that the force drives")):
        if rows:
            unit = {"motion_um": "µm", "off_ideal_p99_deg": "degrees"}.get(column, "%")
            yield Claim(f"smooth field, samples that are not rounded or dequantized: {said} is below the threshold of {limit:g} {unit}",
                        largest(rows[column]) < limit, f"at most {largest(rows[column]):.2g} {unit}")
    if raw:
        least = raw["motion_um"].min()
        yield Claim(f"raw 8-bit ramps on the linear field drive a vibration that people notice, above {VIBRATION:g} µm",
                    bool(least > VIBRATION), f"at least {least:.2g} µm")


def summary_of(table):
    for row in table:
        motion_um = row.get("motion_um", numpy.nan)
        yield {"body": f"{row['body']} {row['grid']}", "samples": row["samples"], "method": row["method"],
               "change per tick, rms [%]": row["change_rms_percent"], "above 20 Hz, rms [%]": row["above_20_hz_percent"],
               "motion [µm]": motion_um, "direction off, p99 [degrees]": row.get("off_ideal_p99_deg", numpy.nan),
               "noticed": "" if numpy.isnan(motion_um) else ", ".join(
                   what for what, column, limit in (("force", "change_p99_percent", FORCE), ("vibration", "motion_um", VIBRATION),
                                                    ("direction", "off_ideal_p99_deg", DIRECTION)) if row[column] > limit) or "nothing"}


def figure_of(table):
    rows = Table(row for row in table if "motion_um" in row)
    cases = list(dict.fromkeys((row["body"], row["grid"], row["samples"]) for row in rows))
    drawn, panels = figures.panels(columns=3, height=0.6 + 0.27 * len(cases), sharey=True)
    for axes, (column, limit, title, label) in zip(panels, (
            ("change_p99_percent", FORCE, "force", "change in a tick, p99 [%]"), ("motion_um", VIBRATION, "vibration", "motion [µm]"),
            ("off_ideal_p99_deg", DIRECTION, "direction", "off, p99 [degrees]"))):
        for name in METHODS:
            for row in rows.where(method=name):
                at = cases.index((row["body"], row["grid"], row["samples"]))
                figures.curve(axes, name, [max(1e-5, row[column])], [at], ls="")
        axes.axvline(limit, color=figures.GREY, ls="--", lw=0.8)
        axes.axvspan(limit, 1e6, color="#f3e3e0", zorder=0)
        values = [row[column] for row in rows if row[column] > 0]
        axes.set(title=title, xscale="log", xlabel=label, xlim=(min([limit, *values]) / 3, max([limit, *values]) * 3))
    panels[0].set_yticks(range(len(cases)), [f"{body} {grid}, {samples}" for body, grid, samples in cases])
    panels[0].invert_yaxis()
    for number, name in enumerate(METHODS):
        colour, marker = figures.LOOKS[name]
        panels[2].plot(1.1, 0.85 - 0.3 * number, marker, color=colour, transform=panels[2].transAxes, clip_on=False)
        panels[2].text(1.16, 0.85 - 0.3 * number, name, color=colour, transform=panels[2].transAxes, fontsize=7.5, va="center")
    drawn.suptitle("With unrounded or dequantized samples, the smooth field stays below what people notice", x=0.01, ha="left")
    return Figure("", "Strokes at 60 voxels per second and a mean force of 2 N. Left: how much the force changes in a tick, 99th percentile. Middle: the motion "
                  "of a mass of 50 g that the force above 100 Hz drives. Right: the angle to the force of a perfect ball. Dashed: published "
                  "thresholds, which are passed in the shaded area.", drawn)


def in_short(table):
    """The vibration of both fields, and whether people notice it."""
    balls, scans = table.where(body="ball"), [row for row in table if row["samples"] == "as scanned" and "motion_um" in row]

    def most(method, *samples):
        return largest([row["motion_um"] for row in balls.where(method=method) if row["samples"] in samples])

    if balls:
        yield (f"With unrounded and with dequantized samples, the force on the smooth field drives at most {most('smooth', *SAMPLES[:2]):.2g} "
               f"µm of vibration, below the threshold of {VIBRATION:g} µm. The facets of the linear field drive up to "
               f"{most('exact', *SAMPLES[:2]):.2g} µm. On raw 8-bit ramps it is up to {most('smooth', 'uint8'):.2g} µm on the smooth field "
               f"and {most('exact', 'uint8'):.2g} µm on the linear one, which people notice.")
    for row in scans:
        if row["method"] == "smooth":
            exact, = (other for other in scans if other["body"] == row["body"] and other["method"] == "exact")
            yield (f"On {row['body']}, as it was scanned, {row['motion_um']:.2g} µm on the smooth field and {exact['motion_um']:.2g} µm on the "
                   "linear one contain the shape of the body itself.")


def paragraphs_of(table):
    return [" ".join(in_short(table)), f"A hand strokes a ball of which the true surface is known, and a scanned head, at a mean force of {PRESS:g} N, {SPEED} voxels per "
            "second and 1 kHz. Its own motion has nothing above 5 Hz. The force is that of the spring alone, without damping and friction.",
            f"The thresholds are published ones. People notice a change of the force by about {FORCE:g} % (Pang, Tan and Durlach 1991) and "
            f"of its direction by {DIRECTION:g} degrees (Barbagli et al. 2006, touch alone). The most sensitive people feel a rod in the "
            f"hand vibrate by {VIBRATION:g} µm at 150 to 200 Hz (Brisben, Hsiao and Johnson 1999). The motion here is that of a free mass "
            f"of {1000 * MASS:g} g that the force above {FAST} Hz drives. A hand damps it, so it is an upper estimate.",
            "A change in one tick is compared with a threshold for forces that last, which is strict. No person took part.",
            "Rows with (measured) are from 27 November 2026, with Palpate 3688b00, CHAI3D 3.3 (commit 7c76b1f2) and a god object on VTK "
            "flying edges and Embree 3. There the hand pressed the bone of a CT head with a constant 2 N. These rows are not run again."]


def run(options):
    data, table = [], Table()
    makers = bodies_of(options, data)
    for number, make in enumerate(makers):
        options.progress(number / len(makers))
        body = make()
        table.extend(row_of(body, name) for name in METHODS)
    figure = figure_of(table)
    if not options.subjects:
        table.extend(peer_rows())
    return Result(table, [figure], list(claims_of(table)), paragraphs_of(table), Table(summary_of(table)), data)
