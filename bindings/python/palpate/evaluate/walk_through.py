"""walk-through: how does a proxy move in an update, step by step? (Corenthy et al. 2012, Fig. 5 and 6)

One update in a volume that is the same in every slice. The motion stays in a plane of samples, so the cut
through that plane shows all of it.
"""

import dataclasses

import matplotlib.collections
import numpy
import palpate

from . import figures
from .experiment import GRANTED, Claim, Figure, Result, Table
from .subjects import CONTESTANTS, Subject

TITLE = "How does a proxy move, step by step?"
SLICES = 3  # the middle one is shown
FREE_MOVE, CROSS, GOAL = (palpate.STEP_KINDS.index(kind) for kind in ("free move", "cross", "goal"))


@dataclasses.dataclass
class Cut:
    """z [mm] of the plane; low, high: its samples that are shown; points of the hand [mm]."""

    subject: Subject
    z: float
    low: tuple
    high: tuple
    start: numpy.ndarray
    hip_before: numpy.ndarray
    hip: numpy.ndarray


def extruded(samples, dx, dy):
    """A volume of equal slices from samples [y, x]."""
    return palpate.Volume(numpy.repeat(numpy.asarray(samples, dtype=numpy.float32)[None], SLICES, axis=0),
                          spacing=(dx, dy, min(dx, dy)))


def wall_cut():
    """A plateau, a slope, a floor and a wall of one sample's thickness on it."""
    ground = numpy.array([4.35, 4.3, 4.2, 3.95, 2.7, 1.75, 1.45, 1.3, 0, 1.4, 1.5])
    rows = numpy.arange(7)[:, None]
    samples = numpy.floor(numpy.clip(50 + 22 * (ground - rows), 0, 100) + 0.5)
    samples[:, 8] = numpy.where(rows[:, 0] <= 5, 96, 20)
    subject = Subject("wall", palpate.Field(extruded(samples, 1, 1), interpolation="linear"), 50)
    return Cut(subject, 1, (0, 0), (10, 6), *map(numpy.array, ([0.6, 5.8, 1], [0.7, 3.7, 1], [7.7, 0.3, 1])))


def contact_in(subject, z):
    """Where a ray along a row of the plane first meets the surface within the data; rows from the middle
    outwards."""
    geometry = subject.field.geometry
    height, width = int(geometry.size[1]), geometry.size[0] * geometry.spacing[0]
    rows = [height // 2 + ((i + 1) // 2 if i % 2 else -(i // 2)) for i in range(height)]
    # Off the samples, where a ray would run in the walls of the lattice.
    y = (numpy.array([row for row in rows if 0 <= row < height]) + 0.3) * geometry.spacing[1]
    ends = [numpy.stack([numpy.full(len(y), x), y, numpy.full(len(y), z)], axis=1) for x in (-width, 2 * width)]
    points, normals = palpate.cast_rays(subject.field, subject.isovalue, *ends)
    met = numpy.flatnonzero(points[:, 0] > 0)  # not where the border of the data closes a body
    if not len(met):
        raise ValueError(f"{subject.name}: no row of its middle slice meets the surface within the data; choose "
                         "another level or volume")
    return points[met[0]], normals[met[0]]


def slice_of(subject):
    """The middle slice of a volume, around the first contact of a ray along its rows."""
    field, geometry = subject.field, subject.field.geometry
    volume = extruded(field.volume.array[geometry.size[2] // 2], *geometry.spacing[:2])
    flat = Subject(subject.name, palpate.Field(volume, field.solid, field.background, "linear"), subject.isovalue)
    voxel = numpy.asarray(flat.field.geometry.spacing)
    z = float(voxel[2])
    point, normal = contact_in(flat, z)
    normal = numpy.array([normal[0], normal[1], 0]) / numpy.hypot(normal[0], normal[1])
    along, unit = numpy.array([-normal[1], normal[0], 0]), voxel.min()
    middle = numpy.round((point + 2 * unit * along) / voxel).astype(int)
    low = [min(max(middle[a] - half, 0), max(0, geometry.size[a] - 1 - 2 * half)) for a, half in ((0, 5), (1, 4))]
    high = [min(geometry.size[a] - 1, low[a] + 2 * half) for a, half in ((0, 5), (1, 4))]
    return Cut(flat, z, tuple(low), tuple(high), point - 0.01 * unit * numpy.array([1, 0, 0]),
               point - 0.4 * unit * normal, point + unit * (4 * along - 1.5 * normal))


class Walk:
    """What a contestant did in the update."""

    def __init__(self, cut, name):
        self.name = name
        self.felt = CONTESTANTS[name].felt(cut.subject)
        proxy = palpate.Proxy(self.felt.field, self.felt.isovalue, cut.start, CONTESTANTS[name].method)
        self.before = proxy.follow([cut.hip_before]).scp[0]
        trace = proxy.follow([cut.hip], steps=True)
        self.steps, self.end, self.tetrahedra = trace.steps, trace.scp[0], int(trace.tetrahedra[0])

    @property
    def path(self):
        return numpy.concatenate([[self.before], self.steps["point"]])

    @property
    def moves(self):
        return int(numpy.count_nonzero(~numpy.isin(self.steps["kind"], (CROSS, GOAL))))

    def worst(self):
        """The largest excess on the path: a hundred points of each piece."""
        share = numpy.linspace(0, 1, 101)[:, None, None]
        points = (self.path[:-1] + share * numpy.diff(self.path, axis=0)).reshape(-1, 3)
        return float(self.felt.excess(self.felt.field.value(points)).max())

    def excess_at_end(self):
        return float(self.felt.excess(self.felt.field.value([self.end]))[0])


def rows_of(cut, walk):
    def row(number, kind, scp, goal, tetrahedron):
        return {"volume": cut.subject.name, "method": walk.name, "step": number, "kind": kind,
                "scp_x_mm": scp[0], "scp_y_mm": scp[1], "goal_x_mm": goal[0], "goal_y_mm": goal[1],
                "density": walk.felt.field.value([scp])[0], "isovalue": cut.subject.isovalue,
                "tetrahedron": tetrahedron, "distance_to_hip_mm": float(numpy.linalg.norm(scp - cut.hip))}

    yield row(0, "before", walk.before, cut.hip_before, "")
    steps = walk.steps
    for i, kind in enumerate(steps["kind"]):
        cell, axis, sign = (steps[name][i].astype(int) for name in ("cell", "axis", "sign"))
        side = ["+-"[int(sign[k] < 0)] + "xyz"[axis[k]] for k in (0, 1)]
        yield row(i + 1, palpate.STEP_KINDS[kind], steps["point"][i], steps["goal"][i],
                  f"cell {cell[0]} {cell[1]} {cell[2]}, face {side[0]}, edge {side[1]}")


def claims_of(cut, walks, own_cut):
    name = cut.subject.name
    for walk in walks.values():
        if walk.name in ("exact", "paper", "smooth"):
            worst = walk.worst()
            yield Claim(f"{name}: every SCP of {walk.name} and the path between them is outside to {GRANTED:g} of "
                        "the data's range", worst <= GRANTED,
                        f"largest excess {worst:.2g} over {len(walk.steps['kind'])} steps")
    off = max(float(abs(walk.path[1:, 2] - cut.z).max()) for walk in walks.values())
    yield Claim(f"{name}: all motion stays in the plane that is shown", off <= 1e-9, f"farthest {off:.2g} mm")
    if own_cut:
        excess = walks["gradient"].excess_at_end()
        yield Claim(f"{name}: gradient ends inside, by more than a tenth of the data's range", excess > 0.1,
                    f"excess {excess:.3g}")


def draw_field(axes, cut, felt):
    """The lattice, the solid and the isosurface in the cut, and the samples with their densities."""
    spacing = numpy.asarray(felt.field.geometry.spacing)
    smooth = felt.field.interpolation == "cubic"
    begin = -0.5 if smooth else 0  # of a square, from its first sample
    lines = []
    for j in range(cut.low[1], cut.high[1] + smooth):
        for i in range(cut.low[0], cut.high[0] + smooth):
            x, y = (i + begin) * spacing[0], (j + begin) * spacing[1]
            dx, dy = spacing[:2]
            lines += [[(x, y), (x + dx, y), (x + dx, y + dy), (x, y + dy), (x, y)],
                      [(x, y), (x + dx, y + dy)], [(x + dx, y), (x, y + dy)]]
    axes.add_collection(matplotlib.collections.LineCollection(lines, colors="#d0d0d0", linewidths=0.5))
    # Eight points per sample; the linear field's kinks are on them, the smooth field bends little between.
    x = numpy.linspace(cut.low[0] - 0.5, cut.high[0] + 0.5, 16 * (cut.high[0] - cut.low[0] + 1) + 1) * spacing[0]
    y = numpy.linspace(cut.low[1] - 0.5, cut.high[1] + 0.5, 16 * (cut.high[1] - cut.low[1] + 1) + 1) * spacing[1]
    grid = numpy.stack([*numpy.meshgrid(x, y), numpy.full((len(y), len(x)), cut.z)], axis=-1)
    excess = felt.excess(felt.field.value(grid.reshape(-1, 3))).reshape(len(y), len(x))
    axes.contourf(x, y, excess, [0, numpy.inf], colors=["#dbe9f6"])
    axes.contour(x, y, excess, [0], colors=[figures.BLUE], linewidths=1.8)
    for j in range(cut.low[1], cut.high[1] + 1):
        for i in range(cut.low[0], cut.high[0] + 1):
            at = numpy.array([i * spacing[0], j * spacing[1], cut.z])
            axes.plot(*at[:2], ".", color=figures.GREY, ms=2)
            axes.annotate(f"{felt.field.value([at])[0]:.3g}", at[:2], (2, -6), textcoords="offset points",
                          fontsize=5, color=figures.GREY)


def draw_walk(axes, cut, walk):
    """The path, the walls crossed, and the SCP after each move with its number."""
    path, kinds = walk.path, walk.steps["kind"]
    axes.plot(path[:, 0], path[:, 1], color=figures.VERMILION, lw=1.6)
    crossed = walk.steps["point"][kinds == CROSS]
    axes.plot(crossed[:, 0], crossed[:, 1], ".", color=figures.VERMILION, ms=3)
    goals = walk.steps["goal"][kinds == GOAL]
    goals = goals[numpy.linalg.norm(goals - cut.hip, axis=1) > 1e-9]
    axes.plot(goals[:, 0], goals[:, 1], "D", color=figures.GREEN, ms=4, mfc="none")
    numbered = {}  # numbers of moves that end at the same place
    scps = numpy.concatenate([[walk.before], walk.steps["point"][~numpy.isin(kinds, (CROSS, GOAL))]])
    voxel = cut.subject.voxel
    for number, scp in enumerate(scps):
        near = next((at for at in numbered if numpy.hypot(at[0] - scp[0], at[1] - scp[1]) < 0.6 * voxel), None)
        numbered.setdefault(near or tuple(scp[:2]), []).append(number)
    for (x, y), numbers in numbered.items():
        text = str(numbers[0]) if len(numbers) == 1 else f"{numbers[0]}-{numbers[-1]}"
        axes.plot(x, y, "o", color=figures.VERMILION, ms=4)
        axes.annotate(text, (x, y), (5, 5), textcoords="offset points", fontsize=7, color="#8a3c00",
                      bbox={"boxstyle": "square,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.7})
    for hip, name in ((cut.hip_before, "hand before"), (cut.hip, "hand")):
        axes.plot(*hip[:2], "x", color=figures.BLACK, ms=6, mew=2)
        axes.annotate(name, hip[:2], (7, -3), textcoords="offset points", fontsize=7)


def figure_of(cut, walks, suffix):
    spacing = numpy.asarray(cut.subject.field.geometry.spacing)
    span = [(cut.high[a] - cut.low[a] + 1.2) * spacing[a] for a in (0, 1)]
    width = figures.PAGE / len(walks)
    drawn, axes = figures.panels(1, len(walks), height=min(9, width * span[1] / span[0] + 0.5), width=figures.PAGE,
                                 squeeze=False)
    for panel, walk in zip(axes[0], walks):
        draw_field(panel, cut, walk.felt)
        draw_walk(panel, cut, walk)
        inside = walk.excess_at_end() > 0.01
        panel.set(title=f"{walk.name} ends {'in the solid' if inside else 'outside or on the surface'}",
                  xlabel="x [mm]", aspect="equal", ylabel="y [mm]" if walk is walks[0] else "",
                  xlim=((cut.low[0] - 0.6) * spacing[0], (cut.high[0] + 0.6) * spacing[0]),
                  ylim=((cut.low[1] - 0.6) * spacing[1], (cut.high[1] + 0.6) * spacing[1]))
        panel.grid(False)
    names = " and ".join(walk.name for walk in walks)
    return Figure(suffix, f"{cut.subject.name}: one update of {names} in a plane cut of the lattice, with the solid in "
                  "blue and the density of each sample. 0 is the SCP before the update, the other numbers are its "
                  "moves. Dots are walls that were crossed, diamonds GOALs that are not the position of the hand.", drawn)


def summary_of(cut, walks):
    for walk in walks.values():
        yield {"volume": cut.subject.name, "method": walk.name, "moves": walk.moves, "tetrahedra": walk.tetrahedra,
               "distance to the hand [mm]": float(numpy.linalg.norm(walk.end - cut.hip)),
               "excess at the end [part of the range]": f"{walk.excess_at_end():.2g}"}


def run(options):
    cuts = [slice_of(subject) for subject in options.subjects] or [wall_cut()]
    result = Result(Table(), [], [], [])
    other = "exact" if options.method == "gradient" else "gradient"
    for number, cut in enumerate(cuts, 1):
        options.progress((number - 1) / len(cuts))
        walks = {name: Walk(cut, name) for name in CONTESTANTS}
        for walk in walks.values():
            result.table.extend(rows_of(cut, walk))
        result.summary.extend(summary_of(cut, walks))
        result.figures += [
            figure_of(cut, [walks[options.method], walks[other]], "" if number == 1 else str(number)),
            figure_of(cut, [walks["smooth"]], "smooth" if number == 1 else f"smooth-{number}")]
        result.claims.extend(claims_of(cut, walks, not options.subjects))
        (x0, y0), (x1, y1) = cut.hip_before[:2], cut.hip[:2]
        result.paragraphs.append(f"{cut.subject.name}: in one update, the hand jumps from ({x0:.2f}, {y0:.2f}) to "
                                 f"({x1:.2f}, {y1:.2f}) mm.")
    result.paragraphs.append(
        "The volume is the same in every slice, so the motion stays in a plane of samples and the cut shows all of it. "
        "Each square between four samples consists of four triangles with a linear density. For the smooth field, the "
        "squares lie around the samples, and the density is a cubic in each triangle. Nothing here is random.")
    return result
