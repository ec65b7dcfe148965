"""needle: how wrong is the force on a needle without a full segmentation? (Mastmeyer et al. 2017)"""

import dataclasses

import numpy
import palpate
import scipy.ndimage

from . import figures, sampling
from .bodies import unit
from .experiment import Page, Result, Table, in_parallel
from .hands import Way
from .tissues import RATE, layered, pushed, renderer

PAGE = Page(__name__)
SPEED, BEFORE = 50, 3  # [mm/s] of the hand, [mm] of air before the skin
AFFECTED = 0.01  # [N] of error from which on a force counts as affected
NOISE, BLUR = 20, 0.6  # of the CT: standard deviation [HU], and of its point spread [mm]
TRUTH, PARTLY, SMOOTHED, RAW = "all segmented", "liver and vessel segmented", "not segmented, smoothed", "not segmented"
MASTMEYER = {"mean_rms_n": 0.12, "most_n": 1.6, "affected_percent": 12, "paths": 31222}
# Name, intensity [HU] as in a CT with contrast agent, half axes and middle of an ellipsoid [mm], then the surface's level [HU], its
# stiffness [N/mm] and puncture force [N], and the drag behind it [N per mm of needle]. Each one lies in the one before it.
TISSUES = (("skin", -100, (70, 50, 45), (0, 0, 0), -550, 0.4, 1.2, 0.01), ("muscle", 55, (60, 40, 37), (0, 0, 0), -25, 0.4, 0.8, 0.015),
           ("liver", 110, (38, 26, 24), (-14, 3, 0), 82, 0.3, 0.6, 0.01), ("vessel", 175, (25, 6, 6), (-14, 3, 0), 142, 0.3, 0.4, 0.005))
LAYERS = layered("abdomen", [(name, *of) for name, _, _, _, *of in TISSUES], needle=True)


def inside(tissue, points):
    """[mm] about how far points are in an ellipsoid; exact in its sign."""
    half, middle = (numpy.array(values, dtype=float) for values in tissue[2:4])
    place = (points - middle) / half
    length = numpy.linalg.norm(place, axis=-1)
    slope = numpy.linalg.norm(place / half, axis=-1)
    return numpy.where(slope > 0, length * (1 - length) / numpy.where(slope > 0, slope, 1), half.min())


@dataclasses.dataclass
class Phantom:
    """Samples [HU] of the truth, and how far each is in each tissue [mm]."""

    spacing: float
    origin: numpy.ndarray
    truth: numpy.ndarray
    depths: list

    def felt(self, samples):
        return palpate.Field(palpate.Volume(samples, [self.spacing] * 3, self.origin), background=-1000)


def phantom(spacing):
    """Borders are ramps two samples wide, so that a level half way between two tissues is met where the ellipsoid is."""
    half = numpy.array(TISSUES[0][2]) + 5.0
    size = numpy.ceil(2 * half / spacing).astype(int) + 1
    points = -half + spacing * numpy.moveaxis(numpy.indices(size[::-1])[::-1], 0, -1)
    depths, truth, before = [inside(tissue, points) for tissue in TISSUES], numpy.full(size[::-1], -1000.0), -1000
    for tissue, depth in zip(TISSUES, depths):
        truth += (tissue[1] - before) * numpy.clip(0.5 + depth / (2 * spacing), 0, 1)
        before = tissue[1]
    return Phantom(spacing, -half, truth, depths)


def scans(made, random):
    """What a program gets, by the part that is segmented: [HU]."""
    blurred = scipy.ndimage.gaussian_filter(made.truth, BLUR / made.spacing)
    scan = numpy.round(blurred + random.normal(0, NOISE, blurred.shape)).clip(-1024, 3071).astype(numpy.int16)
    muscle, liver, vessel = (tissue[1] for tissue in TISSUES[1:])
    painted = numpy.minimum(scan, muscle)  # outside the labels, nothing is denser than muscle
    for depth, intensity in zip(made.depths[2:], (liver, vessel)):  # a voxel has the label of the tissue that its centre is in
        painted[depth > 0] = intensity
    return {TRUTH: made.truth.astype(numpy.float32), PARTLY: painted.astype(numpy.float32),
            SMOOTHED: palpate.smoothed(palpate.Volume(scan)).array, RAW: scan}



def path(random):
    """(way, length [mm]) from before the skin of the front to a place in the vessel."""
    (_, _, skin, *_), (_, _, half, middle, *_) = TISSUES[0], TISSUES[-1]
    target = numpy.array(middle) + 0.5 * numpy.array(half) * unit(random.standard_normal(3)) * random.uniform()**(1 / 3)
    out = unit(random.standard_normal(3) * [1, 1, 0.7])
    start = numpy.array(skin) * out * numpy.sign(out[1] or 1) * [1, -1, 1]
    inward = unit(target - start)
    return Way(start - BEFORE * inward, inward), BEFORE + numpy.linalg.norm(target - start)


def forces_on(fresh, way, length):
    """(depth [mm], force [N] along the needle, which a hand pushes straight in, and how often each surface gave way)."""
    depth = SPEED / RATE * numpy.arange(int(length * RATE / SPEED))
    trace, force = pushed(fresh, way, depth, needle=True)
    # The surface that was touched gives way; of several in one tick, the next deeper one each time.
    gone = [min(max(trace["layer"][tick - 1], 0) + more, len(TISSUES) - 1)
            for tick in numpy.flatnonzero(trace["punctured"]) for more in range(trace["punctured"][tick])]
    return depth, force, numpy.bincount(gone, minlength=len(TISSUES))


def rows_of(paths, fields):
    """A row for each path and scan. paths: (number, way and length)."""
    fresh = {name: renderer(field, LAYERS) for name, field in fields.items()}
    for (number, _), made in zip(paths, in_parallel(lambda of: {name: forces_on(one, *of[1]) for name, one in fresh.items()}, paths)):
        _, wanted, punctured = made[TRUTH]
        for name, (depth, force, punctures) in made.items():
            off, extra = abs(force - wanted), punctures - punctured
            yield {"path": number, "scan": name, "ticks": len(depth), "punctures": punctures.sum(), "extra": extra.clip(0).sum(),
                   "missed": (-extra).clip(0).sum(), "greatest_n": wanted.max(), "rms_n": numpy.sqrt((off**2).mean()),
                   "most_n": off.max(), "affected_percent": 100 * (off > AFFECTED).mean()}


def summary_of(table):
    for name in (PARTLY, SMOOTHED, RAW):
        rows = table.where(scan=name)
        yield {"scan": name, "paths": f"{len(rows):,}",
               "RMS error, mean [95 % interval] [N]": sampling.in_words(rows["rms_n"], "{:.2g}", numpy.mean),
               "greatest error [N]": rows["most_n"].max(), "forces off by more than 0.01 N [%]": rows["affected_percent"].mean(),
               "extra punctures per path": rows["extra"].mean(), "missed punctures per path": rows["missed"].mean()}
    yield {"scan": "10 patients, partly segmented (published)", "paths": f"{MASTMEYER['paths']:,}",
           "RMS error, mean [95 % interval] [N]": f"{MASTMEYER['mean_rms_n']:g}", "greatest error [N]": MASTMEYER["most_n"],
           "forces off by more than 0.01 N [%]": f"{MASTMEYER['affected_percent']} (threshold not stated)"}


def figure_of(table, paths, fields):
    drawn, (left, right) = figures.panels(columns=2, height=2.6, title="Labels and smoothing both lower the error of a needle's force")
    looks = {TRUTH: ("#c0c0c0", 4), RAW: (figures.VERMILION, 0.8), PARTLY: (figures.BLUE, 1.2)}
    for name, (colour, width) in looks.items():
        depth, force, _ = forces_on(renderer(fields[name], LAYERS), *paths[0])
        left.plot(depth - BEFORE, force, color=colour, lw=width)
    figures.names(left, [(name, figures.GREY if name == TRUTH else colour) for name, (colour, _) in looks.items()], 0.02)
    left.set(title="one path", xlabel="depth of the hand past the skin [mm]", ylabel="force on the needle [N]",
             ylim=(0, 1.6 * table["greatest_n"].max()))
    looks = {PARTLY: figures.BLUE, SMOOTHED: figures.GREEN, RAW: figures.VERMILION}
    for name, colour in looks.items():
        values = numpy.sort(table.where(scan=name)["rms_n"])
        right.step(values, 100 * (1 + numpy.arange(len(values))) / len(values), color=colour, lw=1.4)
    figures.names(right, [(name.replace(", ", ",\n"), colour) for name, colour in looks.items()], 1.03, 0.75, 0.25, va="baseline")
    right.axvline(MASTMEYER["mean_rms_n"], color=figures.GREY, ls="--", lw=0.8)
    right.text(MASTMEYER["mean_rms_n"], 3, " Mastmeyer\n (mean)", color=figures.GREY, fontsize=7)
    right.set(title="error of all paths", xlabel="root mean square [N]", ylabel="part of the paths [%]", xlim=(0, None), ylim=(0, 103))
    return PAGE.figure(drawn)


def claims_of(table):
    partly, raw = (table.where(scan=name) for name in (PARTLY, RAW))
    through, same = table.where(scan=TRUTH)["punctures"] == len(TISSUES), partly["extra"] + partly["missed"] == 0
    yield PAGE.claim("through", through.all(), through=through.sum(), paths=len(through))
    yield PAGE.claim("same", same.sum() >= 0.99 * len(same), same=same.sum(), paths=len(same))
    yield PAGE.claim("control", raw["rms_n"].mean() > partly["rms_n"].mean(), rms=raw["rms_n"].mean())


def run(options):
    options.refuse_volumes("needle has a phantom")
    made = phantom(1.0)
    fields = {name: made.felt(samples) for name, samples in scans(made, numpy.random.default_rng([options.seed, 0])).items()}
    random = numpy.random.default_rng([options.seed, 1])
    paths = [path(random) for _ in range(30 if options.quick else 1000)]
    parts = numpy.array_split(numpy.arange(len(paths)), 1 + len(paths) // 200)
    table = Table(row for part in options.each(parts) for row in rows_of([(number, paths[number]) for number in part], fields))
    muscle, liver, vessel = (tissue[1] for tissue in TISSUES[1:])
    text = PAGE.text(count=len(paths), seed=options.seed, muscle=muscle, liver=liver, vessel=vessel)
    return Result(table, [figure_of(table, paths, fields)], claims_of(table), text, summary_of(table))
