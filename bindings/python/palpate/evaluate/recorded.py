"""recorded: does each method reproduce the force of a recorded stroke? (Ruffaldi, Morris et al. 2006)"""

import collections
import dataclasses
import itertools
from pathlib import Path
from typing import Callable

import numpy
import palpate
import scipy.spatial

from . import figures, sampling
from .bodies import tilt, unit
from .experiment import Page, Result, Table, largest
from .meshes import nearest_in_triangles
from .human import RATE, Human, press
from .subjects import CONTESTANTS, linear

PAGE = Page(__name__)
STIFFNESS = 0.5  # [N/mm] of the reference rendering, as in the published plane0
CONTACT = 0.05  # [N] from which on a hand touches
PRESS, WALL, FRICTION = 1.5, 10.0, 0.2  # of the modelled hand on the modelled plane [N, N/mm]
BAND = 3  # [voxel] of samples on either side of the surface
SAMPLES = {"float32": numpy.inf, "uint8": 40.0}  # levels per voxel of the ramp, rounded
NEIGHBOURS = 16  # triangles that are looked at for a point
COLUMNS = ("t", "x", "y", "z", "fx", "fy", "fz")


Recording = collections.namedtuple("Recording", "name time position force")  # of a probe [s, mm], and the force on the hand [N]


def read(path):
    """A .traj file: a sample per line, its numbers apart by blanks or commas: t [s], x, y, z [mm], fx, fy, fz [N], an order that is assumed
    (docs/evaluation.md). A comment (#, %) that lists names of columns gives another one. Raises InputError."""
    names, rows = list(COLUMNS), []
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
        words = line.replace(",", " ").split()
        if words and words[0][0] in "#%":
            listed = [word.lower() for word in " ".join(words).strip("#% ").split()]
            names = listed if set(COLUMNS) <= set(listed) else names
        elif words:
            try:
                rows.append([float(words[names.index(name)]) for name in COLUMNS])
            except (ValueError, IndexError) as error:
                raise palpate.InputError(f"{path}, line {number}: {len(COLUMNS)} numbers are needed: {' '.join(COLUMNS)}") from error
    table = numpy.array(rows).reshape(-1, len(COLUMNS))
    if len(table) < 2 or not numpy.isfinite(table).all() or (numpy.diff(table[:, 0]) <= 0).any():
        raise palpate.InputError(f"{path}: two samples or more are needed, with numbers that are finite and times that rise")
    return Recording(path.parent.name if path.name == "probe.traj" else path.stem, table[:, 0], table[:, 1:4], table[:, 4:])


def modelled(seed, seconds):
    """The modelled hand on a plane that is no plane of a grid."""
    tip, force = press(Human(), numpy.random.default_rng([seed, 7]), seconds, PRESS, WALL, FRICTION)
    return Recording(f"modelled hand {seed}", numpy.arange(len(tip)) / RATE, tip @ tilt().T, force @ tilt().T)


def sample():
    """The modelled hand as a file at 250 Hz with four decimals has it: the same for each seed that is chosen."""
    _, *columns = modelled(1, 4)
    return Recording("plane", *(numpy.round(column[::4], 4) for column in columns))


@dataclasses.dataclass
class Surface:
    """nearest: points [mm] to the nearest points of the surface and its outward unit normals there, (n, 3) each."""

    name: str
    nearest: Callable

    def height(self, points):
        """[mm] above the surface."""
        on, normal = self.nearest(points)
        return ((points - on) * normal).sum(axis=1)


def plane_through(recording):
    """The plane that fits best to where the probe touched, with its normal to the side where it was free. Without such a place the side is
    that of the forces."""
    strength = numpy.linalg.norm(recording.force, axis=1)
    touched = recording.position[strength > CONTACT]
    if len(touched) < 3:
        raise ValueError(f"{recording.name}: it hardly touches anything")
    middle = touched.mean(axis=0)
    normal = numpy.linalg.svd(touched - middle, full_matrices=False)[2][2]
    free = recording.position[strength <= CONTACT] - middle
    normal = normal * (numpy.sign(normal @ (free if len(free) else recording.force).sum(axis=0)) or 1)
    return Surface("plane", lambda points: (points - ((points - middle) @ normal)[:, None] * normal,
                                            numpy.broadcast_to(normal, points.shape)))


def scanned(mesh):
    """The surface of a closed mesh, its triangles counter-clockwise from outside."""
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    tree, flat = scipy.spatial.cKDTree((a + b + c) / 3), unit(numpy.cross(b - a, c - a))

    def nearest(points):
        _, near = tree.query(points, min(NEIGHBOURS, len(a)))
        of = near.reshape(-1)
        found = nearest_in_triangles(a[of], b[of], c[of], numpy.repeat(points, near.shape[1], axis=0)).reshape(*near.shape, 3)
        away = numpy.linalg.norm(found - points[:, None], axis=2)
        # Of triangles that are equally near, at an edge, the one that faces the point most tells the side.
        facing = abs(((points[:, None] - found) * flat[near]).sum(axis=2))
        best = numpy.where(away <= away.min(axis=1, keepdims=True) + 1e-9, facing, -1).argmax(axis=1)
        row = numpy.arange(len(points))
        return found[row, best], flat[near[row, best]]

    return Surface("scanned", nearest)


def volume_of(surface, hands, voxel, levels):
    """A grid around the hands: density 1/2 - height / (2 BAND voxels), in `levels` per voxel."""
    low = hands.min(axis=0) - (BAND + 2) * voxel
    size = numpy.ceil((numpy.ptp(hands, axis=0) + 2 * (BAND + 2) * voxel) / voxel).astype(int) + 1
    places = low + voxel * numpy.indices(size[::-1]).reshape(3, -1).T[:, ::-1]
    part = numpy.clip(0.5 - numpy.concatenate([surface.height(some) for some in numpy.array_split(places, 1 + len(places) // 20_000)])
                      / (2 * BAND * voxel), 0, 1).reshape(size[::-1])
    if numpy.isfinite(levels):
        full = 2 * BAND * levels
        return palpate.Volume(numpy.floor(full * part + 0.5).astype(numpy.uint8), [voxel] * 3, low), 0.5 * full
    return palpate.Volume(part.astype(numpy.float32), [voxel] * 3, low), 0.5


def device_of(recording, surface):
    """(the way on the surface, the way of a device that is felt at STIFFNESS, normal forces): the out- and the in-trajectory. Raises
    ValueError for a force that does not push the hand out of the surface."""
    on, normal = surface.nearest(recording.position)
    pressure = numpy.maximum(0, (recording.force * normal).sum(axis=1))
    touches, strong = pressure > CONTACT, numpy.linalg.norm(recording.force, axis=1) > CONTACT
    if touches.sum() <= 0.5 * strong.sum():
        raise ValueError(f"{recording.name}: only {touches.sum()} of {strong.sum()} samples with a force push the hand out of the surface: "
                         "the force on the hand is needed, outwards")
    above = recording.position + numpy.maximum(0, 1e-6 - surface.height(recording.position))[:, None] * normal
    out, pressure = numpy.where(touches[:, None], on, above), numpy.where(touches, pressure, 0)[:, None]
    return out, out - pressure / STIFFNESS * normal, pressure * normal


def metrics(name, wanted, rendered):
    """Of the difference of two paths or forces: mean, root mean square and greatest length."""
    off = numpy.linalg.norm(rendered - wanted, axis=1)
    return {f"{name}_mean": off.mean(), f"{name}_rms": numpy.sqrt((off**2).mean()), f"{name}_max": off.max()}


def rows_of(recording, surface, samples, voxel):
    out, hands, normal_force = device_of(recording, surface)
    volume, level = volume_of(surface, hands, voxel, SAMPLES[samples])
    subject = linear(recording.name, volume, level)
    start, strength = hands[0] + (BAND + 1) * voxel * surface.nearest(hands[:1])[1][0], numpy.linalg.norm(normal_force, axis=1)
    for contestant in CONTESTANTS.values():
        trace = contestant.proxy(subject, start).follow(hands)
        force = numpy.where(trace.constrained[:, None], STIFFNESS * (trace.scp - hands), 0)
        yield {"recording": recording.name, "surface": surface.name, "samples": samples, "voxel_mm": voxel, "method": contestant.name,
               "ticks": len(hands), "contact_share": (strength > 0).mean(), "mean_force_n": strength.mean(),
               **metrics("force_n", normal_force, force), **metrics("with_friction_n", recording.force, force),
               **metrics("position_mm", out, trace.scp)}, force


def recordings_of(options):
    """(recording, surface): the sample, modelled hands, and what the data folder has: NAME/probe.traj, with NAME.obj where the object is no
    plane."""
    found = [sample()] + [modelled(options.seed + part, 4 if options.quick else 30) for part in range(options.seeds)]
    yield from ((one, plane_through(one)) for one in found)
    for path in sorted(Path(options.data).glob("*/probe.traj")) if options.data else ():
        mesh, one = path.with_name(path.parent.name + ".obj"), read(path)
        yield one, scanned(palpate.read_mesh(mesh)) if mesh.exists() else plane_through(one)


def origin_of(read):
    """A sentence: which recordings are from the data folder."""
    if not read:
        return "None were available, so the recordings here are modelled."
    return f"From there: {', '.join(read)}. The others here are modelled."


def summary_of(table):
    for samples in SAMPLES:
        for name in CONTESTANTS:
            rows = table.where(samples=samples, method=name)
            rms = {f"RMS error of the {what}, median [95 % interval]": sampling.in_words(rows[column], "{:.2g}") for what, column in (
                ("force [N]", "force_n_rms"), ("position [mm]", "position_mm_rms"), ("force with friction [N]", "with_friction_n_rms"))}
            yield {"samples": samples, "method": name, **rms, "greatest error of the force [N]": largest(rows["force_n_max"])}


def figure_of(recording, surface, forces, table):
    drawn, (left, right) = figures.panels(columns=2, height=2.6, title="On a plane, the rendered force is the recorded one")
    colour = figures.LOOKS["smooth"][0]
    wanted = numpy.linalg.norm(device_of(recording, surface)[2], axis=1)
    left.plot(recording.time, wanted, color="#c0c0c0", lw=4)
    left.plot(recording.time, numpy.linalg.norm(forces["smooth"], axis=1), color=colour, lw=1)
    figures.names(left, (("recorded (grey)", figures.GREY), ("rendered, smooth", colour)), 0.02, 0.97)
    left.set(title=recording.name, xlabel="time [s]", ylabel="normal force [N]", ylim=(0, 1.35 * wanted.max()))
    for (at, samples), (number, name) in itertools.product(enumerate(SAMPLES), enumerate(CONTESTANTS)):
        rows = table.where(samples=samples, method=name)
        figures.curve(right, name, numpy.maximum(rows["force_n_rms"], 1e-9), [at + 0.15 * (number - 2)] * len(rows), ls="")
    figures.names(right, [(name, figures.LOOKS[name][0]) for name in CONTESTANTS], 1.03, 0.9, 0.13, va="baseline")
    right.set(title="error of the force", xscale="log", xlabel="root mean square [N]", ylim=(1.5, -0.5))
    figures.ticks(right.yaxis, range(len(SAMPLES)), SAMPLES)
    return PAGE.figure(drawn)


def claims_of(table):
    table = table.where(surface="plane")
    plain = table.where(samples="float32")
    for name in ("exact", "smooth"):
        rows = plain.where(method=name)
        force, place = largest(rows["force_n_max"]), largest(rows["position_mm_max"] / rows["voxel_mm"])
        yield PAGE.claim("exact", force <= 1e-3 and place <= 0.01, method=name, force=force, place=place)
    rows, rubbed = table.where(samples="uint8", method="smooth"), plain.where(method="smooth")
    off, with_friction = rows["force_n_rms"], rubbed["with_friction_n_rms"]
    yield PAGE.claim("rounded", (off < 0.02 * rows["mean_force_n"]).all(), levels=SAMPLES["uint8"], most=largest(off))
    # Recordings of the data folder may have none. That of the program and the modelled hands have FRICTION.
    known = numpy.array([name == "plane" or name.startswith("modelled hand ") for name in rubbed["recording"]])
    yield PAGE.claim("friction", (with_friction > 0.05 * rubbed["mean_force_n"])[known].all(), least=with_friction[known].min())


def run(options):
    options.refuse_volumes("recorded has objects")
    cases, found = list(recordings_of(options)), []
    for (recording, surface), samples in options.each(itertools.product(cases, SAMPLES)):
        voxel = numpy.ptp(recording.position, axis=0).max() / (40 if options.quick else 80)
        found += rows_of(recording, surface, samples, voxel)
    table, shown = Table(row for row, _ in found), {row["method"]: force for row, force in found[:len(CONTESTANTS)]}
    names = [recording.name for recording, _ in cases]
    text = PAGE.text(names=", ".join(names), origin=origin_of(names[1 + options.seeds:]), tremor=1000 * Human.tremor, delay=1000 * Human.delay)
    return Result(table, [figure_of(*cases[0], shown, table)], claims_of(table), text, summary_of(table))
