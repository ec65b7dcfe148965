"""Hands that several experiments share: straight in, and around a body."""

import dataclasses

import numpy
import palpate

from .experiment import DoesNotApply


@dataclasses.dataclass
class Way:
    """A straight way of a hand: where depth 0 is [mm, physical], and a unit vector."""

    origin: numpy.ndarray
    inward: numpy.ndarray

    def at(self, depth):
        return self.origin + numpy.multiply.outer(depth, self.inward)


def way_in(subject, through, inward):
    """From where the line through a place first meets the surface from outside; None where it does not."""
    outside = through - 2 * subject.diagonal * inward
    met = palpate.cast_rays(subject.field, subject.isovalue, [outside], [through])[0][0]
    return None if numpy.isnan(met[0]) or (met == outside).all() else Way(met, inward)


# A place on a way into each head, and the way's direction, which is about the skin's normal: through the forehead beside the middle, and
# on the CT head, which was stored upside down, over the left brow, where the skull has no sinus. Both scans of the sample's head have the
# same axes.
FOREHEAD = (278.5, 160.5, 170.5), (0, 1, -0.4)
INTO_HEADS = {"sample head": FOREHEAD, "visible-human": FOREHEAD, "ct-head": ((103, 64, 44), (0, 1, 0.6))}


def way_into_head(subject):
    through, inward = map(numpy.array, INTO_HEADS[subject.name])
    way = way_in(subject, through, inward / numpy.linalg.norm(inward))
    if way is None:
        raise ValueError(f"{subject.name} is not the head that the line was chosen for")
    return way


def way_from_a_side(subject):
    """(way, its length [mm]) to the middle of the volume, from the first side of its box where it meets the surface. Raises ValueError
    where none does."""
    geometry = subject.field.geometry
    centre = numpy.array(geometry.centre)
    for side in (1, -1):
        for axis in (1, 0, 2):
            way = way_in(subject, centre, side * numpy.asarray(geometry.direction)[:, axis])
            if way is not None and (centre != way.origin).any():
                return way, float(numpy.linalg.norm(centre - way.origin))
    raise DoesNotApply(f"{subject.name}: no line from a side of the volume to its middle meets the surface; choose another level")


class Ring:
    """A closed trajectory of a hand around a body, travelled by its length.

    It goes around the grid's z axis through its centre: where rays from outside towards the centre first meet the surface, pushed in by
    `depth` [mm]. Rays that meet nothing take their neighbour's radius. Raises ValueError where fewer than half of them meet the surface.
    """

    RAYS = 360

    def __init__(self, subject, depth):
        geometry = subject.field.geometry
        self.centre = numpy.asarray(geometry.centre)
        angle = 2 * numpy.pi * numpy.arange(self.RAYS) / self.RAYS
        outward = numpy.stack([numpy.cos(angle), numpy.sin(angle)], axis=1) @ numpy.asarray(geometry.direction)[:, :2].T
        points, _ = palpate.cast_rays(subject.field, subject.isovalue, self.centre + subject.diagonal * outward,
                                      numpy.tile(self.centre, (self.RAYS, 1)))
        radius = numpy.linalg.norm(points - self.centre, axis=1)
        met = numpy.flatnonzero(~numpy.isnan(radius))
        if 2 * len(met) < self.RAYS:
            raise DoesNotApply(f"{subject.name}: rays to its centre hardly meet the surface, so a hand cannot go round it; choose another "
                             "level or volume")
        # The nearest ray before it that met the surface, around the circle.
        before = met[numpy.searchsorted(met, numpy.arange(self.RAYS), side="right") - 1]
        corners = self.centre + numpy.maximum(0, radius[before] - depth)[:, None] * outward
        self._corners = numpy.concatenate([corners, corners[:1]])
        self._arc = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(self._corners, axis=0), axis=1))])
        self.length = float(self._arc[-1])

    def at(self, arc):
        """Points `arc` [mm] from the start, shape (n, 3); they go on after a full turn."""
        along = numpy.asarray(arc) - self.length * numpy.floor(numpy.asarray(arc) / self.length)
        after = numpy.clip(numpy.searchsorted(self._arc, along, side="right"), 1, self.RAYS)
        piece = self._arc[after] - self._arc[after - 1]
        share = numpy.where(piece > 0, (along - self._arc[after - 1]) / numpy.maximum(piece, 1e-300), 0)
        start = self._corners[after - 1]
        return start + share[:, None] * (self._corners[after] - start)
