"""Closed walls of any thickness, and straight lines of a hand through them."""

import numpy
import palpate

from .experiment import DoesNotApply
from .outside import corners_of
from .subjects import cube

SAMPLES = 28  # along an axis
HALF_WIDTH = 10.5  # [voxel] of the body, the outer layer of samples included
FULL = 255
# In voxels of the shortest side.
THINNEST_WALL, THICKEST_WALL, END_IN_BODY, END_BEHIND_WALL, OFF_SURFACE = 1e-3, 16, 4, 3, 1e-6
FLATTEST = 0.2588190451025208  # cosine of 75 degrees
# Of a line from outside into the solid: where it first meets the surface [mm], its unit direction, and its way in the wall and the hand's
# way, both from the entry [mm].
LINE = numpy.dtype([("entry", "3f8"), ("along", "3f8"), ("wall", "f8"), ("end", "f8")])


def full_samples(body, layers):
    """The corners of faces between a cell of the body and one that is not, then layer by layer those of every cell of the body that has a
    full one."""
    around = list(corners_of(numpy.pad(body, 1)))  # a sample is a corner of eight cells
    full = numpy.any(around, axis=0) & ~numpy.all(around, axis=0)
    for _ in range(1, layers):
        touched = numpy.any(list(corners_of(full)), axis=0) & body
        full |= numpy.any(list(corners_of(numpy.pad(touched, 1))), axis=0)
    return full



def closed_shell(shape, thickness, interpolation):
    """A wall around a hollow 'box' (flat, with corners) or 'ball' of voxels (stepped), `thickness` [voxel] on every flat face; spacing 1
    mm.

    Every face of the body has its four samples full, so a linear field is full all over the face, and the wall is closed at any level
    below: the level sets its thickness. A ramp sampled thinner than a voxel would have real holes. A smooth field needs two full layers,
    between which it is full.
    """
    if not 0 < thickness <= 4:
        raise ValueError(f"a shell of {thickness} voxels: it can be above 0 and up to 4 thick")
    smooth = interpolation == "cubic"
    layers = max(2 if smooth else 1, int(numpy.floor(thickness + 0.5)))
    centre = numpy.indices([SAMPLES - 1] * 3) + 0.5 - 0.5 * (SAMPLES - 1)
    size = abs(centre).max(axis=0) if shape == "box" else numpy.sqrt((centre**2).sum(axis=0))
    full = full_samples(size <= HALF_WIDTH, layers).transpose(2, 1, 0)
    level = 1 - 0.5 * (thickness - layers + 1)
    if smooth:  # a quadratic spline across the wall, from its middle to each layer
        off = abs(0.5 * thickness - (numpy.arange(layers) - 0.5 * (layers - 1)))
        level = float(numpy.where(off <= 0.5, 0.75 - off**2, 0.5 * numpy.maximum(0, 1.5 - off)**2).sum())
    return cube(shape, numpy.ascontiguousarray(full * numpy.uint8(FULL)), FULL * level, interpolation)


def lines_through(subject, outside, anywhere, count, random):
    """Lines at most 75 degrees off the normal where they meet the surface. A line goes through the first wall to 3 voxels behind it, or
    half the distance to the next wall, if no free path from outside leads there. With `anywhere`, lines into a body thicker than 16
    voxels, or one that a proxy may go around, end 4 voxels deep or half way through. Raises ValueError if hardly a line meets such a wall
    or body."""
    kept, tried = [], 0
    while sum(len(part[0]) for part in kept) < count:
        if tried > 1000 + 100 * count:
            raise DoesNotApply(f"{subject.name}: hardly a straight line through it meets anything solid; choose another level or volume")
        along = random.standard_normal((2 * count + 100, 3))
        places = random.random(along.shape) * (numpy.asarray(subject.field.geometry.size) - 1)
        kept.append(usable(subject, outside, anywhere, places, along / numpy.linalg.norm(along, axis=1, keepdims=True)))
        tried += len(places)
    return numpy.rec.fromarrays([numpy.concatenate(parts)[:count] for parts in zip(*kept)], LINE)


def usable(subject, outside, anywhere, places, along):
    """Of lines through places: entry, direction, way in the wall and way of the hand of those that can be used."""
    field, isovalue, voxel, geometry = subject.field, subject.isovalue, subject.voxel, subject.field.geometry
    through, far = geometry.origin + (places * geometry.spacing) @ numpy.asarray(geometry.direction).T, 2 * subject.diagonal * along
    entry, normal = palpate.cast_rays(field, isovalue, through - far, through + far)
    steep = -(normal * along).sum(axis=1) >= FLATTEST  # false for NaN
    entry, along = entry[steep], along[steep]
    inverse = palpate.Field(field.volume, "below" if field.solid == "above" else "above", field.background, field.interpolation)
    hair = OFF_SURFACE * voxel
    farthest = entry + (hair + THICKEST_WALL * voxel) * along
    out, _ = palpate.cast_rays(inverse, isovalue, entry + hair * along, farthest)
    leaves = ~numpy.isnan(out[:, 0])
    wall = numpy.linalg.norm(numpy.where(leaves[:, None], out, farthest) - entry, axis=1)
    behind = entry + (wall + hair)[:, None] * along
    reach = behind + 2 * END_BEHIND_WALL * voxel * along
    following, _ = palpate.cast_rays(field, isovalue, behind, reach)
    following = numpy.where(numpy.isnan(following), reach, following)
    end = wall + hair + 0.5 * numpy.linalg.norm(following - behind, axis=1)
    closed = leaves & ~outside.holds(entry + end[:, None] * along)
    kept = (wall >= THINNEST_WALL * voxel) & (closed | anywhere)  # the others graze, or lead to free space
    end = numpy.where(closed, end, numpy.minimum(END_IN_BODY * voxel, 0.5 * wall))
    return entry[kept], along[kept], numpy.where(closed, wall, numpy.inf)[kept], end[kept]
