"""tools: does any point of a tool go through? Rigid tools in six degrees of freedom, with a penalty method beside the exact one."""

import itertools
import math
import time

import numpy
import palpate
import scipy.optimize
from scipy.spatial.transform import Rotation

from . import figures
from .bodies import around, unit
from .experiment import GRANTED, Page, Result, Table, in_parallel, largest
from .subjects import cube

PAGE = Page(__name__)
WALL = 14.0  # [mm] radius of the shell
LEAST = 100  # ticks of a hand in the shell, so that it gets to the wall
MOST_JUDGED, CHUNK = 60, 400_000  # chords per pose, and at once
PLACES, FINEST = 8, 1e-4  # on a chord: where it is looked at first, and the last step as a part of it
STRAIGHT = Rotation.from_quat([0, 0, 0, 1])


def sampled(name, size, density, isovalue):
    """On the smooth field, of a function of physical space."""
    at = numpy.arange(size) - 0.5 * (size - 1)
    z, y, x = numpy.meshgrid(at, at, at, indexing="ij")
    return cube(name, density(x, y, z).astype(numpy.float32), isovalue, "cubic")


def hostile_scenes(seed):
    """White noise, grains of salt, and a ball's shell, 1.5 voxels thick."""
    noise = numpy.random.default_rng([seed, 0]).uniform(0, 1, (32, 32, 32))
    salt = 255 * (numpy.random.default_rng([seed, 1]).uniform(0, 1, (32, 32, 32)) < 0.02)
    yield sampled("noise", 32, lambda x, y, z: noise, 0.55)
    yield sampled("salt", 32, lambda x, y, z: salt, 60)
    yield sampled("shell", 40, lambda x, y, z: 1.5 - abs(numpy.sqrt(x * x + y * y + z * z) - WALL), 0.75)



def tools_of():
    """(name, tool): points half a voxel apart. A cube with n points along its edges has 6 (n - 1)^2 + 2."""
    yield "point", palpate.Tool([[0.0, 0, 0]], turns=False)
    yield "rod", palpate.Tool.named("rod:4.5", 0.5)
    for points in (100, 1000):
        edge = 0.5 * round(((points - 2) / 6)**0.5)
        yield "cube", palpate.Tool.named(f"box:{edge},{edge},{edge}", 0.5)
    yield "scalpel", palpate.Tool.named("box:16,3.5,0.4", 0.5)


# Tools at rest: stiffness 1 N/mm, rotational stiffness the gyration squared, so that the force is the way from hand to proxy, and the
# torque the rotation between them times the gyration squared.

def at_rest(name, parameter, scene, tool, position, turn, force, torque):
    """A row: force [N] and torque [N mm] of a tool that is pressed down, until it rests, beside those of the closed form."""
    for most in (4, 200):  # updates; nearly always four are enough
        hands = numpy.tile(numpy.asarray(position, dtype=float), (most + 1, 1))
        hands[0, 2] += 25
        path = palpate.follow_tool(scene.field, scene.isovalue, tool, hands, numpy.tile(turn.as_quat(), (most + 1, 1)))
        if not path["unfinished"][1:].all():
            break
    done = int(numpy.append(numpy.flatnonzero(~path["unfinished"][1:]) + 1, most)[0])
    found_force = path["position"][done] - position
    found_torque = tool.gyration**2 * (Rotation.from_quat(path["orientation_xyzw"][done]) * turn.inv()).as_rotvec()
    size = numpy.linalg.norm
    off = size(found_torque - torque)
    return {"part": "equilibrium", "scene": name, "parameter": parameter, "contacts": int(path["contacts"][done]),
            "force_n": size(found_force), "closed_form_n": size(force), "force_off_share": size(found_force - force) / size(force),
            "torque_nmm": size(found_torque), "closed_form_nmm": size(torque),
            "torque_off_share": off / size(torque) if size(torque) > 0 else off}


def boxes(plane):
    """A box pressed onto a plane, tilted and twisted: it lies flat, the rest of the rotation is felt. Flat orientations turn about z; the
    nearest has the same twist."""
    box = palpate.Tool.named("box:6,4,2", 0.5)
    for tilt in (0.02, 0.04, 0.06, 0.08):
        turn = Rotation.from_rotvec([0, 0, 8 * tilt]) * Rotation.from_rotvec([tilt, -0.7 * tilt, 0])
        _, _, z, w = turn.as_quat()
        level = Rotation.from_rotvec([0, 0, 2 * numpy.arctan2(z, w)])
        yield at_rest("box on a plane", tilt, plane, box, [0, 0, -1.0], turn, numpy.array([0, 0, 2.0]),
                      box.gyration**2 * (level * turn.inv()).as_rotvec())


def levers(plane):
    """A rod whose one end is on the plane, its middle pressed down and turned: k h = N, h = l / 2 sin(a), and
    k_r (turn - a) = N l / 2 cos(a)."""
    half, gyration = 4.0, 4.0
    rod = palpate.Tool(half * numpy.outer(numpy.arange(-16, 17) / 16, [1, 0, 0]), gyration)
    for turn in 0.1 * numpy.arange(1, 9):
        angle = scipy.optimize.brentq(lambda a: half**2 * numpy.sin(a) * numpy.cos(a) - gyration**2 * (turn - a), 0, turn, xtol=1e-16)
        yield at_rest("rod on its end", turn, plane, rod, [0, 0, 0], Rotation.from_rotvec([0, turn, 0]),
                      numpy.array([0, 0, half * numpy.sin(angle)]), gyration**2 * numpy.array([0, angle - turn, 0]))


def spheres():
    """A ball pressed onto a ball, whose density falls with the square of the distance, so that the smooth field's surface is a ball, too:
    the force goes through both middles. Between points a ball sinks by at most the parameter."""
    scene = sampled("ball", 40, lambda x, y, z: -(x * x + y * y + z * z), -144)
    bottom = palpate.cast_rays(scene.field, scene.isovalue, [[0, 0, 16.0]], [[0, 0, 8.0]])[0][0, 2]
    radius, spacing, depth = 3, 0.15, 2
    tool = palpate.Tool.named(f"sphere:{radius}", spacing)
    for angle in 0.2 * numpy.arange(5):
        out = unit(numpy.array([numpy.sin(angle), 0.3 * numpy.sin(angle), numpy.cos(angle)]))
        yield at_rest("ball on a ball", 0.5 * spacing**2 * (1 / radius + 1 / bottom), scene, tool, (bottom + radius - depth) * out,
                      STRAIGHT, depth * out, numpy.zeros(3))


# The judge, by values of the field alone.

def steepest(field):
    """[range per mm] A bound of the smooth field's slope: twice what neighbouring samples differ by."""
    samples = numpy.pad(field.volume.array.astype(float), 1, constant_values=field.background)
    differences = [abs(numpy.diff(samples, axis=axis)).max() for axis in range(3)]
    return 2 * float(numpy.linalg.norm(differences)) / field.range / min(field.geometry.spacing)


def greatest_on_chords(scene, starts, ends):
    """[range] The greatest excess on any of the chords: at both ends, at places between them, and refined around the greatest of these.
    Chords are left out as soon as their excess cannot reach above what is known already."""
    along, ends_excess = ends - starts, numpy.stack([scene.excess_at(starts), scene.excess_at(ends)])
    rise = steepest(scene.field) * numpy.linalg.norm(along, axis=1)
    known = ends_excess.max(initial=-numpy.inf)
    open_ = ends_excess.max(axis=0) + 0.5 * rise > known
    starts, along, rise = starts[open_], along[open_], rise[open_]
    parts = numpy.arange(PLACES + 1) / PLACES
    excess = scene.excess_at((starts[:, None] + parts[:, None] * along[:, None]).reshape(-1, 3)).reshape(-1, len(parts))
    best, most, step = parts[excess.argmax(axis=1)], excess.max(axis=1), 0.5 / PLACES
    while True:
        known = max(known, most.max(initial=-numpy.inf))
        open_ = most + 2 * step * rise > known  # the steps that are left are less than 2 * step together
        if step <= FINEST or not open_.any():
            return float(known)
        starts, along, rise, best, most = starts[open_], along[open_], rise[open_], best[open_], most[open_]
        middle = best
        for side in (-step, step):
            part = middle + side
            here = numpy.where((part >= 0) & (part <= 1), scene.excess_at(starts + part[:, None] * along), -numpy.inf)
            best, most = numpy.where(here > most, part, best), numpy.maximum(most, here)
        step *= 0.5


def chords_of(tool, path, poses, step):
    """(starts, ends) of the ways of points, (n, 3) each, to some poses from those before them: every so many points, others at each
    pose."""
    points, tick = tool.points, path["pose_tick"]
    chosen = [numpy.arange(pose % step, len(points), step) for pose in poses]
    row, which = numpy.repeat(poses, [len(part) for part in chosen]), numpy.concatenate(chosen)
    first = tick[row] != tick[row - 1]  # begins where the update before it ended
    before = [numpy.where(first[:, None], path[name][tick[row] - 1], path[f"pose_{name}"][row - 1])
              for name in ("position", "orientation_xyzw")]

    return tuple(position + Rotation.from_quat(orientation).apply(points[which])
                 for position, orientation in (before, (path["pose_position"][row], path["pose_orientation_xyzw"][row])))


def judge(scene, tool, path):
    """(chords, [range] the greatest excess on them), in parts that fit into memory. Not while the tool is brought out of the solid, and
    not where it is placed."""
    step, tick = 1 + (len(tool.points) - 1) // MOST_JUDGED, path["pose_tick"]
    poses = numpy.flatnonzero((tick > 0) & ~path["recovering"][tick - 1])

    def of(part):
        chords = chords_of(tool, path, part, step)
        return len(chords[0]), greatest_on_chords(scene, *chords)

    parts = numpy.array_split(poses, 1 + len(poses) * MOST_JUDGED // CHUNK) if len(poses) else []
    counts, worst = numpy.array([(0, -1), *in_parallel(of, parts)]).T
    return int(counts.sum()), worst.max()


def growth(tool, path, hands, turns):
    """[mm] How much farther each hand is from the proxy than it was from the proxy before."""
    before, after = (numpy.hypot(numpy.linalg.norm(hands[1:] - path["position"][part], axis=1), tool.gyration * (
        (turns[1:] * Rotation.from_quat(path["orientation_xyzw"][part]).inv()).magnitude() if tool.turns else 0))
        for part in (slice(-1), slice(1, None)))
    return after - before


def followed(scene, tool, hands, turns, method="exact"):
    """(path, verdict) of a tool that starts at the first hand, in free space. The verdict has only the mean time of an update [us]."""
    begun = time.perf_counter()
    path = palpate.follow_tool(scene.field, scene.isovalue, tool, hands, turns.as_quat(), method)
    return path, {"update_mean_us": 1e6 * (time.perf_counter() - begun) / len(hands)}


def judged(scene, tool, hands, turns):
    """The same with a verdict on all chords."""
    path, taken = followed(scene, tool, hands, turns)
    chords, worst = judge(scene, tool, path)
    return path, {**taken, "chords": chords, "worst_excess_of_range": worst,
                  "worst_growth_voxel": largest(growth(tool, path, hands, turns)[~path["recovering"][:-1]]),
                  "unfinished_share": path["unfinished"][1:].mean(), **{f"{name}_{what}": of(path[name][1:]) for name in ("rounds", "work")
                                                                        for what, of in (("mean", numpy.mean), ("most", numpy.max))}}


# A peg with a quarter of a voxel around it goes into its hole, is wiggled there, and comes out.

def fit(quick):
    """The hole is along z, of 5 mm radius, up to z = 8. The peg has rings of points half a voxel apart."""
    scene = sampled("hole", 48, lambda x, y, z: numpy.minimum(numpy.hypot(x, y) - 5, 8 - z), 0)
    radius, z = 4.75, numpy.arange(-5, 5 + 1e-9, 0.5)
    count, ticks = int(numpy.ceil(2 * numpy.pi * radius / 0.5)), 150 if quick else 3000
    ring = radius * around(2 * numpy.pi * numpy.arange(count) / count)
    tool = palpate.Tool(numpy.column_stack([numpy.tile(ring, (len(z), 1)), numpy.repeat(z, count)]))
    i = numpy.arange(3 * ticks + 1)
    t, phase = i / ticks, 0.02 * i
    depth = numpy.where(t < 1, t, numpy.where(t < 2, 1, 3 - t))
    wiggle = numpy.where((t > 1) & (t < 2), 1, 0.1)
    hands = numpy.stack([wiggle * numpy.sin(phase), wiggle * numpy.sin(1.3 * phase), 20 - 24 * depth], axis=1)
    turns = Rotation.from_rotvec(0.2 * wiggle[:, None] * numpy.stack(
        [numpy.sin(1.7 * phase), numpy.cos(phase), numpy.full(len(i), 0.5)], axis=1))
    hands, turns = numpy.concatenate([[[0, 0, 20.0]], hands]), Rotation.concatenate([STRAIGHT, turns])
    path, verdict = judged(scene, tool, hands, turns)
    return {"part": "fit", "scene": "peg in a hole", "points": len(tool.points), "ticks": 3 * ticks,
            "lowest_mm": path["position"][1:, 2].min(), "end_mm": path["position"][-1, 2],
            **{name: verdict[name] for name in ("chords", "worst_excess_of_range", "unfinished_share", "rounds_most")}}


# Wild hands: up to 3 voxels and 0.02 rad per tick (3 m/s and 20 rad/s at 1 kHz), now slowly, now fast, within a ball.

def direction(random):
    z, angle = random.uniform(-1, 1), random.uniform(0, 2 * math.pi)
    across = math.sqrt(1 - z * z)
    return numpy.array([across * math.cos(angle), across * math.sin(angle), z])


def wild_hand(random, ticks, radius, start):
    """(positions, turns), from a place in free space."""
    place, way, spin = numpy.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1]])
    x, y, z, w = turn = STRAIGHT.as_quat()
    left, positions, turns = 0, [start], [turn]
    for _ in range(ticks):
        left -= 1
        if left <= 0:
            left = 20 + int(100 * random.uniform())
            speed = 3 if random.uniform() < 0.3 else 0.3 * random.uniform()
            turning = 0.02 if random.uniform() < 0.3 else 0.004 * random.uniform()
        way, spin = unit(way + 0.2 * direction(random)), unit(spin + 0.3 * direction(random))
        if numpy.linalg.norm(place) > radius:
            way = -unit(place)
        place = place + speed * way
        (a, b, c), d = math.sin(0.5 * turning) * spin, math.cos(0.5 * turning)
        x, y, z, w = (d * x + a * w + b * z - c * y, d * y - a * z + b * w + c * x, d * z + a * y - b * x + c * w,
                      d * w - a * x - b * y - c * z)
        positions.append(place)
        turns.append((x, y, z, w))
    return numpy.array(positions), Rotation.from_quat(turns)


def points_at(tool, path, ticks):
    """[mm, physical] Of all points of a tool in some ticks, (ticks, points, 3), in parts that fit into memory."""
    for part in numpy.array_split(ticks, 1 + len(ticks) * len(tool.points) // 1_000_000):
        turn = Rotation.from_quat(path["orientation_xyzw"][part]).as_matrix()
        yield numpy.einsum("tij,pj->tpi", turn, tool.points) + path["position"][part][:, None]


def deepest_of(scene, points):
    """[voxel] How deep the deepest point is, by the field's slope, at most 10."""
    excess = scene.field.value(points) - scene.isovalue
    points, excess = points[excess > 0], excess[excess > 0]
    slope = numpy.linalg.norm(scene.field.gradient(points), axis=1) if len(points) else excess
    return numpy.minimum(excess / numpy.maximum(slope, 1e-9), 10).max(initial=0)


def verdict_of(scene, method, tool, hand, turn):
    """On one hand. through: with a point beyond the wall of the shell, whose depths are those beyond its inner side."""
    path, found = judged(scene, tool, hand, turn) if method == "exact" else followed(scene, tool, hand, turn, method)
    ticks, every = numpy.arange(1, len(hand)), 64 if method == "exact" else 1  # whose depths are looked at
    if scene.name == "shell":
        far = numpy.concatenate([numpy.linalg.norm(points, axis=2).max(axis=1) for points in points_at(tool, path, ticks)])
        through, deepest = (far > WALL).mean(), max(0.0, far[::every].max() - (WALL - 0.75))
    else:
        through, deepest = 0.0, max(deepest_of(scene, points.reshape(-1, 3)) for points in points_at(tool, path, ticks[::every]))
    return {"ticks": len(ticks), "touching_share": (path["contacts"][1:] > 0).mean(), "through_share": through, "deepest_voxel": deepest,
            **found}


def hostile_row(scene, method, name, tool, hands, counts):
    """One row for the hands of all seeds. counts: ticks of each hand that the method gets."""
    found = Table(verdict_of(scene, method, tool, positions[:count + 1], turns[:count + 1])
                  for (positions, turns), count in zip(hands, counts))

    def of_all(column):
        if column in ("ticks", "chords"):
            return found[column].sum()
        is_mean = column.endswith(("share", "mean", "mean_us"))
        return numpy.average(found[column], weights=counts) if is_mean else found[column].max()

    return {"part": "hostile", "scene": scene.name, "method": method, "tool": name, "points": len(tool.points),
            **{column: of_all(column) for column in found.columns}}


def counts_of(scene, ticks, seeds):
    """Ticks of each hand. A hand without ticks is left out."""
    counts = [len(range(part, ticks, seeds)) for part in range(seeds)]
    return [max(LEAST, count) for count in counts] if scene.name == "shell" else [count for count in counts if count]


def hostile(options):
    ticks, penalty_ticks = (30, 30) if options.quick else (100_000, 10_000)
    hands = {}
    for scene, (name, tool) in options.each(itertools.product(hostile_scenes(options.seed), tools_of()), 0.05):
        if scene.name not in hands:
            start, radius = ((0.0, 0, 0), 2 * WALL) if scene.name == "shell" else ((0.0, 0, 40), 24)  # the shell is around the tool
            hands[scene.name] = [wild_hand(numpy.random.default_rng([options.seed, 2 + part]), count, radius, start)
                                 for part, count in enumerate(counts_of(scene, ticks, options.seeds))]
        for method, wanted in (("exact", ticks), ("penalty", penalty_ticks)):
            yield hostile_row(scene, method, name, tool, hands[scene.name], counts_of(scene, wanted, options.seeds))


def summary_of(table):
    for row in table.where(part="hostile", method="exact"):
        penalty = table.where(part="hostile", method="penalty", scene=row["scene"], tool=row["tool"], points=row["points"])[0]
        yield {"scene": row["scene"], "tool": row["tool"], "points": row["points"], "rounds, mean": row["rounds_mean"],
               "update, mean, exact [µs]": row["update_mean_us"], "update, mean, penalty [µs]": penalty["update_mean_us"],
               "goes on in the next tick [%]": 100 * row["unfinished_share"],
               "deepest point, exact [range]": max(0.0, row["worst_excess_of_range"]),
               "deepest point, penalty [voxel]": penalty["deepest_voxel"],
               "ticks beyond the shell, penalty [%]": 100 * penalty["through_share"] if row["scene"] == "shell" else numpy.nan}


def hostile_figure(table):
    drawn, panels = figures.panels(columns=3, height=2.5, sharey=True,
                                   title="The exact method keeps every point outside; a penalty does not")
    for axes, name in zip(panels, ("noise", "salt", "shell")):
        hostile = Table(sorted(table.where(part="hostile", scene=name), key=lambda row: row["points"]))
        for (method, rows), colour, marker in zip(hostile.by("method"), (figures.BLUE, figures.VERMILION), "o^"):
            axes.plot(rows["points"], rows["deepest_voxel"], color=colour, marker=marker, label=method)
        axes.set(title=name, xscale="log", xlabel="points of the tool")
    panels[0].set_ylabel("deepest point [voxel]")
    figures.label_ends(panels[2])
    return PAGE.figure(drawn)


def lever_figure(table):
    rows = table.where(part="equilibrium", scene="rod on its end")
    drawn, axes = figures.panels(height=2.5)
    axes.plot(rows["parameter"], rows["closed_form_nmm"], color="#c0c0c0", lw=5)
    axes.plot(rows["parameter"], rows["torque_nmm"], "o", mfc="none", color=figures.VERMILION)
    axes.text(0.55, rows["torque_nmm"][-1] * 0.45, "closed form (grey)\nrendered (circles)", fontsize=7.5)
    axes.set(title="the torque of a lever is that of the closed form", xlabel="turn of the hand [rad]", ylabel="torque [N mm]",
             xlim=(0, None), ylim=(0, None))
    return PAGE.figure(drawn, "lever")


def claims_of(table):
    rest, fitted = table.where(part="equilibrium"), table.where(part="fit")[0]
    exact = table.where(part="hostile", method="exact")
    force, torque = largest(rest["force_off_share"]), largest(rest["torque_off_share"])
    excess, shell = exact["worst_excess_of_range"].max(), exact.where(scene="shell")
    gone, touching = int((shell["through_share"] @ shell["ticks"]).round()), shell["touching_share"]
    yield PAGE.claim("rest", force <= 0.01 and torque <= 0.01, force=100 * force, torque=100 * torque)
    yield PAGE.claim("fit", fitted["lowest_mm"] < -3.5 and fitted["end_mm"] > 19 and fitted["worst_excess_of_range"] <= GRANTED, **fitted)
    yield PAGE.claim("solid", excess <= GRANTED, excess=excess, chords=int(exact["chords"].sum()))
    yield PAGE.claim("shell", gone == 0 and touching.all(), gone=gone, ticks=int(shell["ticks"].sum()), touching=100 * touching.min())
    yield PAGE.at_most(1e-10, exact["worst_growth_voxel"], "growth")


def text_of(table, seeds):
    fitted = table.where(part="fit")[0]
    exact, penalty = (table.where(part="hostile", method=method) for method in ("exact", "penalty"))
    return PAGE.text(deeper=largest(table.where(scene="ball on a ball")["parameter"]), fitted=fitted, seeds=seeds,
                     fit_unfinished=100 * fitted["unfinished_share"], points=largest(exact["points"]), ticks=largest(exact["ticks"]),
                     unfinished=100 * largest(exact["unfinished_share"]), penalty_ticks=largest(penalty["ticks"]),
                     through=100 * largest(penalty["through_share"]), deepest=largest(penalty["deepest_voxel"]))


def run(options):
    options.refuse_volumes("tools has scenes")
    plane = sampled("plane", 40, lambda x, y, z: -z, 0)
    table = Table([*boxes(plane), *levers(plane), *spheres(), fit(options.quick), *hostile(options)])
    return Result(table, [hostile_figure(table), lever_figure(table)], claims_of(table), text_of(table, options.seeds), summary_of(table))
