"""fall-through: does a fast hand fall through a thin wall?

A hand moves straight through closed walls at all speeds and rates. Is the proxy inside afterwards?
"""

import dataclasses
import itertools

import numpy
import palpate
import scipy.stats

from . import figures, sampling
from .experiment import GRANTED, Claim, Figure, Result, Table, at_most, largest, paragraphs
from .outside import Outside
from .subjects import CONTESTANTS, GUARDED, Subject
from .walls import Lines, closed_shell, lines_through

TITLE = "Does a fast hand fall through a thin wall?"
COUNTS_AS_INSIDE = 0.01  # of the data's range
STEPS_BEHIND = 50  # the hand stops so many ticks behind the wall, at the latest
ROWS_AT_ONCE = 1_000_000


@dataclasses.dataclass
class Wall:
    """A subject, what can be reached in it, and the lines through it, which all contestants share."""

    subject: Subject
    outside: Outside
    lines: Lines

    @property
    def median_path(self):
        """[voxel] in the solid; NaN where most lines end in it."""
        median = sampling.quantile(self.lines.wall, 0.5)
        return median / self.subject.voxel if numpy.isfinite(median) else numpy.nan


@dataclasses.dataclass
class Group:
    """Walls of one row of the table; those on the smooth field have the same thickness there."""

    name: str
    thickness: float
    linear: list
    smooth: list

    def walls(self, contestant):
        return self.smooth if contestant.interpolation == "cubic" else self.linear


def walls_of(subject, anywhere, count, options):
    """A wall for each seed, with its part of the lines."""
    outside = Outside(subject)
    return [Wall(subject, outside, lines_through(subject, outside, anywhere, len(range(part, count, options.seeds)),
                                                 numpy.random.default_rng([options.seed, part]))) for part in range(options.seeds)]


def groups_of(options, thicknesses, count):
    if options.subjects:
        return [Group(subject.name, numpy.nan, walls_of(subject, True, count, options), []) for subject in options.subjects]

    def shells(thickness, field):
        return [wall for shape in ("box", "ball")
                for wall in walls_of(closed_shell(shape, thickness, field), False, count // 2, options)]

    return [Group("box and ball", thickness, shells(thickness, "linear"), shells(thickness, "cubic")) for thickness in thicknesses]


def ways(lines, step, phase):
    """Where the hand is: (rows of all hands behind one another [mm along the line], the row in which each begins, the hand of each
    row, where each hand ends). It starts `phase` steps before the surface, because ticks in free space decide nothing, and rests
    for a tick at the end."""
    end = numpy.minimum(lines.end, lines.wall + STEPS_BEHIND * step)
    moves = numpy.ceil(end / step + phase).astype(int) - 1
    counts = moves + 3  # start, moves, and twice the end
    first = numpy.concatenate([[0], numpy.cumsum(counts)[:-1]])
    hand = numpy.repeat(numpy.arange(len(counts)), counts)
    k = numpy.arange(counts.sum()) - first[hand]
    return numpy.where(k > moves[hand], end[hand], (k - phase[hand]) * step), first, hand, end


def cross(wall, contestant, lines, step, phase):
    """What proxies do on lines: arrays by name, a row per line."""
    subject = wall.subject
    along, first, hand, end = ways(lines, step, phase)
    hips = lines.entry[hand] + along[:, None] * lines.along[hand]
    trace = palpate.follow_each(subject.field, subject.isovalue, hips, first, contestant.method)
    excess = subject.excess(trace.density)
    excess[first] = 0  # where the proxy was put
    last = numpy.append(first[1:], len(hand)) - 1
    moving = numpy.arange(len(hand)) > first[hand]
    moving[last] = moving[last - 1] = False
    in_solid = numpy.add.reduceat((moving & (along < numpy.minimum(lines.wall, end)[hand])).astype(int), first)

    def inside(rows):
        return (excess[rows] > COUNTS_AS_INSIDE) | ~wall.outside.holds(trace.scp[rows])

    return {"inside": inside(last), "pressed": in_solid > 0, "inside_pressed": (in_solid > 0) & inside(first + in_solid),
            "unfelt": ~numpy.logical_or.reduceat(trace.constrained, first), "worst": numpy.maximum.reduceat(excess, first),
            "ticks": last - first}


def crossings_of(wall, contestant, step, random):
    """cross() in parts that fit into memory."""
    lines, phase = wall.lines, 1 - random.random(len(wall.lines.wall))
    rows = numpy.ceil(numpy.minimum(lines.end, lines.wall + STEPS_BEHIND * step) / step) + 4
    part = (numpy.cumsum(rows) // ROWS_AT_ONCE).astype(int)
    return [cross(wall, contestant, lines.part(part == p), step, phase[part == p]) for p in numpy.unique(part)]


def row_of(group, contestant, speed, rate, seed):
    random = numpy.random.default_rng(seed)  # all contestants meet the same phases
    walls = group.walls(contestant)
    found = [part for wall in walls for part in crossings_of(wall, contestant, speed / rate, random)]
    found = {name: numpy.concatenate([part[name] for part in found]) for name in found[0]}
    pressed = int(found["pressed"].sum())
    return {"wall": group.name, "thickness_voxel": group.thickness,
            "median_path_in_wall_voxel": numpy.mean([wall.median_path for wall in walls]), "method": contestant.name,
            "speed_mm_s": speed, "rate_hz": rate, "step_mm": speed / rate, "crossings": len(found["inside"]),
            "inside_share": found["inside"].mean(), "pressed_share": found["pressed"].mean(),
            "inside_while_pressed_share": found["inside_pressed"].sum() / pressed if pressed else numpy.nan,
            "unfelt_share": found["unfelt"].mean(), "worst_excess_of_range": found["worst"].max(initial=0),
            "ticks_per_crossing": found["ticks"].mean()}


def share_in_words(table, column, of="crossings"):
    """'12.3 % [12.1, 12.5]', exact binomial interval."""
    counts = table["crossings"] * (table["pressed_share"] if of == "pressed" else 1)
    successes = numpy.nansum(table[column] * counts)
    interval = scipy.stats.binomtest(int(round(successes)), int(round(counts.sum()))).proportion_ci(method="exact")
    return f"{successes / counts.sum():.3%} [{interval.low:.3%}, {interval.high:.3%}]"


def summary_of(table):
    for name in table.distinct("method"):
        rows = table.where(method=name)
        yield {"method": name, "crossings": f"{rows['crossings'].sum():,.0f}",
               "ends inside [95 % interval]": share_in_words(rows, "inside_share"),
               "inside while the hand is in the wall": share_in_words(rows, "inside_while_pressed_share", "pressed"),
               "wall not felt at all": share_in_words(rows, "unfelt_share")}


def is_a_users(table):
    """Walls of a user have no known thickness, and nothing is said of them in advance."""
    return bool(numpy.isnan(table["thickness_voxel"]).any())


def figure_of(table):
    """Three shares against the hand's step, the mean over the walls with their spread."""
    title = "How often a wall fails" if is_a_users(table) else "Only methods that look at the whole step keep the proxy out"
    drawn, panels = figures.panels(columns=3, height=2.9, title=title, sharey=True)
    shares = {"inside_share": "inside behind the wall", "inside_while_pressed_share": "inside, hand in the wall",
              "unfelt_share": "wall not felt"}
    for axes, (column, title) in zip(panels, shares.items()):
        for name in table.distinct("method"):
            rows = table.where(method=name).only(lambda row: not numpy.isnan(row[column]))
            steps = sorted(rows.distinct("step_mm"))
            values = [100 * rows.where(step_mm=step)[column] for step in steps]
            figures.curve(axes, name, steps, [v.mean() for v in values], markersize=3)
            axes.fill_between(steps, [v.min() for v in values], [v.max() for v in values], color=figures.LOOKS[name][0], alpha=0.12, lw=0)
        axes.set(title=title, xscale="log", xlabel="hand per tick [mm]", ylim=(-3, 103))
    panels[0].set_ylabel("share of the crossings [%]")
    figures.label_ends(panels[2])
    return Figure("", """Shares of the crossings against how far the hand moves per tick, which is its speed over the rate: the mean
        over all walls, shaded from the best to the worst wall. In the middle, only crossings count in which the hand is in the solid
        in at least one tick.""", drawn)


def map_of(table, name="gradient"):
    """How often a method does not feel walls of each thickness, or each volume of the user."""
    rows, users = table.where(method=name), is_a_users(table)
    column = "wall" if users else "thickness_voxel"
    steps, walls = sorted(rows.distinct("step_mm")), rows.distinct(column)
    walls = walls if users else sorted(walls)
    share = [[100 * rows.where(**{column: wall, "step_mm": step})["unfelt_share"].mean() for step in steps] for wall in walls]
    drawn, axes = figures.panels(width=figures.PAGE, height=0.9 + 0.27 * len(walls))
    figures.number_map(axes, share, walls, [f"{step:g}" for step in steps], 140)
    title = f"{name}: how often a wall is not felt" if users else f"{name}: the faster the hand and the thinner the wall, the less is felt"
    axes.set(title=title, xlabel="hand per tick [mm]", ylabel="volume" if users else "wall [voxel]")
    axes.tick_params(axis="x", rotation=45, labelsize=6.5)
    return Figure("unfelt", f"""Share of the crossings [%] in which the proxy of the method {name} is in contact in no tick, so that the
        wall is not felt.""", drawn)


def claims_of(table, groups, own_walls):
    for method in GUARDED:
        rows = table.where(method=method)
        if not rows:
            continue
        most, count = largest(rows["inside_share"]), int(rows["crossings"].sum())
        yield Claim(f"{method} never ends inside, in any of the crossings", most == 0,
                    sampling.none_of(count, "crossings") if most == 0 else f"largest share {most:g} of {count:,}")
        yield at_most(GRANTED, rows["worst_excess_of_range"],
                      f"{method} is never in the solid by more than {GRANTED:g} of the data's range, in any tick")
    if not own_walls:
        return
    reached = [wall.outside.holds([wall.subject.field.geometry.centre])[0] for group in groups for wall in group.linear]
    yield Claim("the walls are closed: no free path through the lattice leads in", not any(reached),
                f"{len(groups)} thicknesses, two shapes")
    for method in ("gradient", "gradient-improved"):
        least = float(table.where(method=method)["inside_share"].min())
        yield Claim(f"{method} ends inside in every crossing", least == 1, f"smallest share {least:g}")


OWN_WALLS = """A hand moves straight through closed shells around a box, which is flat, and around a ball of voxels, which is stepped. The
    lines are random and end 3 voxels or 50 ticks behind the wall. The shells are layers of full samples, and the isovalue sets their
    thickness on each flat face, because a ramp sampled thinner than a voxel would have real holes. The contestant smooth is the exact
    method on the smooth field, on walls that have the same thickness there."""
USERS_WALLS = """A hand moves straight into the user's volumes on random lines: to behind a wall where it cannot be reached otherwise, else
    into the solid."""


def run(options):
    thicknesses, speeds, rates, count = (
        ((2, 0.5, 0.25), (10, 100, 1e4), (100, 1000), 60) if options.quick else
        ((3, 2, 1.5, 1, 0.75, 0.5, 0.25), (10, 100, 500, 1000, 2000, 5000, 1e4), (100, 250, 1000, 4000), 10000))
    groups, table = groups_of(options, thicknesses, count), Table()
    for cell, (group, speed, rate) in enumerate(options.each(itertools.product(groups, speeds, rates)), 1):
        table.extend(row_of(group, contestant, speed, rate, [options.seed, cell])
                     for contestant in CONTESTANTS.values() if group.walls(contestant))
    return Result(table, [figure_of(table), map_of(table)], list(claims_of(table, groups, not options.subjects)), paragraphs(f"""
        {USERS_WALLS if options.subjects else OWN_WALLS}

        The hand moves at {speeds[0]:g} to {speeds[-1]:g} mm/s and {rates[0]:g} to {rates[-1]:g} Hz, with {count} crossings per wall
        thickness, speed and rate, from {options.seeds} seeds. It starts a random part of a step before the surface, and rests for a
        tick at the end. The proxy is inside if it is in the solid by more than a hundredth of the data's range, or in free space to
        which no free path from outside leads. This is decided exactly, on the connectivity of the lattice.

        The exact method and the method of the paper look at the whole step of a tick. The gradient methods look at the density at the
        position of the hand: if it is free there, they take the hand to be free, on whichever side. Intervals and bounds take the
        crossings as independent. All speeds and rates share the same lines, so the evidence is somewhat weaker than they say."""),
        Table(summary_of(table)))
