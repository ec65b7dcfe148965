"""walk-through: how does a proxy move in an update, step by step? (Corenthy et al. 2012, Fig. 5 and 6)"""

import collections
import dataclasses
import itertools

import numpy
import palpate

from . import figures
from .experiment import GRANTED, DoesNotApply, Figure, Page, Result, Table
from .subjects import CONTESTANTS, GUARDED, linear

PAGE = Page(__name__)
SLICES = 3  # the middle one is shown
CROSS, GOAL = (palpate.STEP_KINDS.index(kind) for kind in ("cross", "goal"))  # the other kinds move the SCP


Cut = collections.namedtuple("Cut", "subject z low high start hip_before hip")  # its plane [mm], samples that are shown, hands [mm]


def extruded(samples, dx, dy):
    """A volume of equal slices from samples [y, x]."""
    return palpate.Volume(numpy.repeat(numpy.asarray(samples, dtype=numpy.float32)[None], SLICES, axis=0), spacing=(dx, dy, min(dx, dy)))


def wall_cut():
    """A plateau, a slope, a floor and a wall of one sample's thickness on it."""
    ground = numpy.array([4.35, 4.3, 4.2, 3.95, 2.7, 1.75, 1.45, 1.3, 0, 1.4, 1.5])
    rows = numpy.arange(7)[:, None]
    samples = numpy.floor(numpy.clip(50 + 22 * (ground - rows), 0, 100) + 0.5)
    samples[:, 8] = numpy.where(rows[:, 0] <= 5, 96, 20)
    subject = linear("wall", extruded(samples, 1, 1), 50)
    return Cut(subject, 1, (0, 0), (10, 6), *map(numpy.array, ([0.6, 5.8, 1], [0.7, 3.7, 1], [7.7, 0.3, 1])))


def contact_in(subject, z):
    """(place, normal) where a ray along a row of the plane first meets the surface within the data; rows from the middle outwards."""
    geometry = subject.field.geometry
    height, width = int(geometry.size[1]), geometry.size[0] * geometry.spacing[0]
    rows = sorted(range(height), key=lambda row: (abs(row - height // 2), -row))
    # Off the samples, where a ray would run in the walls of the lattice.
    y = (numpy.array(rows) + 0.3) * geometry.spacing[1]
    ends = [numpy.stack([numpy.full(len(y), x), y, numpy.full(len(y), z)], axis=1) for x in (-width, 2 * width)]
    points, normals = palpate.cast_rays(subject.field, subject.isovalue, *ends)
    met = numpy.flatnonzero(points[:, 0] > 0)  # not where the border of the data closes a body
    if not len(met):
        raise DoesNotApply(f"{subject.name}: no row of its middle slice meets the surface within the data; choose another level or volume")
    return points[met[0]], normals[met[0]]


def slice_of(subject):
    """The middle slice of a volume, around the first contact of a ray along its rows."""
    field, size = subject.field, subject.field.geometry.size
    volume = extruded(field.volume.array[size[2] // 2], *field.geometry.spacing[:2])
    flat = dataclasses.replace(subject, field=palpate.Field(volume, field.solid, field.background, "linear"), exact=None)
    voxel = numpy.asarray(flat.field.geometry.spacing)
    z, unit = float(voxel[2]), voxel.min()
    point, normal = contact_in(flat, z)
    normal = numpy.array([normal[0], normal[1], 0]) / numpy.hypot(normal[0], normal[1])
    along = numpy.array([-normal[1], normal[0], 0])
    middle = numpy.round((point + 2 * unit * along) / voxel).astype(int)
    low = [min(max(middle[a] - half, 0), max(0, size[a] - 1 - 2 * half)) for a, half in ((0, 5), (1, 4))]
    high = [min(size[a] - 1, low[a] + 2 * half) for a, half in ((0, 5), (1, 4))]
    return Cut(flat, z, tuple(low), tuple(high), point - 0.01 * unit * numpy.array([1, 0, 0]), point - 0.4 * unit * normal,
               point + unit * (4 * along - 1.5 * normal))


class Walk:
    """What a contestant did in the update."""

    def __init__(self, cut, name):
        self.name, self.felt = name, CONTESTANTS[name].felt(cut.subject)
        proxy = CONTESTANTS[name].proxy(cut.subject, cut.start)
        self.before = proxy.follow([cut.hip_before]).scp[0]
        trace = proxy.follow([cut.hip], steps=True)
        self.steps, self.end, self.tetrahedra = trace.steps, trace.scp[0], int(trace.tetrahedra[0])
        self.path = numpy.concatenate([[self.before], self.steps["point"]])
        self.moved = self.steps["point"][~numpy.isin(self.steps["kind"], (CROSS, GOAL))]


    def excess_at_end(self):
        return float(self.felt.excess_at([self.end])[0])


def rows_of(cut, walk):
    steps = [("before", walk.before, cut.hip_before, "")]
    for kind, point, goal, cell, axis, sign in zip(*(walk.steps[name] for name in ("kind", "point", "goal", "cell", "axis", "sign"))):
        face, edge = ("+-"[int(sign[k] < 0)] + "xyz"[int(axis[k])] for k in (0, 1))
        steps.append((palpate.STEP_KINDS[kind], point, goal, "cell {} {} {}, face {}, edge {}".format(*map(int, cell), face, edge)))
    for number, (kind, scp, goal, tetrahedron) in enumerate(steps):
        yield {"volume": cut.subject.name, "method": walk.name, "step": number, "kind": kind, "scp_x_mm": scp[0], "scp_y_mm": scp[1],
               "goal_x_mm": goal[0], "goal_y_mm": goal[1], "density": walk.felt.field.value([scp])[0], "isovalue": cut.subject.isovalue,
               "tetrahedron": tetrahedron, "distance_to_hip_mm": float(numpy.linalg.norm(scp - cut.hip))}


def summary_of(cut, walks):
    for walk in walks.values():
        yield {"volume": cut.subject.name, "method": walk.name, "moves": len(walk.moved), "tetrahedra": walk.tetrahedra,
               "distance to the hand [mm]": float(numpy.linalg.norm(walk.end - cut.hip)),
               "excess at the end [part of the range]": f"{walk.excess_at_end():.2g}"}


def draw_field(axes, cut, felt):
    """The lattice, the solid and the isosurface in the cut, and the samples with their densities."""
    dx, dy = felt.field.geometry.spacing[:2]
    smooth = felt.field.interpolation == "cubic"
    begin = -0.5 if smooth else 0  # of a square, from its first sample
    # Around each square and along both its diagonals, in one line, which NaN breaks before the next square.
    corners = numpy.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0), (1, 1), (numpy.nan, 0), (1, 0), (0, 1), (numpy.nan, 0)])
    samples = list(itertools.product(*(range(cut.low[axis], cut.high[axis] + 1) for axis in (0, 1))))
    squares = [(i, j) for i, j in samples if smooth or (i < cut.high[0] and j < cut.high[1])]
    lattice = ((numpy.array(squares)[:, None] + begin + corners) * (dx, dy)).reshape(-1, 2)
    axes.plot(*lattice.T, color="#d0d0d0", lw=0.5)
    # Sixteen points per sample; the linear field's kinks are on them, the smooth field bends little between.
    x, y = (numpy.linspace(low - 0.5, high + 0.5, 16 * (high - low + 1) + 1) * step for low, high, step in zip(cut.low, cut.high, (dx, dy)))
    grid = numpy.stack([*numpy.meshgrid(x, y), numpy.full((len(y), len(x)), cut.z)], axis=-1)
    excess = felt.excess_at(grid.reshape(-1, 3)).reshape(len(y), len(x))
    axes.contourf(x, y, excess, [0, numpy.inf], colors=["#dbe9f6"])
    axes.contour(x, y, excess, [0], colors=[figures.BLUE], linewidths=1.8)
    at = numpy.array([(i * dx, j * dy, cut.z) for i, j in samples])
    axes.plot(at[:, 0], at[:, 1], ".", color=figures.GREY, ms=2)
    for place, density in zip(at, felt.field.value(at)):
        axes.annotate(f"{density:.3g}", place[:2], (2, -6), textcoords="offset points", fontsize=5, color=figures.GREY)


def draw_walk(axes, cut, walk):
    """The path, the walls crossed, GOALs that are not the hand, and the SCP after each move with its number."""
    axes.plot(walk.path[:, 0], walk.path[:, 1], color=figures.VERMILION, lw=1.6)
    crossed = walk.steps["point"][walk.steps["kind"] == CROSS]
    axes.plot(crossed[:, 0], crossed[:, 1], ".", color=figures.VERMILION, ms=3)
    goals = walk.steps["goal"][walk.steps["kind"] == GOAL]
    goals = goals[numpy.linalg.norm(goals - cut.hip, axis=1) > 1e-9]
    axes.plot(goals[:, 0], goals[:, 1], "D", color=figures.GREEN, ms=4, mfc="none")
    numbered = {}  # numbers of moves that end at the same place
    for number, scp in enumerate([walk.before, *walk.moved]):
        near = next((at for at in numbered if numpy.hypot(at[0] - scp[0], at[1] - scp[1]) < 0.6 * cut.subject.voxel), None)
        numbered.setdefault(near or tuple(scp[:2]), []).append(number)
    for place, numbers in numbered.items():
        axes.plot(*place, "o", color=figures.VERMILION, ms=4)
        axes.annotate(str(numbers[0]) if len(numbers) == 1 else f"{numbers[0]}-{numbers[-1]}", place, (5, 5), textcoords="offset points",
                      fontsize=7, color="#8a3c00", bbox={"boxstyle": "square,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.7})
    for hip, name in ((cut.hip_before, "hand before"), (cut.hip, "hand")):
        axes.plot(*hip[:2], "x", color=figures.BLACK, ms=6, mew=2)
        axes.annotate(name, hip[:2], (7, -3), textcoords="offset points", fontsize=7)


def figure_of(cut, walks, suffix):
    x, y = ([(cut.low[a] - 0.6) * step, (cut.high[a] + 0.6) * step] for a, step in enumerate(cut.subject.field.geometry.spacing[:2]))
    height = figures.PAGE / len(walks) * (y[1] - y[0]) / (x[1] - x[0]) + 0.5
    drawn, panels = figures.panels(1, len(walks), height=min(9, height), width=figures.PAGE, squeeze=False)
    for axes, walk in zip(panels[0], walks):
        draw_field(axes, cut, walk.felt)
        draw_walk(axes, cut, walk)
        place = "in the solid" if walk.excess_at_end() > 0.01 else "outside or on the surface"
        axes.set(title=f"{walk.name} ends {place}", xlabel="x [mm]", ylabel="y [mm]" if walk is walks[0] else "", aspect="equal", xlim=x,
                 ylim=y)
        axes.grid(False)
    methods = " and ".join(walk.name for walk in walks)
    return Figure(suffix, *PAGE.text("update", volume=cut.subject.name, methods=methods), drawn)


def claims_of(cut, walks, own_cut):
    name, share = cut.subject.name, numpy.linspace(0, 1, 101)[:, None, None]  # a hundred points of each piece
    for walk in map(walks.get, GUARDED):
        excess = walk.felt.excess_at((walk.path[:-1] + share * numpy.diff(walk.path, axis=0)).reshape(-1, 3))
        yield PAGE.at_most(GRANTED, excess, "outside", volume=name, method=walk.name, steps=len(walk.steps["kind"]))
    yield PAGE.at_most(1e-9, [abs(walk.path[1:, 2] - cut.z).max() for walk in walks.values()], "plane", volume=name)
    if own_cut:
        excess = walks["gradient"].excess_at_end()
        yield PAGE.claim("inside", excess > 0.1, volume=name, excess=excess)


def run(options):
    cuts = [slice_of(subject) for subject in options.subjects] or [wall_cut()]
    result = Result(Table(), [], [], [])
    shown = (options.method, "exact" if options.method == "gradient" else "gradient")
    for number, cut in enumerate(options.each(cuts), 1):
        walks = {name: Walk(cut, name) for name in CONTESTANTS}
        for walk in walks.values():
            result.table.extend(rows_of(cut, walk))
        result.summary.extend(summary_of(cut, walks))
        result.figures += [figure_of(cut, [walks[name] for name in shown], "" if number == 1 else str(number)),
                           figure_of(cut, [walks["smooth"]], "smooth" if number == 1 else f"smooth-{number}")]
        result.claims.extend(claims_of(cut, walks, not options.subjects))
        result.paragraphs += PAGE.text("jump", volume=cut.subject.name, begin=cut.hip_before, end=cut.hip)
    result.paragraphs += PAGE.text()
    return result
