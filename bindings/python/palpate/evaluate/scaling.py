"""scaling: what does the cost grow with, and what does the explicit approach cost?"""

import collections
import dataclasses
import itertools

import numpy
import palpate

from . import figures, machine
from .experiment import GRANTED, Page, Result, Table
from .performance import moved_rows, numbers_of, timed
from .sampling import quantile
from .subjects import cube, reals

PAGE = Page(__name__)
METHODS = ("exact", "smooth")
RATE, SPEED, VOXELS, DEPTH = 1000, 50, 3, 0.5  # [Hz, mm/s, voxels per mm of hand, mm of hand] while others grow
MEASURED = ("updates", "constrained_share", "tetrahedra", "tetrahedra_per_update", "mean_ns", "p50_ns", "p99_ns", "p999_ns", "max_ns")
EVERY = 25  # ticks between two changes of the level
SEGMENTS, REPEATS = 4000, 3  # at most so many; the fastest repeat of the explicit approach counts
TILT, TURNING = 0.9, 0.02  # [rad] of the circles around a ball, and turn of their plane per angle along them


Plan = collections.namedtuple("Plan", "ticks passes speeds voxels sizes noises explicit_sizes")  # edges [samples], parts of the range
QUICK = Plan(1500, 3, (20, 100, 500), (0.5, 2), (64, 80, 128), (0, 0.1, 1), (32, 64))
FULL = Plan(20000, 5, (5, 10, 20, 50, 100, 200, 500, 1000, 2000), (0.25, 0.5, 1, 2, 3, 4, 6, 8), (64, 128, 256, 512, 768, 1024),
            (0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1), (64, 128, 256, 512, 1024))


@dataclasses.dataclass
class Ball:
    """In the middle of size^3 samples, 1 mm apart, so that lengths are mm and voxels alike. Its density falls from 1 to 0
    over `edge` across the surface, which is at half."""

    size: int = 64
    radius: float = 22
    edge: float = 16

    def density(self, x, y, z):
        return numpy.clip(0.5 + (self.radius - numpy.sqrt(x * x + (y * y + z * z))) / self.edge, 0, 1)

    @property
    def places(self):
        return numpy.arange(self.size) - 0.5 * (self.size - 1)

    def sampled(self):
        """uint8, by slices, as some are large. With even sizes the same samples lie around the centre of any grid."""
        samples = numpy.zeros([self.size] * 3, dtype=numpy.uint8)
        near = numpy.flatnonzero(abs(self.places) < self.radius + 0.5 * self.edge)
        part, along = slice(near[0], near[-1] + 1), self.places[near]
        for k in near:
            values = 255 * self.density(along, along[:, None], self.places[k])
            samples[k, part, part] = values + 0.5
        return cube("ball", samples, 127.5)

    def noisy(self, amplitude, seed):
        """float32 of 0 to 1, and white noise of +-amplitude / 2."""
        noise = numpy.random.default_rng(seed).random([self.size] * 3) - 0.5
        x = self.places
        samples = self.density(x, x[:, None], x[:, None, None]) + amplitude * noise
        return cube("noisy-ball", samples.astype(numpy.float32), 0.5)

    def hand(self, depth, step, ticks):
        """Great circles that turn slowly over the whole ball, `step` [mm] per tick, from 1 mm outside."""
        radius = self.radius - depth
        angle = step / radius * numpy.concatenate([[0], numpy.arange(ticks)])
        x, y = numpy.cos(angle), numpy.sin(angle) * numpy.cos(TILT)
        c, s = numpy.cos(TURNING * angle), numpy.sin(TURNING * angle)
        hips = radius * numpy.stack([c * x - s * y, s * x + c * y, numpy.sin(angle) * numpy.sin(TILT)], axis=1)
        hips[0] *= (self.radius + 1) / radius
        return {"hips": hips, "first": [0]}


def over(subject, speed, voxels, ticks, seed):
    """A hand on any body that hardly ever leaves it."""
    scale = voxels * subject.voxel
    return palpate.explore(subject.field, subject.isovalue, name=subject.name, speed_mm_s=speed * scale, depth_mm=DEPTH * scale,
                           touching=0.95, trajectories=4, trajectory_s=ticks / RATE / 4, seed=seed)


def cells_of(part, subject):
    size = subject.field.geometry.size
    return {"part": part, "volume": subject.name, "size": "x".join(map(str, size)), "samples": numpy.prod(size, dtype=float)}


def time_rows(part, subject, hand, passes, **cells):
    """A row for each method, timed in turns."""
    way = numpy.linalg.norm(numpy.diff(hand["hips"], axis=0), axis=1)[moved_rows(hand)[1:]].sum()
    for name, taken in timed(subject, METHODS, hand, passes).items():
        numbers = numbers_of(taken, hand)
        yield {**cells_of(part, subject), **cells, "method": name, "path_voxel": way / subject.voxel,
               **{column: numbers[column] for column in MEASURED}}


def has_room(size, copies, what, options):
    """Whether there is memory for so many times the samples of a cube; if not, says what is left out."""
    needed = copies * size**3
    if 1024 * float(machine.first("/proc/meminfo", r"^MemAvailable:\s*(\d+)", "inf")) > needed:
        return True
    options.note(f"{what} at {size}^3 left out, which takes {1e-9 * needed:.1f} GB of memory")
    return False


def by_hand(plan, options):
    """Rows by speed and by voxels per millimetre of the hand, each alone."""
    def rows(part, speed, voxels, ball):
        for own in options.subjects or [ball.sampled()]:
            hand = (over(own, speed, voxels, plan.ticks, options.seed) if options.subjects
                    else ball.hand(DEPTH * voxels, speed / RATE * voxels, plan.ticks))
            yield from time_rows(part, own, hand, plan.passes, speed_mm_s=speed, voxels_per_mm=voxels)

    yield from (rows("speed", speed, VOXELS, Ball()) for speed in plan.speeds)
    # The same ball of 20 mm in the hand, sampled ever more finely.
    yield from (rows("voxels-per-mm", SPEED, voxels, Ball(2 * int(23 * voxels + 6), 20 * voxels, 6 * voxels)) for voxels in plan.voxels)


def by_body(plan, options):
    """Rows of the same motion in a larger volume, and in noise."""
    hand = Ball().hand(DEPTH * VOXELS, SPEED / RATE * VOXELS, plan.ticks)

    def of_size(size):
        if has_room(size, 1.2, "the volume", options):
            yield from time_rows("size", Ball(size).sampled(), hand, plan.passes)

    yield from map(of_size, plan.sizes)
    yield from (time_rows("noise", Ball().noisy(noise, options.seed), hand, plan.passes, noise_of_range=noise) for noise in plan.noises)


def segments_of(subject, hand):
    """Segments of the line of the force, from half a voxel above the SCP to the HIP, spread over the hand."""
    trace = palpate.follow_each(subject.field, subject.isovalue, hand["hips"], hand["first"], threads=1)
    pull = trace.scp - hand["hips"]
    length = numpy.linalg.norm(pull, axis=1)
    touching = numpy.flatnonzero(trace.constrained & moved_rows(hand) & (length > 0))
    if len(touching) > SEGMENTS:
        touching = touching[numpy.arange(SEGMENTS) * len(touching) // SEGMENTS]
    outward = pull[touching] / length[touching, None]
    return trace.scp[touching] + 0.5 * subject.voxel * outward, hand["hips"][touching]


def levels_of(subject, hand):
    """The level of each update, which jumps by a tenth of the data's range every now and then, up and down in turn and back; and whether it
    has just jumped."""
    volume, span = subject.field.volume, subject.field.range
    ends = [numpy.clip(subject.isovalue + part * span, volume.minimum + 0.01 * span, volume.maximum - 0.01 * span) for part in (0.1, -0.1)]
    number = numpy.concatenate([numpy.arange(rows) // EVERY for rows in numpy.diff([*hand["first"], len(hand["hips"])])])  # of changes
    jumped = numpy.append(False, (number[1:] != number[:-1]) & (number[1:] > 0))
    away = numpy.cumsum(jumped & (number % 2 == 1))  # every other change is one back
    return numpy.where(number % 2 == 1, numpy.choose((away + 1) % 2, ends), subject.isovalue), jumped


def dynamic_numbers(subject, hand, segments, passes):
    """What the same touch costs our method."""
    levels, jumped = levels_of(subject, hand)
    taken = timed(subject, ["exact"], hand, passes)["exact"]
    runs = [palpate.follow_levels(subject.field, hand["hips"], hand["first"], levels) for _ in range(passes)]
    trace = runs[0]["trace"]
    medians = numpy.median([run["trace"].update_ns[jumped] for run in runs], axis=0)
    off = subject.sign * (trace.density - levels) / subject.field.range
    off = numpy.where(trace.constrained, abs(off), off)[jumped & ~trace.unfinished]
    return {"samples_bytes": subject.field.volume.nbytes, "mean_ns": numbers_of(taken, hand)["mean_ns"],
            "segment_ns": numpy.median([palpate.ray_ns(subject.field, subject.isovalue, *segments) for _ in range(passes)]),
            **{f"change_{name}_ns": quantile(medians, share) for name, share in (("p50", 0.5), ("p99", 0.99), ("max", 1))},
            "changes": int(jumped.sum()), "unfinished_changes": int(trace.unfinished[jumped].sum()),
            "worst_deviation_of_range": off.max(initial=0), "state_bytes": runs[0]["state_bytes"],
            "heap_growth_bytes": max(run["heap_growth_bytes"] for run in runs)}


def explicit_numbers(subject, segments, options):
    """What the explicit approach takes; empty, and a note, where its program fails."""
    try:
        found = palpate.explicit_surface(subject.field, subject.isovalue, *segments, repeats=REPEATS)
    except RuntimeError as error:
        options.note(f"without the explicit approach on {subject.name}: {error}")
        return {}
    starts, ends = segments
    ours, _ = palpate.cast_rays(subject.field, subject.isovalue, starts, ends)
    theirs = starts + found["hits"][:, None] * (ends - starts)
    apart = numpy.linalg.norm(theirs - ours, axis=1) / subject.voxel
    found = {**found, "ready_s": found["extraction_s"] + found["tree_s"], "kept_bytes": found["mesh_bytes"] + found["tree_bytes"]}
    return {**{f"explicit_{name}": found[name] for name in ("triangles", "extraction_s", "tree_s", "ready_s", "cpu_s", "mesh_bytes",
                                                            "tree_bytes", "kept_bytes", "peak_bytes", "segment_ns")},
            "one_sided_hits_share": (numpy.isnan(theirs[:, 0]) != numpy.isnan(ours[:, 0])).mean(),
            "hit_difference_voxel": numpy.nanmax(apart, initial=0)}


def by_approach(plan, options):
    """Rows of both approaches, one for each volume."""
    def compared(subject, hand):
        segments = segments_of(subject, hand)
        yield {**cells_of("explicit", subject), **dynamic_numbers(subject, hand, segments, plan.passes),
               **explicit_numbers(subject, segments, options)}

    def ball(size):
        # The samples, the shared copy, and what extraction takes at its peak.
        if has_room(size, 3.6, "the explicit approach", options):
            shape = Ball(size, 0.35 * size)  # the blur of its edge stays the same in voxels, as a scanner has it
            yield from compared(shape.sampled(), shape.hand(3, SPEED / RATE * VOXELS, plan.ticks))

    yield from () if options.subjects else map(ball, plan.explicit_sizes)
    for subject in options.subjects or reals(("lobster", "ct-head"), options):
        yield compared(subject, over(subject, SPEED, VOXELS, plan.ticks, options.seed))


def time_text(seconds):
    return figures.matplotlib.ticker.EngFormatter("s")(float(f"{seconds:.3g}"))


def summary_of(table):
    """Both approaches; of the balls the largest."""
    rows = table.where(part="explicit")
    for row in [*rows.where(volume="ball")[-1:], *rows.only(lambda row: row["volume"] != "ball")]:
        known = "explicit_ready_s" in row
        yield {"volume": f"{row['volume']} {row['size']}", "triangles": row.get("explicit_triangles", numpy.nan),
               "extract": time_text(row["explicit_extraction_s"]) if known else "",
               "build": time_text(row["explicit_tree_s"]) if known else "", "peak [MB]": 1e-6 * row.get("explicit_peak_bytes", numpy.nan),
               "kept [MB]": 1e-6 * row.get("explicit_kept_bytes", numpy.nan),
               **{f"our update after a change, {name}": time_text(1e-9 * row[f"change_{name}_ns"]) for name in ("p50", "p99", "max")},
               "not finished": f"{row['unfinished_changes']:g} of {row['changes']:g}"}


NO_NOISE = 0.004  # where 0 is on a logarithmic axis
GROWTH = {"speed": ("speed_mm_s", "hand [mm/s]", "speed", (10, 100, 1000)),
          "voxels-per-mm": ("voxels_per_mm", "voxels per mm", "resolution", (0.5, 2, 8)),
          "size": ("edge", "edge [samples]", "size", (64, 256, 1024)),
          "noise": ("noise_of_range", "noise / range", "noise", (NO_NOISE, 0.01, 0.1, 1))}
TIMES = (("p999_ns", "p99.9", figures.ORANGE, "v"), ("p99_ns", "p99", figures.GREEN, "^"), ("mean_ns", "mean", figures.BLACK, "x"),
         ("p50_ns", "p50", figures.BLUE, "o"))


def edges_of(rows):
    return rows["samples"] ** (1 / 3)


def growth_figure(table):
    """Times above, tetrahedra below. Of several volumes the first."""
    parts = [part for part in GROWTH if table.where(part=part)]
    title = "The cost of an update grows with the hand's path" + (" and with noise, not with the volume's size" if "size" in parts else "")
    drawn, panels = figures.panels(2, len(parts), height=3.8, title=title, sharex="col", sharey="row", squeeze=False,
                                   gridspec_kw={"height_ratios": [3, 1.4]})
    for (above, below), part in zip(panels.T, parts):
        column, axis, title, ticks = GROWTH[part]
        rows = table.where(part=part, volume=table.where(part=part)[0]["volume"])
        exact, smooth = (rows.where(method=name) for name in METHODS)
        x = edges_of(exact) if column == "edge" else numpy.maximum(exact[column], NO_NOISE)
        for name, label, colour, marker in TIMES:
            above.plot(x, exact[name] / 1000, color=colour, marker=marker, label=label)
        above.plot(x, smooth["mean_ns"] / 1000, "s--", color=figures.VERMILION, mfc="none", label="mean, smooth field")
        below.plot(x, exact["tetrahedra_per_update"], "D-", color=figures.PURPLE)
        above.set(title=title, xscale="log", yscale="log")
        below.set(xlabel=axis, yscale="log")
        ticks = [tick for tick in ticks if x.min() <= tick <= x.max()]
        figures.ticks(below.xaxis, ticks, ["0" if tick == NO_NOISE else f"{tick:g}" for tick in ticks])
    panels[0, 0].set_ylabel("time of an update [µs]")
    panels[1, 0].set_ylabel("tetrahedra\nper update")
    figures.label_ends(panels[0, -1])
    return PAGE.figure(drawn)


APPROACHES = (  # panel, column, unit, label, colour, marker, dash
    (0, "explicit_ready_s", 1, "explicit: extract and build", figures.VERMILION, "s", "-"),
    (0, "change_p99_ns", 1e-9, "ours: the next update, p99", figures.BLUE, "o", "-"),
    (0, "mean_ns", 1e-9, "ours: any other update, mean", figures.SKY, "o", "--"),
    (0, "explicit_segment_ns", 1e-9, "explicit: then, one segment", figures.ORANGE, "s", "--"),
    (1, "explicit_peak_bytes", 1e-6, "explicit: at the peak", figures.VERMILION, "s", "-"),
    (1, "explicit_kept_bytes", 1e-6, "explicit: kept", figures.ORANGE, "s", "--"),
    (1, "samples_bytes", 1e-6, "both: the samples", figures.GREY, "+", ":"),
    (1, "state_bytes", 1e-6, "ours: the proxy", figures.BLUE, "o", "-"))


def explicit_figure(table):
    """Lines through the balls, single marks for other volumes."""
    rows = table.where(part="explicit")
    balls = rows.where(volume="ball") or rows
    others = rows.only(lambda row: row not in balls)
    drawn, panels = figures.panels(columns=2, height=3,
                                   title="A new level costs us one update, and the explicit approach the whole surface")
    for panel, column, unit, label, colour, marker, dash in APPROACHES:
        panels[panel].plot(edges_of(balls), unit * balls[column], dash, color=colour, marker=marker, label=label)
        panels[panel].plot(edges_of(others), unit * others[column], marker, color=colour, mfc="none", label="_")
    figures.limit(panels[0], 1e-3, "a tick at 1 kHz", "-.")
    panels[0].set(title="time until the new surface is felt", ylabel="[s]")
    panels[1].set(title="memory that it takes", ylabel="[MB]")
    ticks = [edge for edge in (32, 64, 128, 256, 512, 1024) if edge in numpy.round(edges_of(balls))]
    for axes in panels:
        axes.set(xscale="log", yscale="log", xlabel="edge of the volume [samples]")
        if ticks:
            figures.ticks(axes.xaxis, ticks)
    figures.label_ends(*panels)
    return PAGE.figure(drawn, "explicit")


def crossings(table):
    """Tetrahedra entered beyond the one that an update starts in, for each voxel of the hand's path."""
    rows = table.where(part="speed", method="exact")
    return (rows["tetrahedra"] - rows["updates"]) / rows["path_voxel"]


def claims_of(table, own_volumes):
    both, sizes = table.where(part="explicit"), table.where(part="size", method="exact")
    balls = both.where(volume="ball")
    ranges = [("memory", both["heap_growth_bytes"], 0, 0)]
    if own_volumes:
        first, path = sizes[0]["tetrahedra"] if sizes else 0, crossings(table)
        ranges += [("motion", sizes["tetrahedra"], first, first), ("path", path, path.min(), 1.1 * path.min()),
                   ("change", balls["unfinished_changes"], 0, 0), ("deviation", balls["worst_deviation_of_range"], 0, GRANTED),
                   ("same", balls["one_sided_hits_share"], 0, 0), ("place", balls["hit_difference_voxel"], 0, 0.1)]
    for name, values, low, high in ranges:
        values = values[~numpy.isnan(values)]
        if len(values):  # where nothing was measured nothing is claimed
            least, most = values.min(), values.max()
            yield PAGE.claim(name, low <= least and most <= high, least=least, most=most)


def span(values):
    values = values[~numpy.isnan(values)]
    return f"{values.min():.0f} to {values.max():.0f} ns" if len(values) else "not measured"


def text_of(table, own_volumes, passes):
    rows, sections = table.where(part="explicit"), ["", *(["growth"] if own_volumes else []), "explicit"]
    cases = itertools.product(GROWTH, METHODS)
    values = {"state": rows[0]["state_bytes"], "passes": passes,
              "mean": {f"{part} {method}": span(table.where(part=part, method=method)["mean_ns"]) for part, method in cases}}
    if own_volumes:
        found, edges = crossings(table), table.where(part="size").distinct("size")
        moved = table.where(part="noise", method="exact")["tetrahedra_per_update"]
        values.update(fewest=found.min(), most=found.max(), small=edges[0], large=edges[-1], calm=moved[0], noisy=moved.min())
    if not numpy.isnan(rows["explicit_segment_ns"]).all():
        sections.append("segments")
        values.update(segment=span(rows["explicit_segment_ns"]), update=span(rows["mean_ns"]))
    return PAGE.text(*sections, **values)


def run(options):
    plan, own_volumes = QUICK if options.quick else FULL, not options.subjects
    if not own_volumes:
        options.note("a given volume has one size and its own noise: those parts are left out")
    parts = by_hand(plan, options), by_body(plan, options) if own_volumes else (), by_approach(plan, options)
    table = Table(row for rows in options.each(itertools.chain(*parts)) for row in rows)
    return Result(table, [growth_figure(table), explicit_figure(table)], claims_of(table, own_volumes),
                  text_of(table, own_volumes, plan.passes), summary_of(table))
