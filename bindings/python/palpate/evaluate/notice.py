"""notice: what would a person notice? Forces of slow strokes over smooth bodies, beside published thresholds."""

import functools
import itertools

import numpy
import scipy.signal

from . import figures
from .bodies import ball_by, of_a_user
from .experiment import Page, Result, Table, known, largest
from .fidelity import degrees_between, stroke
from .subjects import CONTESTANTS, reals

PAGE = Page(__name__)
METHODS = ("exact", "smooth", "gradient-improved")
SAMPLES = ("float32", "uint8 dequantized", "uint8 smoothed", "uint8")
# Force: Pang, Tan and Durlach 1991 [%]. Direction: Barbagli et al. 2006, touch alone [degrees]. Vibration of a rod in the hand, most
# sensitive people and frequencies: Brisben, Hsiao and Johnson 1999 [µm].
FORCE, DIRECTION, VIBRATION = 7.0, 25.6, 0.01
# Column, threshold, unit, what a person notices, the same in a claim, and of a figure the label.
NOTICED = (("change_p99_percent", FORCE, "%", "force", "the change of the force in a tick (p99)", "change in a tick, p99 [%]"),
           ("motion_um", VIBRATION, "µm", "vibration", "the vibration that the force drives", "motion [µm]"),
           ("off_ideal_p99_deg", DIRECTION, "degrees", "direction", "the error of its direction (p99)", "off, p99 [degrees]"))
PRESS, RATE, MASS = 2.0, 1000, 0.05  # [N, Hz, kg] mean force, ticks, and what moves with the handle
SLOW, FAST = 20, 100  # [Hz]
SPEED = 60  # [voxel/s] of the hand: 5 cm/s where a voxel is 0.8 mm
PEERS, PEER_CASE = known("peers_of_notice"), {"body": "ct-head, constant press", "grid": 256, "samples": "as scanned"}


def steady(subject):
    """A hand around a scanned body, whose own motion has nothing above 5 Hz."""
    ring = of_a_user(subject)
    low = scipy.signal.butter(4, 5, fs=RATE, output="sos")

    def hand(parts):
        hands = ring.hand(parts)
        return scipy.signal.sosfiltfilt(low, hands, axis=0) if len(hands) > 100 else hands

    return ring._replace(hand=hand, samples="as scanned")


def bodies_of(options):
    """Functions that make one body each."""
    grids = () if options.subjects else (64,) if options.quick else (128, 256)
    scanned = options.subjects or reals(["ct-head"], options)
    return [*(functools.partial(ball_by, "circle", *of) for of in itertools.product(grids, SAMPLES)),
            *(functools.partial(steady, subject) for subject in scanned)]


def above(frequency, force, rate=RATE):
    """The part of a force above a frequency, root mean square [N]."""
    high = scipy.signal.butter(4, frequency, "highpass", fs=rate, output="sos")
    return float(numpy.sqrt((scipy.signal.sosfiltfilt(high, force, axis=0)**2).sum(axis=1).mean()))


def motion(force):
    """Of a free mass that the part of the force from 100 to 500 Hz drives, root mean square [µm]."""
    window = scipy.signal.windows.hann(len(force))[:, None]
    spectrum = numpy.fft.rfft((force - force.mean(axis=0)) * window, axis=0)
    frequency = numpy.fft.rfftfreq(len(force), 1 / RATE)
    heard = frequency >= FAST
    moved = spectrum[heard] / (MASS * (2 * numpy.pi * frequency[heard, None])**2)
    return float(1e6 * numpy.sqrt(2 * (abs(moved)**2).sum() / (window**2).sum() / len(force)))


def row_of(body, name):
    """The first tenth of a second is left out."""
    way = numpy.linalg.norm(numpy.diff(body.hand(numpy.linspace(0, 1, 2001)), axis=0), axis=1).sum()
    trace, hands, pull = stroke(body, CONTESTANTS[name], round(RATE * way / (SPEED * body.subject.voxel)))
    hands, pull = hands[RATE // 10:], pull[RATE // 10:]
    strength = numpy.linalg.norm(pull, axis=1)
    force = PRESS / strength[strength > 0].mean() * pull
    change = numpy.linalg.norm(numpy.diff(force, axis=0), axis=1)
    row = {"body": body.subject.name, "grid": body.grid, "samples": body.samples, "method": name, "ticks": len(force),
           "contact_share": trace.constrained.mean(), "change_rms_percent": 100 / PRESS * numpy.sqrt((change**2).mean()),
           "change_p99_percent": 100 / PRESS * numpy.quantile(change, 0.99),
           **{f"above_{at}_hz_percent": 100 / PRESS * above(at, force) for at in (SLOW, FAST)}, "motion_um": motion(force),
           "off_ideal_p99_deg": numpy.nan}
    if body.ideal:
        held = strength > 0
        row["off_ideal_p99_deg"] = numpy.quantile(degrees_between(pull[held], body.ideal(hands[held])), 0.99)
    return row


def summary_of(table):
    for row in table:
        noticed = ", ".join(what for column, limit, _, what, *_ in NOTICED if row.get(column, 0) > limit)
        yield {"body": f"{row['body']} {row['grid']}", "samples": row["samples"], "method": row["method"],
               "contact [%]": 100 * row.get("contact_share", numpy.nan), "change per tick, rms [%]": row["change_rms_percent"],
               "above 20 Hz, rms [%]": row["above_20_hz_percent"],
               "motion [µm]": row.get("motion_um", numpy.nan), "direction off, p99 [degrees]": row.get("off_ideal_p99_deg", numpy.nan),
               "noticed": (noticed or "nothing") if "motion_um" in row else ""}


def figure_of(table):
    cases = list(dict.fromkeys((row["body"], row["grid"], row["samples"]) for row in table))
    title = ("On an unrounded or dequantized ball, the smooth field stays below what people notice" if table.where(body="ball")
             else "Strokes beside what people notice")
    drawn, panels = figures.panels(columns=3, height=0.6 + 0.27 * len(cases), title=title, sharey=True)
    for axes, (column, limit, _, title, _, label) in zip(panels, NOTICED):
        for row in table:
            at = cases.index((row["body"], row["grid"], row["samples"]))
            figures.curve(axes, row["method"], [max(1e-5, row[column])], [at], ls="")
        axes.axvline(limit, color=figures.GREY, ls="--", lw=0.8)
        axes.axvspan(limit, 1e6, color="#f3e3e0", zorder=0)
        values = [row[column] for row in table if row[column] > 0]
        axes.set(title=title, xscale="log", xlabel=label, xlim=(min([limit, *values]) / 3, max([limit, *values]) * 3))
    figures.ticks(panels[0].yaxis, range(len(cases)), [f"{body} {grid}, {samples}" for body, grid, samples in cases])
    panels[0].invert_yaxis()
    for number, name in enumerate(METHODS):
        colour, marker = figures.LOOKS[name]
        panels[2].plot(1.1, 0.85 - 0.3 * number, marker, color=colour, transform=panels[2].transAxes, clip_on=False)
    figures.names(panels[2], [(name, figures.LOOKS[name][0]) for name in METHODS], 1.16, 0.85, 0.3, va="center")
    return PAGE.figure(drawn, grams=1000 * MASS)


def claims_of(table):
    balls = table.where(body="ball")
    fine = balls.where(method="smooth").only(lambda row: row["samples"] in SAMPLES[:2])
    raw = balls.where(method="exact", samples="uint8")["motion_um"]
    for column, limit, unit, _, said, _ in NOTICED if fine else ():
        most = largest(fine[column])
        yield PAGE.claim("below", most < limit, said=said, limit=limit, unit=unit, most=most)
    if len(raw):
        yield PAGE.claim("raw", raw.min() > VIBRATION, least=raw.min())


def in_short(table):
    """The vibration of both fields, and whether people notice it."""
    balls, scans = table.where(body="ball"), table.where(samples="as scanned")

    def most(method, *samples):
        return largest(balls.where(method=method).only(lambda row: row["samples"] in samples)["motion_um"])

    if balls:
        yield from PAGE.text("balls", smooth_fine=most("smooth", *SAMPLES[:2]), exact_fine=most("exact", *SAMPLES[:2]),
                             smooth_raw=most("smooth", "uint8"), exact_raw=most("exact", "uint8"))
    for name in scans.distinct("body"):
        exact, smooth = (scans.where(body=name, method=method)[0] for method in METHODS[:2])
        contact = [100 * row["contact_share"] for row in (smooth, exact)]
        yield from PAGE.text("scan", name=name, exact=exact, smooth=smooth, contact=contact)


def run(options):
    table = Table(row_of(body, name) for make in options.each(bodies_of(options)) for body in [make()] for name in METHODS)
    whole = table if options.subjects else Table([*table, *({**PEER_CASE, **row} for row in PEERS)])
    bodies, = PAGE.text("volumes of a user" if options.subjects else "own bodies")
    text = PAGE.text("", *([] if options.subjects else ["peers"]), in_short=" ".join(in_short(table)), grams=1000 * MASS, bodies=bodies)
    return Result(whole, [figure_of(table)], claims_of(table), text, summary_of(whole))
