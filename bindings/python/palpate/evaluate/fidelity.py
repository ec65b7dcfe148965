"""fidelity: does the force point in the direction of the true surface?

A hand moves just below surfaces that are known exactly. How much of the force's error comes from the linear pieces, and how much from the
8 bits?
"""

import functools
import itertools

import numpy
import palpate

from . import figures
from .bodies import SAMPLES, ball_by, of_a_user, ripples_by_spiral, torus_by_helix, unit
from .experiment import GRANTED, Claim, Figure, Result, Table, at_most, largest, paragraphs
from .meshes import nearest_points
from .sampling import quantile
from .subjects import CONTESTANTS, GUARDED

TITLE = "How near is the force to the true surface's?"
NEAREST = "nearest point (reference)"  # not a method: where the whole 8-bit isosurface is nearest to the hand
# Measured beside Palpate 3688b00 on 27 November 2026 with this protocol at -O3: CHAI3D 3.3 (commit 7c76b1f2), its voxel object with the
# settings of its isosurface demo and its shaded mesh, and a god object on VTK flying edges and Embree 3. Samples, grid: angle of the force,
# mean and 99th percentile [degrees].
RIVAL, SHADED, EMBREE = "CHAI3D voxel object (measured)", "CHAI3D shaded mesh (measured)", "Embree god object (measured)"
PEERS = {RIVAL: {("uint8", 128): (15, 40), ("uint8", 256): (11, 24), ("uint8", 512): (7.1, 16),
                 ("float32", 128): (15, 40), ("float32", 256): (11, 24)},
         SHADED: {("uint8", 128): (3.1, 10.5), ("uint8", 256): (7.0, 23), ("uint8", 512): (8.9, 22),
                  ("float32", 128): (0.14, 0.25), ("float32", 256): (0.14, 0.25), ("uint8 dequantized", 128): (0.15, 0.28)},
         EMBREE: {("uint8", 128): (7.0, 19), ("uint8", 256): (16, 48), ("float32", 128): (0.48, 0.90),
                  ("float32", 256): (0.24, 0.46), ("uint8 dequantized", 128): (0.49, 0.90)}}


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


def nearest_row(body, count):
    hands = body.hand((numpy.arange(count) + 0.5) / count)
    mesh = palpate.extract(body.subject.field, body.subject.isovalue)
    return row_of(body, NEAREST, count, *errors_of(body, numpy.array(list(nearest_points(mesh, hands))), hands))


def peer_rows(body):
    for name, known in PEERS.items():
        if (body.samples, body.grid) in known:
            middle, p99 = known[body.samples, body.grid]
            yield {"body": "ball", "trajectory": "circle", "grid": body.grid, "samples": body.samples, "method": name, "steps": 20000,
                   "depth_voxel": 0.03 * body.grid, "angle_mean_deg": middle, "angle_p99_deg": p99, "off_ideal_mean_deg": middle,
                   "off_ideal_p99_deg": p99}


def bodies_of(options):
    """Functions that make one body each, because the largest takes half a gigabyte."""
    if options.subjects:
        return [functools.partial(of_a_user, subject) for subject in options.subjects]
    circle, spiral = (functools.partial(ball_by, name) for name in ("circle", "spiral"))
    plan = {circle: (64, 128), torus_by_helix: (40, 80), ripples_by_spiral: (41, 81)} if options.quick else {
        circle: (128, 256, 512), spiral: (128, 256, 512), torus_by_helix: (80, 160, 320), ripples_by_spiral: (41, 81, 161, 321)}
    return [functools.partial(make, grid, samples) for make, grids in plan.items() for grid, samples in itertools.product(grids, SAMPLES)]


def ball_rows(table, samples, method="exact", trajectory="circle"):
    return table.where(body="ball", trajectory=trajectory, samples=samples, method=method)


def summary_of(table):
    for method, samples, *_ in dict.fromkeys((*BALL, *SOURCES)):
        for row in ball_rows(table, samples, method):
            yield {"samples": samples, "method": method, "grid": row["grid"], "mean angle [deg]": row["off_ideal_mean_deg"],
                   "p99 [deg]": row["off_ideal_p99_deg"], "turn per tick, largest [deg]": row.get("turn_max_deg", numpy.nan)}


# Lines of a figure: method, samples, label, colour, marker.
BALL = ((RIVAL, "uint8", "CHAI3D voxel object", figures.BLACK, "s"), (SHADED, "uint8", "CHAI3D shaded mesh", figures.GREY, "s"),
        (EMBREE, "uint8", "Embree", figures.GREEN, "x"), ("exact", "uint8", "exact", figures.BLUE, "o"),
        ("smooth", "uint8", "smooth", figures.PURPLE, "D"))
SOURCES = (("exact", "uint8", "exact, 8 bit", figures.BLUE, "o"), ("exact", "uint8 smoothed", "exact, smoothed", figures.SKY, "v"),
           ("exact", "float32", "exact, not rounded", figures.GREEN, "^"),
           ("smooth", "uint8 dequantized", "smooth, dequantized", figures.ORANGE, "s"),
           ("smooth", "float32", "smooth, not rounded", figures.PURPLE, "D"))


def draw_lines(axes, rows, lines, column, title, label="mean angle [degrees]"):
    for method, samples, name, colour, marker in lines:
        found = rows.where(method=method, samples=samples)
        axes.plot(found["grid"], found[column], color=colour, marker=marker, label=name)
    axes.set(title=title, xscale="log", yscale="log", xlabel="samples along an axis", ylabel=label)
    figures.ticks(axes.xaxis, sorted(rows.distinct("grid")))


def figure_of_ball(table):
    drawn, (left, right) = figures.panels(columns=2, height=2.9)
    rows = table.where(body="ball", trajectory="circle")
    draw_lines(left, rows, BALL, "off_ideal_mean_deg", "no method is good on raw 8-bit samples")
    draw_lines(right, rows, SOURCES, "off_ideal_mean_deg", "the smooth field is, if dequantized")
    figures.label_ends(left, right)
    return Figure("", """A ball, touched 0.03 of its box below the surface along a great circle: the mean angle between the force and that
        of a perfect ball. Left: Palpate on raw 8-bit samples and the peers that were measured with this protocol. Right: where the error
        comes from.""", drawn)


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
    left.set(title="the force turns at facets only on the linear field", xlabel="hand along the circle [degrees]", yscale="log",
             ylabel="turn per tick [degrees]")
    right.set(xlabel="turn per tick [degrees]", ylabel="ticks with no larger turn [%]", xscale="log")
    figures.label_ends(right)
    return Figure("turn", f"""Turn of the force from tick to tick along {arc} degrees of the circle on the ball of {grid} samples, and its
        distribution. The hand moves by {arc / steps:g} degrees per tick, and the force of a perfect ball turns by as much
        (dashed).""", drawn)


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
        left.text(0.5 * samples + 0.25, 0.3 + 0.2 * samples, f"{samples} thick", color=colour, fontsize=7)
    left.set(title="a wall of one sample loses a quarter", xlabel="across the wall [voxel]", ylabel="density")
    draw_lines(right, table.where(body="ball", trajectory="circle"), SOURCES[2::2], "surface_error_mean_voxel",
               "curved surfaces move a little", "distance from the true surface [voxel]")
    figures.label_ends(right)
    return Figure("losses", """Costs of the smooth field. Left: density across walls of one, two and three samples of 1 in 0; the linear
        field (dashed) keeps their height. Right: mean distance of the SCP from the true surface of the ball; the smooth field lies inside a
        convex body by an eighth of its Laplacian.""", drawn)


def figure_of_shapes(table):
    drawn, panels = figures.panels(columns=2, height=2.7)
    for axes, body in zip(panels, ("torus", "marschner-lobb")):
        draw_lines(axes, table.where(body=body), SOURCES, "angle_mean_deg", body)
    figures.label_ends(*panels)
    return Figure("shapes", """Torus, with the hand in its tube on a helix, and Marschner-Lobb ripples, with the hand under them on a
        spiral: mean angle between the force and the true normal at the SCP.""", drawn)


def figure_of_users(table):
    drawn, axes = figures.panels(height=2.8)
    for number, name in enumerate(CONTESTANTS):
        rows = table.where(method=name)
        figures.curve(axes, name, numpy.arange(len(rows)) + 0.1 * (number - 2), rows["turn_p99_deg"], ls="")
    axes.set(title="how much the force turns per tick", ylabel="99th percentile [degrees]")
    figures.ticks(axes.xaxis, range(len(rows)), rows.distinct("body"))
    figures.label_ends(axes)
    return Figure("", "Turn of the force from one tick to the next, 99th percentile.", drawn)


def is_below(table, samples, grid):
    """Whether exact is below the rival in mean and p99, by both angles, on every trajectory."""
    theirs = dict(zip(("mean", "p99"), PEERS[RIVAL]["uint8", grid]))
    rows = [row for trajectory in ("circle", "spiral") for row in ball_rows(table, samples, trajectory=trajectory).where(grid=grid)]
    return all(row[f"{angle}_{what}_deg"] < known for row in rows for angle in ("angle", "off_ideal") for what, known in theirs.items())


def comparison(table, samples, grids):
    """'128 (4.3 against 15, p99 16 against 40), 256 (...)'."""
    return ", ".join("{grid} ({off_ideal_mean_deg:.2g} against {0:g}, p99 {off_ideal_p99_deg:.2g} against {1:g})".format(
        *PEERS[RIVAL]["uint8", grid], **ball_rows(table, samples).where(grid=grid)[0]) for grid in grids)


def converges(table, body):
    """Twice the grid, half the angle: the facets of linear pieces, where nothing is rounded."""
    angles = table.where(body=body, samples="float32", method="exact").only(lambda row: row["trajectory"] != "spiral")["angle_mean_deg"]
    factors = angles[:-1] / angles[1:]
    return Claim(f"{body}, not rounded: the exact method's mean angle falls by at least 1.7 with each doubling of the grid",
                 bool((factors >= 1.7).all()), f"least factor {factors.min():.3g} over {len(factors)} doublings")


def claims_of(table, own_bodies, steps):
    yield at_most(GRANTED, [largest(table.where(method=name)["worst_deviation_of_range"]) for name in GUARDED],
                  f"exact, paper and smooth stay on the sampled isosurface to {GRANTED:g} of the data's range", "largest deviation {:.2g}")
    if not own_bodies:
        return
    yield converges(table, "ball")
    yield converges(table, "torus")
    grids = [grid for grid in (128, 256, 512) if ball_rows(table, "uint8").where(grid=grid)]
    rival = "CHAI3D's voxel object (demo settings, raw samples)"
    yield Claim(f"8-bit ball, grid 128: exact is below {rival} in mean and p99 angle", is_below(table, "uint8", 128),
                comparison(table, "uint8", [128]))
    yield Claim(f"8-bit ball, smoothed once: exact is below {rival} in mean and p99 angle on every grid",
                all(is_below(table, "uint8 smoothed", grid) for grid in grids), comparison(table, "uint8 smoothed", grids))
    for what, samples, column, most in (
            ("the mean angle", "float32", "off_ideal_mean_deg", 0.005),
            ("the mean angle", "uint8 dequantized", "off_ideal_mean_deg", 0.03),
            ("the 99th percentile of the angle", "uint8 dequantized", "off_ideal_p99_deg", 0.1),
            ("the turn of the force in a tick, p99 (the ball's own and 10 %),", "float32", "turn_p99_deg", 1.1 * 360 / steps)):
        rows = ball_rows(table, samples, "smooth").only(lambda row: row["grid"] >= 128)
        yield at_most(most, rows[column], f"ball, {samples}, smooth field: {what} is at most {most:.3g} degrees from grid 128 on")


def run(options):
    steps, table = 1500 if options.quick else 20000, Table()
    for make in options.each(bodies_of(options)):
        body = make()
        table.extend(measured(body, contestant, steps) for contestant in CONTESTANTS.values())
        if not options.subjects and (body.subject.name, body.trajectory) == ("ball", "circle"):
            if body.samples == "uint8":
                table.append(nearest_row(body, 20 if options.quick else 100))
            table.extend(peer_rows(body))
    claims = list(claims_of(table, not options.subjects, steps))
    if options.subjects:
        return Result(table, [figure_of_users(table)], claims, paragraphs("""
            A hand moves around each of the user's volumes, 0.03 of the shortest axis below the surface. Angles are known for volumes with
            an analytic density."""))
    shown = [figure_of_ball(table), figure_of_turn(64 if options.quick else 128), figure_of_losses(table), figure_of_shapes(table)]
    return Result(table, shown, claims, paragraphs(f"""
        A ball of radius 0.35 in a unit box has the density 1/2 + 1.4 (0.35 - r) in 8 bits and is touched at 1/2. A hand moves around it
        0.03 below the surface on a tilted great circle in {steps} steps. The angle is between the force and the direction of a perfect
        force.

        On raw 8-bit samples of less than about 1.4 levels per voxel, the isosurface is a terrace, and a proxy that only moves nearer to the
        hand rests in its dents. There, Palpate loses: at 128 samples to CHAI3D's shaded mesh, at 512 to this mesh and to CHAI3D's voxel
        object. Dequantized samples remove this error.

        The peers were measured on 27 November 2026 beside Palpate 3688b00 with this protocol, at -O3 on a shared virtual machine with two
        processors: CHAI3D 3.3 (commit 7c76b1f2) with the settings of its isosurface demo and with its shaded mesh, and a god object on VTK
        flying edges and Embree 3. Their voxels are 8 bit, and they are not run again here."""), Table(summary_of(table)))
