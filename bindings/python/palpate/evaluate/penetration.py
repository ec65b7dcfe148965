"""penetration: which surfaces does a press meet from the skin into the brain? (Corenthy et al. 2012, section 5, Fig. 8)

A hand presses straight in and comes out again, with penetrability off, with a threshold, and with ranges of
interest.
"""

import dataclasses

import numpy
import palpate

from . import figures
from .experiment import GRANTED, Claim, Figure, Result, Table, largest
from .subjects import Subject, real, synthetic

TITLE = "Which surfaces does a press meet from the skin into the brain?"
STIFFNESS = 0.5  # k [N/mm]
THRESHOLD = 1.0  # PT [device mm]
SPEED, RATE = 20.0, 1000.0  # [device mm/s], [Hz]
APPROACH = 5.0  # [device mm] of free space before the entry
ROUNDING = 1e-9  # of k PT [N]
FUNCTIONS = {"off": figures.GREY, "threshold": figures.BLUE, "ranges": figures.VERMILION}


@dataclasses.dataclass
class Line:
    """A straight line into a body. entry [mm]: where it first meets the level of the subject; inward: unit;
    depth [mm]: how far past the entry the hand goes; ranges of interest; levels: what lies at them."""

    subject: Subject
    entry: numpy.ndarray
    inward: numpy.ndarray
    depth: float
    ranges: list
    levels: dict

    @property
    def scale(self):
        """mm of volume per mm of hand: a voxel."""
        return self.subject.voxel


def entry_of(subject, through, inward):
    """Where the line through a point meets the body from outside; None if it does not."""
    outside = through - 2 * subject.diagonal * inward
    found = subject.field.cast_ray(subject.isovalue, outside, through)
    return None if found is None or numpy.array_equal(found[0], outside) else numpy.asarray(found[0])


def ct_head(subject):
    """The CT head lies face up and was stored upside down: its crown is at z = 0. Over the left brow the
    skull has no sinus; the direction is about the skin's normal."""
    inward = numpy.array([0, 1, 0.6]) / numpy.linalg.norm([1, 0.6])
    entry = entry_of(subject, numpy.array([103.0, 64, 44]), inward)
    if entry is None:
        raise ValueError("the CT head is not the one that the line was chosen for")
    # Muscle and brain lie between the ranges.
    return Line(subject, entry, inward, 30, [(500, 900), (1200, numpy.inf)], {500: "skin", 1200: "skull"})


def shepp_logan(quick):
    subject = synthetic("shepp-logan:48x48x48" if quick else "shepp-logan")
    inward = numpy.array([-1.0, 0, 0])
    entry = entry_of(subject, 0.5 * subject.field.geometry.size[0] * numpy.array([0, 0.02, 0.05]), inward)
    # Up to soft tissue; neither the inside of the skin (60 HU), nor brain (40), nor ventricles (8).
    return Line(subject, entry, inward, float(entry[0]), [(subject.isovalue, 0), (500, numpy.inf)],
                {subject.isovalue: "skin", 530: "skull"})


def of_a_user(subject):
    """From the first side of the volume's box that meets the level towards the middle."""
    geometry, least = subject.field.geometry, subject.isovalue
    most = subject.field.volume.maximum
    ranges = [(least, least + 0.25 * (most - least)), (least + 0.5 * (most - least), numpy.inf)]
    for side in (1.0, -1.0):
        for axis in (1, 0, 2):
            inward = side * numpy.asarray(geometry.direction)[:, axis]
            entry = entry_of(subject, geometry.centre, inward)
            depth = 0 if entry is None else float(numpy.linalg.norm(geometry.centre - entry))
            if depth > 0:
                return Line(subject, entry, inward, depth, ranges, {least: "minimum"})
    raise ValueError(f"{subject.name}: no line from a side of the volume to its middle meets the surface; choose "
                     "another level")


def lines_of(options, data):
    lines = [of_a_user(subject) for subject in options.subjects]
    if not lines:
        head = None if options.quick else real("ct-head", options)
        lines = [*([ct_head(head)] if head else []), shepp_logan(options.quick)]
    for line in lines if options.ranges else ():
        volume = line.subject.field.volume
        line.ranges = [tuple(end(volume) for end in ends) for ends in options.ranges]
        line.levels = {line.subject.isovalue: "minimum", **{low: "range" for low, _ in line.ranges}}
    return lines


def penetrability_of(line, function):
    if function == "off":
        return None
    if function == "threshold":
        return palpate.Penetrability(threshold=THRESHOLD, minimum=line.subject.isovalue)
    return palpate.Penetrability(threshold=THRESHOLD, ranges=line.ranges)


class Press:
    """All ticks of one press, from free space in and out again, as arrays."""

    def __init__(self, line, function):
        self.line, self.function = line, function
        subject, scale = line.subject, line.scale
        step, start = SPEED / RATE * scale, -APPROACH * scale  # [mm of volume]
        one_way = int(numpy.ceil((line.depth - start) / step))
        tick = numpy.arange(2 * one_way + 1)
        self.inwards = tick <= one_way
        self.depth = start + step * numpy.where(self.inwards, tick, 2 * one_way - tick)
        hips = line.entry + self.depth[:, None] * line.inward
        proxy = palpate.Proxy(subject.field, subject.isovalue, line.entry + start * line.inward)
        self.trace = proxy.follow(hips, penetrability=penetrability_of(line, function), scale=scale)
        self.pull = numpy.linalg.norm(self.trace.scp - hips, axis=1) / scale
        self.force = numpy.where(self.trace.constrained, STIFFNESS * self.pull, 0)
        self.density_at_hand = subject.field.value(hips)

    @property
    def felt(self):
        """Levels felt, in contact."""
        return self.trace.isovalue[self.trace.constrained]

    def out_of_ranges(self):
        return int(numpy.count_nonzero(~numpy.any(
            [(low <= self.felt) & (self.felt <= high) for low, high in self.line.ranges], axis=0)))

    def below_minimum(self):
        return int(numpy.count_nonzero(self.line.subject.excess(self.felt) < 0))

    def rows(self, each):
        for i in range(0, len(self.depth), each):
            yield {"volume": self.line.subject.name, "penetrability": self.function,
                   "direction": "in" if self.inwards[i] else "out", "depth_mm": self.depth[i],
                   "isovalue": self.trace.isovalue[i], "density_at_scp": self.trace.density[i],
                   "density_at_hand": self.density_at_hand[i], "pull_device_mm": self.pull[i],
                   "force_n": self.force[i], "mode": "constrained" if self.trace.constrained[i] else "free"}


def claims_of(presses):
    def of(function):
        return [press for press in presses if press.function == function]

    most = STIFFNESS * THRESHOLD
    for function in ("threshold", "ranges"):
        force = max(float(press.force.max()) for press in of(function))
        yield Claim(f"{function}: the force of the spring never exceeds k PT = {most:g} N", force <= most + ROUNDING,
                    f"largest {force:.10g} N")
    below, contacts = (sum(of_one(p) for p in of("threshold")) for of_one in (Press.below_minimum, lambda p: len(p.felt)))
    yield Claim("threshold: no level on the free side of the minimum is felt", below == 0,
                f"{below} of {contacts} ticks in contact")
    others, contacts = (sum(of_one(p) for p in of("ranges")) for of_one in (Press.out_of_ranges, lambda p: len(p.felt)))
    yield Claim("ranges: only levels within the ranges are felt", others == 0,
                f"{others} of {contacts} ticks in contact")
    moved = max(float(numpy.ptp(press.trace.isovalue)) for press in of("off"))
    yield Claim("off: the isovalue never changes", moved == 0, f"spread {moved:g}")
    inside = max(largest(press.line.subject.excess(press.trace.density)) for press in of("off"))
    yield Claim(f"off: the SCP never enters the solid (to {GRANTED:g} of the data's range)", inside <= GRANTED,
                f"largest excess {inside:.2g}")


def summary_of(presses):
    for press in presses:
        levels = f"{press.felt.min():.5g} to {press.felt.max():.5g}" if len(press.felt) else "none"
        yield {"volume": press.line.subject.name, "penetrability": press.function, "levels felt": levels,
               "largest force [N]": float(press.force.max()),
               "ticks in contact": f"{len(press.felt)} of {len(press.depth)} ({len(press.felt) / len(press.depth):.0%})"}


def draw_slice(axes, line, ranges):
    """The data in a plane through the line, with the levels, and where the proxy is with ranges."""
    across = numpy.cross(line.inward, [0, 0, 1.0] if abs(line.inward[2]) < 0.9 else [1.0, 0, 0])
    across /= numpy.linalg.norm(across)
    low, high, wide = -0.25 * line.depth, 1.25 * line.depth, 0.4 * line.depth
    x, y = numpy.linspace(low, high, 240), numpy.linspace(-wide, wide, 120)
    points = line.entry + x[None, :, None] * line.inward + y[:, None, None] * across
    values = line.subject.field.value(points.reshape(-1, 3)).reshape(len(y), len(x))
    axes.imshow(values, extent=(low, high, -wide, wide), origin="lower", cmap="gray", aspect="auto")
    levels = sorted(level for level in line.levels if numpy.isfinite(level))
    axes.contour(x, y, values, levels, colors=[figures.SKY, figures.ORANGE, figures.GREEN][:len(levels)], linewidths=1)
    axes.plot([low, line.depth], [0, 0], color=figures.VERMILION, lw=0.8, ls=":")
    scp = (ranges.trace.scp - line.entry)[ranges.inwards & ranges.trace.constrained]
    axes.plot(scp @ line.inward, scp @ across, ".", color=figures.VERMILION, ms=2, rasterized=True)
    axes.grid(False)
    names = ", ".join(f"{name} at {level:g}" for level, name in line.levels.items())
    axes.set_title(f"{line.subject.name}: {names}", fontsize=8)
    axes.set_xlim(low, high)


def draw_press(press, level, force, mode, number):
    colour, c = FUNCTIONS[press.function], press.trace.constrained
    for way, style in ((press.inwards, "-"), (~press.inwards, "--")):
        felt = numpy.where(c, press.trace.isovalue, numpy.nan)[way]
        level.plot(press.depth[way], felt, color=colour, ls=style, lw=1.2)
        force.plot(press.depth[way], press.force[way], color=colour, ls=style, lw=1.2)
        at = 2 * number + (style == "--")
        mode.plot(press.depth[way], numpy.where(c, at, numpy.nan)[way], color=colour, lw=4, solid_capstyle="butt")


def figure_of(lines, presses):
    shown = lines[:3]
    drawn, axes = figures.panels(4, len(shown), height=6.8, width=figures.PAGE if len(shown) > 1 else 5.6, sharex="col",
                                 squeeze=False, gridspec_kw={"height_ratios": [3, 3, 2.5, 2]})
    for (slice_, level, force, mode), line in zip(axes.T, shown):
        own = {p.function: p for p in presses if p.line is line}
        draw_slice(slice_, line, own["ranges"])
        off = own["off"]
        level.fill_between(off.depth[off.inwards], off.density_at_hand[off.inwards], line.subject.field.volume.minimum,
                           color="#e4e4e4", lw=0)
        for number, press in enumerate(own.values()):
            draw_press(press, level, force, mode, number)
        force.axhline(STIFFNESS * THRESHOLD, color=figures.GREY, lw=0.7, ls=":")
        force.set_ylim(0, 3.2 * STIFFNESS * THRESHOLD)
        mode.set(xlabel="depth of the hand past the surface [mm]", ylim=(-0.7, 5.7))
        names = [f"{function}, {way}" for function in own for way in ("in", "out")]
        mode.set_yticks(range(6), names if line is shown[0] else [])
    for row, name in zip(axes[:, 0], ("across the line [mm]", "level felt\n[data units]", "k |SCP - hand| [N]", "in contact")):
        row.set_ylabel(name)
    drawn.suptitle("A surface gives way at k PT, and ranges leave only what is of interest", x=0.01, ha="left")
    for name, place in zip(FUNCTIONS, (0.97, 0.86, 0.75)):
        axes[2, 0].text(0.98, place, name, color=FUNCTIONS[name], transform=axes[2, 0].transAxes, ha="right", va="top",
                        fontsize=7.5)
    return Figure("", "Each column is a body. The hand goes straight in (solid lines) and out again (dashed lines). First row: a "
                  "slice of the data that contains the line of the hand (dotted). It shows the surfaces, and the proxy while the "
                  "hand presses with ranges (red dots). Second row: the level felt in contact, and the density at the hand in "
                  "grey. Third row: the force of the spring. It is at most k PT where the surface gives way. With penetrability "
                  "off, it leaves the panel. Last row: the depths at which the proxy is in contact.", drawn)


def ranges_of(line):
    ranges = ", and ".join(f"{low:g} to {high:g}" if numpy.isfinite(high) else f"{low:g} and more" for low, high in line.ranges)
    return f"The ranges of {line.subject.name} are {ranges}."


def run(options):
    data, table, presses = [], Table(), []
    lines = lines_of(options, data)
    for line in lines:
        for function in FUNCTIONS:
            options.progress(len(presses) / (len(FUNCTIONS) * len(lines)))
            presses.append(Press(line, function))
            table.extend(presses[-1].rows(20 if options.quick else 5))
    return Result(table, [figure_of(lines, presses)], list(claims_of(presses)), [
        "With penetrability, a surface gives way when it is pressed hard enough, so the hand meets deeper surfaces in the same "
        "press. This experiment shows which levels are felt on the way, and how large the force becomes. It follows section 5 "
        "and Fig. 8 of Corenthy et al. 2012.",
        f"A hand presses straight into each body at {SPEED:g} mm/s and comes out again, with {RATE:g} ticks per second. The "
        f"stiffness is k = {STIFFNESS:g} N/mm. One millimetre of the hand is one voxel. Each body is pressed three times. With "
        "penetrability off, the surface never gives way. With the threshold, it gives way when the hand is PT = "
        f"{THRESHOLD:g} mm behind it, and every level from the first one on may be felt. With ranges, it gives way in the "
        "same manner, but only levels within the ranges may be felt. " + " ".join(ranges_of(line) for line in lines),
        "Nothing in this experiment is random. There is one line per body. The method is exact, and the field is linear. The "
        "column \"levels felt\" gives the lowest and the highest level."],
        Table(summary_of(presses)), data)
