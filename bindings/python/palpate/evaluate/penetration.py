"""penetration: which surfaces does a press meet from the skin into the brain? (Corenthy et al. 2012, section 5, Fig. 8)"""

import collections

import numpy
import palpate

from . import figures
from .experiment import GRANTED, Page, Result, Table, largest
from .hands import way_from_a_side, way_in, way_into_head
from .subjects import reals, synthetic

PAGE = Page(__name__)
STIFFNESS = 0.5  # k [N/mm]
THRESHOLD = 1.0  # PT [device mm]
SPEED, RATE = 20.0, 1000.0  # [device mm/s], [Hz]
APPROACH = 5.0  # [device mm] of free space before the entry
ROUNDING = 1e-9  # of k PT [N]
FUNCTIONS = {"off": figures.GREY, "threshold": figures.BLUE, "ranges": figures.VERMILION}


# A way into a body from where it first meets the level of the subject; how far the hand goes [mm]; ranges of interest; what lies at levels.
Line = collections.namedtuple("Line", "subject way depth ranges levels")


def of_a_user(subject):
    least, most = subject.isovalue, subject.field.volume.maximum
    ranges = [(least, least + 0.25 * (most - least)), (least + 0.5 * (most - least), numpy.inf)]
    return Line(subject, *way_from_a_side(subject), ranges, {least: "minimum"})


def own_lines(options):
    for head in reals(["ct-head"], options):  # muscle and brain lie between the ranges
        yield Line(head, way_into_head(head), 30, [(500, 900), (1200, numpy.inf)], {500: "skin", 1200: "skull"})
    head = synthetic("shepp-logan:48x48x48" if options.quick else "shepp-logan")
    way = way_in(head, 0.5 * head.field.geometry.size[0] * numpy.array([0, 0.02, 0.05]), numpy.array([-1.0, 0, 0]))
    # Up to soft tissue; neither the inside of the skin (60 HU), nor brain (40), nor ventricles (8).
    yield Line(head, way, float(way.origin[0]), [(head.isovalue, 0), (500, numpy.inf)], {head.isovalue: "skin", 530: "skull"})


def lines_of(options):
    for line in [*map(of_a_user, options.subjects)] or own_lines(options):
        ranges = [range_in(line.subject.field.volume) for range_in in options.ranges]
        levels = {line.subject.isovalue: "minimum", **{low: "range" for low, _ in ranges}}
        yield line._replace(ranges=ranges, levels=levels) if ranges else line


class Press:
    """All ticks of one press, from free space in and out again, as arrays. One mm of hand is a voxel."""

    def __init__(self, line, function):
        self.line, self.function = line, function
        subject, scale = line.subject, line.subject.voxel
        step, start = SPEED / RATE * scale, -APPROACH * scale  # [mm of volume]
        one_way = int(numpy.ceil((line.depth - start) / step))
        tick = numpy.arange(2 * one_way + 1)
        self.inwards = tick <= one_way
        self.depth = start + step * numpy.where(self.inwards, tick, 2 * one_way - tick)
        hips = line.way.at(self.depth)
        penetrability = {"off": None, "threshold": palpate.Penetrability(threshold=THRESHOLD, minimum=subject.isovalue),
                         "ranges": palpate.Penetrability(threshold=THRESHOLD, ranges=line.ranges)}[function]
        self.trace = palpate.Proxy(subject.field, subject.isovalue, hips[0]).follow(hips, penetrability=penetrability, scale=scale if penetrability else 1.0)
        self.pull = numpy.linalg.norm(self.trace.scp - hips, axis=1) / scale
        self.force = numpy.where(self.trace.constrained, STIFFNESS * self.pull, 0)
        self.density_at_hand = subject.field.value(hips)
        self.felt = self.trace.isovalue[self.trace.constrained]  # levels, in contact


    def rows(self, each):
        for i in range(0, len(self.depth), each):
            yield {"volume": self.line.subject.name, "penetrability": self.function, "direction": "in" if self.inwards[i] else "out",
                   "depth_mm": self.depth[i], "isovalue": self.trace.isovalue[i], "density_at_scp": self.trace.density[i],
                   "density_at_hand": self.density_at_hand[i], "pull_device_mm": self.pull[i], "force_n": self.force[i],
                   "mode": "constrained" if self.trace.constrained[i] else "free"}


def summary_of(presses):
    for press in presses:
        yield {"volume": press.line.subject.name, "penetrability": press.function,
               "levels felt": f"{press.felt.min():.5g} to {press.felt.max():.5g}" if len(press.felt) else "none",
               "largest force [N]": float(press.force.max()),
               "ticks in contact": f"{len(press.felt)} of {len(press.depth)} ({len(press.felt) / len(press.depth):.0%})"}


def draw_slice(axes, line, ranges):
    """The data in a plane through the line, with the levels, and where the proxy is with ranges."""
    inward = line.way.inward
    across = numpy.cross(inward, [0, 0, 1.0] if abs(inward[2]) < 0.9 else [1.0, 0, 0])
    across /= numpy.linalg.norm(across)
    low, high, wide = -0.25 * line.depth, 1.25 * line.depth, 0.4 * line.depth
    x, y = numpy.linspace(low, high, 240), numpy.linspace(-wide, wide, 120)
    points = line.way.at(x)[None] + y[:, None, None] * across
    values = line.subject.field.value(points.reshape(-1, 3)).reshape(len(y), len(x))
    axes.imshow(values, extent=(low, high, -wide, wide), origin="lower", cmap="gray", aspect="auto")
    levels = sorted(level for level in line.levels if numpy.isfinite(level))
    axes.contour(x, y, values, levels, colors=[figures.SKY, figures.ORANGE, figures.GREEN][:len(levels)], linewidths=1)
    axes.plot([low, line.depth], [0, 0], color=figures.VERMILION, lw=0.8, ls=":")
    scp = (ranges.trace.scp - line.way.origin)[ranges.inwards & ranges.trace.constrained]
    axes.plot(scp @ inward, scp @ across, ".", color=figures.VERMILION, ms=2, rasterized=True)
    axes.set_title(f"{line.subject.name}: {', '.join(f'{name} at {level:g}' for level, name in line.levels.items())}", fontsize=8)
    axes.set_xlim(low, high)
    axes.grid(False)


def draw_press(press, level, force, mode, number):
    """The level felt, the force and the depths in contact, in and out."""
    for at, (way, style) in enumerate(((press.inwards, "-"), (~press.inwards, "--")), 2 * number):
        touched = press.trace.constrained[way]
        for axes, values, look in ((level, numpy.where(touched, press.trace.isovalue[way], numpy.nan), {"ls": style, "lw": 1.2}),
                                   (force, press.force[way], {"ls": style, "lw": 1.2}),
                                   (mode, numpy.where(touched, at, numpy.nan), {"lw": 4, "solid_capstyle": "butt"})):
            axes.plot(press.depth[way], values, color=FUNCTIONS[press.function], **look)


def figure_of(lines, presses):
    shown = lines[:3]
    drawn, panels = figures.panels(4, len(shown), height=6.8, width=figures.PAGE if len(shown) > 1 else 5.6, sharex="col",
                                   squeeze=False, gridspec_kw={"height_ratios": [3, 3, 2.5, 2]},
                                   title="A surface gives way at k PT, and ranges leave only what is of interest")
    for (slice_, level, force, mode), line in zip(panels.T, shown):
        own = {press.function: press for press in presses if press.line is line}
        draw_slice(slice_, line, own["ranges"])
        inwards = own["off"].inwards
        level.fill_between(own["off"].depth[inwards], own["off"].density_at_hand[inwards], line.subject.field.volume.minimum,
                           color="#e4e4e4", lw=0)
        for number, press in enumerate(own.values()):
            draw_press(press, level, force, mode, number)
        force.axhline(STIFFNESS * THRESHOLD, color=figures.GREY, lw=0.7, ls=":")
        force.set_ylim(0, 3.2 * STIFFNESS * THRESHOLD)
        mode.set(xlabel="depth of the hand past the surface [mm]", ylim=(-0.7, 5.7))
        mode.set_yticks(range(6), [f"{function}, {way}" for function in own for way in ("in", "out")] if line is shown[0] else [])
    for axes, name in zip(panels[:, 0], ("across the line [mm]", "level felt\n[data units]", "k |SCP - hand| [N]", "in contact")):
        axes.set_ylabel(name)
    figures.names(panels[2, 0], FUNCTIONS.items(), 0.98, 0.97, 0.11, ha="right")
    return PAGE.figure(drawn)


def claims_of(presses):
    off, threshold, ranges = ([press for press in presses if press.function == function] for function in FUNCTIONS)
    most = STIFFNESS * THRESHOLD
    for name, own in (("threshold", threshold), ("ranges", ranges)):
        yield PAGE.at_most(most + ROUNDING, [press.force.max() for press in own], "force", function=name, strongest=most)
    below = [press.line.subject.excess(press.felt) < 0 for press in threshold]
    out = [~numpy.any([(low <= press.felt) & (press.felt <= high) for low, high in press.line.ranges], axis=0) for press in ranges]
    for name, wrong in (("minimum", numpy.concatenate(below)), ("ranges", numpy.concatenate(out))):
        yield PAGE.claim(name, not wrong.any(), wrong=wrong.sum(), ticks=len(wrong))
    yield PAGE.at_most(0, [numpy.ptp(press.trace.isovalue) for press in off], "off")
    yield PAGE.at_most(GRANTED, [largest(press.line.subject.excess(press.trace.density)) for press in off], "outside")


def run(options):
    table, presses, lines = Table(), [], list(lines_of(options))
    for line, function in options.each((line, function) for line in lines for function in FUNCTIONS):
        presses.append(Press(line, function))
        table.extend(presses[-1].rows(20 if options.quick else 10))
    ranges = {line.subject.name: ", and ".join(f"{low:g} to {high:g}" if numpy.isfinite(high) else f"{low:g} and more"
                                               for low, high in line.ranges) for line in lines}
    text = PAGE.text(ranges=" ".join(f"The ranges of {name} are {words}." for name, words in ranges.items()))
    return Result(table, [figure_of(lines, presses)], claims_of(presses), text, summary_of(presses))
