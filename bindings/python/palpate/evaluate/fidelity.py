"""fidelity: does the force point in the direction of the true surface?"""

import functools
import itertools

import numpy
import palpate

from . import figures
from .bodies import SAMPLES, ball_by, of_a_user, ripples_by_spiral, torus_by_helix, unit
from .experiment import GRANTED, Figure, Page, Result, Table, known, largest
from .meshes import nearest_points
from .sampling import quantile
from .subjects import CONTESTANTS, GUARDED

PAGE = Page(__name__)
NEAREST = "nearest point (reference)"  # not a method: where the whole 8-bit isosurface is nearest to the hand
RIVAL, SHADED, EMBREE = "CHAI3D voxel object (measured)", "CHAI3D shaded mesh (measured)", "Embree god object (measured)"
ANGLES = "angle", "off_ideal"  # to the true normal at the SCP, and to a perfect force
PEERS = known("peers_of_fidelity")


def mean(values):
    return float(numpy.mean(values)) if len(values) else numpy.nan


def statistics(values, name, unit_of, *what):
    """Cells of a row: mean, 99th percentile and largest of some values."""
    found = {"mean": mean(values), "p99": quantile(values, 0.99), "max": quantile(values, 1)}
    return {f"{name}_{one}_{unit_of}": found[one] for one in what or found}


def degrees_between(a, b):
    """Of vectors that are not zero; accurate near 0, where an arc cosine is not."""
    u, v = unit(a), unit(b)
    return 2 * numpy.degrees(numpy.arctan2(numpy.linalg.norm(u - v, axis=1), numpy.linalg.norm(u + v, axis=1)))


def true_gradient(subject, points):
    """Of the analytic density [1/mm]: central differences over 1e-3 mm, less than the surfaces bend by."""
    return numpy.stack([(subject.exact(points + step) - subject.exact(points - step)) / 2e-3 for step in 1e-3 * numpy.eye(3)], axis=1)


def errors_of(body, scp, hands):
    """(angle to the true normal at the SCP, distance to the true surface [mm], angle to the perfect force), each where it is known; SCPs in
    contact."""
    subject, force = body.subject, scp - hands
    angle = error = off = numpy.array([])
    if subject.exact is not None and len(scp):
        gradient = true_gradient(subject, scp)
        steepness = numpy.linalg.norm(gradient, axis=1)
        steep = steepness > 0
        angle = degrees_between(force[steep], -subject.sign * gradient[steep])
        error = abs(subject.exact(scp[steep]) - subject.isovalue) / steepness[steep]
    if body.ideal is not None and len(scp):
        off = degrees_between(force, body.ideal(hands))
    return angle, error, off


def stroke(body, contestant, steps, begin=0.0, end=1.0):
    """(trace, hands, forces as SCP - hand) of a hand from one part of the trajectory to another."""
    hands = body.hand(begin + (end - begin) * numpy.arange(steps + 1) / steps)
    proxy = contestant.proxy(body.subject, body.start)
    proxy.follow(hands[:1])
    trace = proxy.follow(hands[1:])
    return trace, hands[1:], numpy.where(trace.constrained[:, None], trace.scp - hands[1:], 0)


def turns_of(force):
    """[degrees] From each tick in contact to the next."""
    strong = (force != 0).any(axis=1)
    both = strong[1:] & strong[:-1]
    return degrees_between(force[1:][both], force[:-1][both])


def row_of(body, method, steps, angle, error, off):
    voxel = body.subject.voxel
    return {"body": body.subject.name, "trajectory": body.trajectory, "grid": body.grid, "samples": body.samples, "method": method,
            "steps": steps, "depth_voxel": body.depth / voxel, "step_voxel": numpy.nan, "contact_share": numpy.nan,
            **statistics(angle, "angle", "deg"), **statistics(off, "off_ideal", "deg"),
            "surface_error_mean_voxel": mean(error) / voxel, "surface_error_max_voxel": quantile(error, 1) / voxel}


def measured(body, contestant, steps):
    trace, hands, force = stroke(body, contestant, steps)
    strength = numpy.linalg.norm(force, axis=1)
    change = numpy.linalg.norm(numpy.diff(force, axis=0), axis=1) / mean(strength[trace.constrained])
    touching = trace.constrained & (strength > 0)
    way = numpy.diff(body.hand(numpy.arange(steps + 1) / steps), axis=0)
    return {**row_of(body, contestant.name, steps, *errors_of(body, trace.scp[touching], hands[touching])),
            "contact_share": mean(trace.constrained), "step_voxel": mean(numpy.linalg.norm(way, axis=1)) / body.subject.voxel,
            **statistics(turns_of(force), "turn", "deg"), **statistics(change, "jump", "share", "p99", "max"),
            "update_median_us": quantile(trace.update_ns, 0.5) / 1000,
            "worst_deviation_of_range": largest(abs(body.subject.excess(trace.density[trace.constrained])))}


def other_rows(body, count):
    """Of the ball on the circle: the nearest points to so many hands, and the peers."""
    if body.samples == "uint8":
        hands = body.hand((numpy.arange(count) + 0.5) / count)
        mesh = palpate.extract(body.subject.field, body.subject.isovalue)
        yield row_of(body, NEAREST, count, *errors_of(body, numpy.array(list(nearest_points(mesh, hands))), hands))
    for peer in PEERS.where(samples=body.samples, grid=body.grid):
        yield {"body": "ball", "trajectory": "circle", "grid": body.grid, "samples": body.samples, "method": peer["method"], "steps": 20000,
               "depth_voxel": 0.03 * body.grid,
               **{f"{angle}_{what}_deg": peer[what] for angle in ANGLES for what in ("mean", "p99") if what in peer}}


def bodies_of(options):
    """Functions that make one body each, because the largest takes half a gigabyte."""
    if options.subjects:
        return [functools.partial(of_a_user, subject) for subject in options.subjects]
    circle, spiral = (functools.partial(ball_by, name) for name in ("circle", "spiral"))
    plan = {circle: (64, 128), torus_by_helix: (40, 80), ripples_by_spiral: (41, 81)} if options.quick else {
        circle: (128, 256, 512), spiral: (128, 256, 512), torus_by_helix: (80, 160, 320), ripples_by_spiral: (41, 81, 161, 321)}
    return [functools.partial(make, grid, samples) for make, grids in plan.items() for grid, samples in itertools.product(grids, SAMPLES)]


def ball_rows(table, samples, method="exact"):
    return table.where(body="ball", trajectory="circle", samples=samples, method=method)


def summary_of(table):
    """A row for each method on each kind of samples."""
    for samples, method in itertools.product(SAMPLES, (*CONTESTANTS, *PEERS.distinct("method"))):
        rows = ball_rows(table, samples, method)
        if rows:
            yield {"samples": samples, "method": method, **{
                f"grid {row['grid']:g}: mean / p99 [deg]": " / ".join(
                    f"{angle:.3g}" for angle in (row["off_ideal_mean_deg"], row.get("off_ideal_p99_deg", numpy.nan)) if angle < numpy.inf)
                for row in rows}}


# Lines of a figure: method, samples, label, colour, marker.
BALL = ((RIVAL, "uint8", "CHAI3D voxel object", figures.BLACK, "s"), (SHADED, "uint8", "CHAI3D shaded mesh", figures.GREY, "s"),
        (EMBREE, "uint8", "Embree god object", figures.GREEN, "x"), ("exact", "uint8", "exact", *figures.LOOKS["exact"]),
        ("gradient-improved", "uint8", "gradient-improved", *figures.LOOKS["gradient-improved"]),
        ("smooth", "uint8", "smooth", *figures.LOOKS["smooth"]))
SOURCES = (("exact", "uint8", "exact, 8 bit", figures.BLUE, "o"), ("exact", "uint8 smoothed", "exact, smoothed", figures.SKY, "v"),
           ("exact", "float32", "exact, not rounded", figures.GREEN, "^"),
           ("smooth", "uint8 dequantized", "smooth, dequantized", figures.ORANGE, "s"),
           ("smooth", "float32", "smooth, not rounded", figures.PURPLE, "D"))
DEQUANTIZED = (SHADED, "uint8 dequantized", "CHAI3D, dequantized", figures.GREY, "s")


def draw_lines(axes, rows, lines, column, title, label="mean angle [degrees]"):
    for method, samples, name, colour, marker in lines:
        found = rows.where(method=method, samples=samples)
        axes.plot(found["grid"], found[column], color=colour, marker=marker, label=name)
    axes.set(title=title, xscale="log", yscale="log", xlabel="samples along an axis", ylabel=label)
    figures.ticks(axes.xaxis, sorted(rows.distinct("grid")))


def figure_of_ball(table):
    drawn, (left, right) = figures.panels(columns=2, height=2.9)
    rows = table.where(body="ball", trajectory="circle")
    draw_lines(left, rows, BALL, "off_ideal_mean_deg", "raw 8-bit samples mislead every method")
    draw_lines(right, rows, (*SOURCES, DEQUANTIZED), "off_ideal_mean_deg", "dequantized, the smooth field is accurate")
    figures.ticks(left.yaxis, (3, 5, 10, 20, 40))
    figures.label_ends(left, right)
    return PAGE.figure(drawn)


def figure_of_turn(grid):
    steps, arc = 1500, 12
    drawn, (left, right) = figures.panels(columns=2, height=2.7)
    for name, samples, label, colour in (("exact", "float32", "linear", figures.GREEN),
                                         ("smooth", "uint8 dequantized", "smooth, dequantized", figures.ORANGE),
                                         ("smooth", "float32", "smooth", figures.PURPLE)):
        *_, force = stroke(ball_by("circle", grid, samples), CONTESTANTS[name], steps, 0.1, 0.1 + arc / 360)
        turns = numpy.maximum(turns_of(force), 1e-4)
        left.plot(arc * (1 + numpy.arange(len(turns))) / steps, turns, color=colour, lw=0.8)
        right.plot(numpy.sort(turns), 100 * (1 + numpy.arange(len(turns))) / len(turns), color=colour, label=label)
    left.axhline(arc / steps, color=figures.BLACK, ls="--", lw=0.8)
    left.set(title="on the linear field,\nthe force jumps at facets", xlabel="hand along the circle [degrees]", yscale="log",
             ylabel="turn per tick [degrees]")
    right.set(title="on the smooth field,\nit turns evenly", xlabel="turn per tick [degrees]", ylabel="ticks with no larger turn [%]",
              xscale="log")
    figures.label_ends(right)
    return PAGE.figure(drawn, "turn", arc=arc, grid=grid, step=arc / steps)


def figure_of_losses(table):
    """What the smooth field costs: the height of thin walls, and a bias where surfaces curve."""
    drawn, (left, right) = figures.panels(columns=2, height=2.6)
    at = numpy.linspace(-3, 3, 121)
    for samples, colour in ((1, figures.VERMILION), (2, figures.BLUE), (3, figures.GREEN)):
        wall = numpy.zeros((15, 15, 15), dtype=numpy.float32)
        wall[:, :, 8 - samples:8] = 1
        points = numpy.stack([7 - 0.5 * (samples - 1) + at, 0 * at + 7, 0 * at + 7], axis=1)
        for interpolation, dashes in (("linear", "--"), ("cubic", "-")):
            left.plot(at, palpate.Field(palpate.Volume(wall), interpolation=interpolation).value(points), dashes, color=colour)
        left.text(3, 0.55 + 0.12 * samples, f"{samples} thick", color=colour, fontsize=7, ha="right")
    left.set(title="a wall of one sample\nloses a quarter of its height", xlabel="across the wall [voxel]", ylabel="density")
    draw_lines(right, table.where(body="ball", trajectory="circle"), SOURCES[2::2], "surface_error_mean_voxel",
               "the surface of a ball moves by\nthousandths of a voxel", "distance from the true one [voxel]")
    figures.label_ends(right)
    return PAGE.figure(drawn, "losses")


def figure_of_shapes(table):
    drawn, panels = figures.panels(columns=2, height=2.9, title="Where nothing is rounded, finer grids give more accurate forces")
    for axes, body in zip(panels, ("torus", "marschner-lobb")):
        draw_lines(axes, table.where(body=body), SOURCES, "angle_mean_deg", body)
    figures.label_ends(*panels)
    return PAGE.figure(drawn, "shapes")


def figure_of_users(table):
    drawn, axes = figures.panels(height=2.8)
    for number, name in enumerate(CONTESTANTS):
        rows = table.where(method=name)
        figures.curve(axes, name, numpy.arange(len(rows)) + 0.1 * (number - 2), rows["turn_p99_deg"], ls="")
    axes.set(title="how much the force turns per tick", ylabel="99th percentile [degrees]")
    figures.ticks(axes.xaxis, range(len(rows)), rows.distinct("body"))
    figures.label_ends(axes)
    return Figure("", *PAGE.text("turn of a user"), drawn)


def beside_rival(table, name, samples, grids):
    """The Claim that exact is below the rival on raw samples in mean and p99, by both angles, on every trajectory; with
    '128 (4.3 against 15, p99 16 against 40), 256 (...)'."""
    held, measured = True, []
    for grid in grids:
        rival = PEERS.where(method=RIVAL, samples="uint8", grid=grid)[0]
        rows = table.where(body="ball", samples=samples, method="exact", grid=grid)
        held &= all(row[f"{angle}_{what}_deg"] < rival[what] for row in rows for angle in ANGLES for what in ("mean", "p99"))
        measured.append("{grid:g} ({off_ideal_mean_deg:.2g} against {mean:g}, p99 {off_ideal_p99_deg:.2g} against {p99:g})".format(
            **{**rows.where(trajectory="circle")[0], **rival}))
    return PAGE.claim(name, held, measured=", ".join(measured))


def claims_of(table, own_bodies, steps):
    yield PAGE.at_most(GRANTED, [largest(table.where(method=name)["worst_deviation_of_range"]) for name in GUARDED], "stays")
    if not own_bodies:
        return
    for body in ("ball", "torus"):  # twice the grid, half the angle: the facets of linear pieces, where nothing is rounded
        angles = table.where(body=body, samples="float32", method="exact").only(lambda row: row["trajectory"] != "spiral")["angle_mean_deg"]
        factors = angles[:-1] / angles[1:]
        yield PAGE.claim("converges", (factors >= 1.7).all(), body=body, least=factors.min(), doublings=len(factors))
    yield beside_rival(table, "raw", "uint8", [128])
    yield beside_rival(table, "smoothed", "uint8 smoothed", ball_rows(table, "uint8").only(lambda row: row["grid"] >= 128).distinct("grid"))
    for what, samples, column, most in (
            ("the mean angle", "float32", "off_ideal_mean_deg", 0.005),
            ("the mean angle", "uint8 dequantized", "off_ideal_mean_deg", 0.03),
            ("the 99th percentile of the angle", "uint8 dequantized", "off_ideal_p99_deg", 0.1),
            ("the turn of the force in a tick, p99 (the ball's own and 10 %),", "float32", "turn_p99_deg", 1.1 * 360 / steps)):
        rows = ball_rows(table, samples, "smooth").only(lambda row: row["grid"] >= 128)
        yield PAGE.at_most(most, rows[column], "smooth", samples=samples, what=what)


def run(options):
    steps, table = 1500 if options.quick else 20000, Table()
    for make in options.each(bodies_of(options)):
        body = make()
        table.extend(measured(body, contestant, steps) for contestant in CONTESTANTS.values())
        if not options.subjects and (body.subject.name, body.trajectory) == ("ball", "circle"):
            table.extend(other_rows(body, 20 if options.quick else 100))
    claims = claims_of(table, not options.subjects, steps)
    if options.subjects:
        return Result(table, [figure_of_users(table)], claims, PAGE.text("volumes of a user"))
    shown = [figure_of_ball(table), figure_of_turn(64 if options.quick else 128), figure_of_losses(table), figure_of_shapes(table)]
    off = {name: largest(ball_rows(table, samples, "smooth")["off_ideal_mean_deg"])
           for name, samples in (("unrounded", "float32"), ("dequantized", "uint8 dequantized"), ("raw", "uint8"))}
    return Result(table, shown, claims, PAGE.text(steps=steps, **off), summary_of(table))
