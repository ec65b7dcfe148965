"""fall-through: does a fast hand fall through a thin wall?"""

import collections
import itertools

import numpy
import palpate
import scipy.stats

from . import figures, sampling
from .experiment import GRANTED, Page, Result, Table, largest
from .outside import Outside
from .subjects import CONTESTANTS, GUARDED
from .walls import closed_shell, lines_through

PAGE = Page(__name__)
COUNTS_AS_INSIDE = 0.01  # of the data's range
STEPS_BEHIND = 50  # the hand stops so many ticks behind the wall, at the latest
ROWS_AT_ONCE = 1_000_000


# A subject, what can be reached in it from outside, and the lines through it, which all contestants share.
Wall = collections.namedtuple("Wall", "subject outside lines")
Group = collections.namedtuple("Group", "name thickness walls")  # of one row of the table; walls by interpolation, equally thick


def walls_of(subject, anywhere, count, options):
    """A wall for each seed, with its part of the lines."""
    outside = Outside(subject)
    return [Wall(subject, outside, lines_through(subject, outside, anywhere, len(range(part, count, options.seeds)),
                                                 numpy.random.default_rng([options.seed, part]))) for part in range(options.seeds)]


def groups_of(options, thicknesses, count):
    if options.subjects:
        return [Group(subject.name, numpy.nan, {"linear": walls_of(subject, True, count, options)}) for subject in options.subjects]
    return [Group("box and ball", thickness, {field: [
        wall for shape in ("box", "ball") for wall in walls_of(closed_shell(shape, thickness, field), False, count // 2, options)]
        for field in ("linear", "cubic")}) for thickness in thicknesses]


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

    inside, inside_pressed = ((excess[rows] > COUNTS_AS_INSIDE) | ~wall.outside.holds(trace.scp[rows]) for rows in (last, first + in_solid))
    return {"inside": inside, "pressed": in_solid > 0, "inside_pressed": (in_solid > 0) & inside_pressed,
            "unfelt": ~numpy.logical_or.reduceat(trace.constrained, first), "worst": numpy.maximum.reduceat(excess, first),
            "ticks": last - first}


def row_of(group, contestant, speed, rate, seed):
    random = numpy.random.default_rng(seed)  # all contestants meet the same phases
    walls, step, found = group.walls[contestant.interpolation], speed / rate, []
    for wall in walls:  # in parts that fit into memory
        lines, phase = wall.lines, 1 - random.random(len(wall.lines.wall))
        rows = numpy.ceil(numpy.minimum(lines.end, lines.wall + STEPS_BEHIND * step) / step) + 4
        part = (numpy.cumsum(rows) // ROWS_AT_ONCE).astype(int)
        found += [cross(wall, contestant, lines[part == p], step, phase[part == p]) for p in numpy.unique(part)]
    found = {name: numpy.concatenate([part[name] for part in found]) for name in found[0]}
    pressed = int(found["pressed"].sum())
    medians = [sampling.quantile(wall.lines.wall, 0.5) / wall.subject.voxel for wall in walls]  # infinite where most lines end in the solid
    return {"wall": group.name, "thickness_voxel": group.thickness,
            "median_path_in_wall_voxel": numpy.mean(medians) if numpy.isfinite(medians).all() else numpy.nan,
            "method": contestant.name, "speed_mm_s": speed, "rate_hz": rate, "step_mm": step, "crossings": len(found["inside"]),
            "inside_share": found["inside"].mean(), "pressed_share": found["pressed"].mean(),
            "inside_while_pressed_share": found["inside_pressed"].sum() / pressed if pressed else numpy.nan,
            "unfelt_share": found["unfelt"].mean(), "worst_excess_of_range": found["worst"].max(initial=0),
            "ticks_per_crossing": found["ticks"].mean()}


def share_in_words(table, column, of="crossings"):
    """'12.3 [12.1, 12.5]' percent, exact binomial interval."""
    counts = table["crossings"] * (table["pressed_share"] if of == "pressed" else 1)
    successes = numpy.nansum(table[column] * counts)
    interval = scipy.stats.binomtest(int(round(successes)), int(round(counts.sum()))).proportion_ci(method="exact")
    return "{:.3g} [{:.3g}, {:.3g}]".format(*(100 * share for share in (successes / counts.sum(), interval.low, interval.high)))


def summary_of(table):
    for name, rows in table.by("method"):
        yield {"method": name, "crossings": f"{rows['crossings'].sum():,.0f}",
               "ends inside [%, 95 % interval]": share_in_words(rows, "inside_share"),
               "inside while the hand is in the wall [%, 95 % interval]": share_in_words(rows, "inside_while_pressed_share", "pressed"),
               "wall not felt at all [%, 95 % interval]": share_in_words(rows, "unfelt_share")}


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
        for name, rows in table.only(lambda row: not numpy.isnan(row[column])).by("method"):
            steps = sorted(rows.distinct("step_mm"))
            values = [100 * rows.where(step_mm=step)[column] for step in steps]
            figures.curve(axes, name, steps, [v.mean() for v in values], markersize=3)
            axes.fill_between(steps, [v.min() for v in values], [v.max() for v in values], color=figures.LOOKS[name][0], alpha=0.12, lw=0)
        axes.set(title=title, xscale="log", xlabel="hand per tick [mm]", ylim=(-3, 103))
    panels[0].set_ylabel("share of the crossings [%]")
    figures.label_ends(panels[2])
    return PAGE.figure(drawn)


def map_of(table):
    """How often a gradient method does not feel walls of each thickness, or each volume of the user."""
    name = "gradient"
    rows, users = table.where(method=name), is_a_users(table)
    column = "wall" if users else "thickness_voxel"
    steps, walls = sorted(rows.distinct("step_mm")), rows.distinct(column)
    walls = walls if users else sorted(walls)
    share = [[100 * rows.where(**{column: wall, "step_mm": step})["unfelt_share"].mean() for step in steps] for wall in walls]
    drawn, axes = figures.panels(width=figures.PAGE, height=0.9 + 0.27 * len(walls))
    figures.number_map(axes, share, walls, [f"{step:g}" for step in steps], 140)
    title = f"{name}: walls that are not felt [%]" + ("" if users else ", more of them the faster the hand and the thinner the wall")
    axes.set(title=title, xlabel="hand per tick [mm]", ylabel="volume" if users else "wall [voxel]")
    axes.tick_params(axis="x", rotation=45, labelsize=6.5)
    return PAGE.figure(drawn, "unfelt", method=name)


def claims_of(table, groups, own_walls):
    for method, rows in table.only(lambda row: row["method"] in GUARDED).by("method"):
        most, count = largest(rows["inside_share"]), int(rows["crossings"].sum())
        measured = sampling.none_of(count, "crossings") if most == 0 else f"largest share {most:g} of {count:,}"
        yield PAGE.claim("never", most == 0, method=method, measured=measured)
        yield PAGE.at_most(GRANTED, rows["worst_excess_of_range"], "solid", method=method)
    if not own_walls:
        return
    reached = [wall.outside.holds([wall.subject.field.geometry.centre])[0] for group in groups for wall in group.walls["linear"]]
    yield PAGE.claim("closed", not any(reached), thicknesses=len(groups))
    for method in ("gradient", "gradient-improved"):
        least = table.where(method=method)["inside_share"].min()
        yield PAGE.claim("always", least == 1, method=method, least=least)


def run(options):
    thicknesses, speeds, rates, count = (
        ((2, 0.5, 0.25), (10, 100, 1e4), (100, 1000), 60) if options.quick else
        ((3, 2, 1.5, 1, 0.75, 0.5, 0.25), (10, 100, 500, 1000, 2000, 5000, 1e4), (100, 250, 1000, 4000), 10000))
    groups, table = groups_of(options, thicknesses, count), Table()
    for cell, (group, speed, rate) in enumerate(options.each(itertools.product(groups, speeds, rates)), 1):
        table.extend(row_of(group, contestant, speed, rate, [options.seed, cell])
                     for contestant in CONTESTANTS.values() if contestant.interpolation in group.walls)
    lines = count * len(groups)
    text = PAGE.text("walls of a user" if options.subjects else "own walls", "method", slowest=speeds[0], fastest=speeds[-1],
                     least=rates[0], most=rates[-1], count=count, seeds=options.seeds, lines=lines, bound=sampling.bound_of_none(lines))
    return Result(table, [figure_of(table), map_of(table)], claims_of(table, groups, not options.subjects), text, summary_of(table))
