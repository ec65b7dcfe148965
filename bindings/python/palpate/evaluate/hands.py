"""Hands that several experiments share."""

import numpy
import palpate


class Ring:
    """A closed trajectory of a hand around a body, travelled by its length.

    It goes around the grid's z axis through its centre: where rays from outside towards the centre
    first meet the surface, pushed in by `depth` [mm]. Rays that meet nothing take their neighbour's
    radius. Raises ValueError where fewer than half of them meet the surface.
    """

    RAYS = 360

    def __init__(self, subject, depth):
        geometry = subject.field.geometry
        centre = numpy.asarray(geometry.centre)
        angle = 2 * numpy.pi * numpy.arange(self.RAYS) / self.RAYS
        plane = numpy.stack([numpy.cos(angle), numpy.sin(angle)], axis=1)
        outward = plane @ numpy.asarray(geometry.direction)[:, :2].T
        points, _ = palpate.cast_rays(subject.field, subject.isovalue,
                                      centre + subject.diagonal * outward,
                                      numpy.tile(centre, (self.RAYS, 1)))
        radius = numpy.linalg.norm(points - centre, axis=1)
        met = numpy.flatnonzero(~numpy.isnan(radius))
        if 2 * len(met) < self.RAYS:
            raise ValueError(f"{subject.name}: rays to its centre hardly meet the surface, so a hand "
                             "cannot go round it; choose another level or volume")
        # The nearest ray before it that met the surface, around the circle.
        before = met[numpy.searchsorted(met, numpy.arange(self.RAYS), side="right") - 1]
        corners = centre + numpy.maximum(0, radius[before] - depth)[:, None] * outward
        self.centre = centre
        self._corners = numpy.concatenate([corners, corners[:1]])
        pieces = numpy.linalg.norm(numpy.diff(self._corners, axis=0), axis=1)
        self._arc = numpy.concatenate([[0], numpy.cumsum(pieces)])
        self.length = float(self._arc[-1])

    def at(self, arc):
        """Points `arc` [mm] from the start, shape (n, 3); they go on after a full turn."""
        along = numpy.asarray(arc) - self.length * numpy.floor(numpy.asarray(arc) / self.length)
        after = numpy.clip(numpy.searchsorted(self._arc, along, side="right"), 1, self.RAYS)
        piece = self._arc[after] - self._arc[after - 1]
        share = numpy.where(piece > 0, (along - self._arc[after - 1]) / numpy.maximum(piece, 1e-300), 0)
        start = self._corners[after - 1]
        return start + share[:, None] * (self._corners[after] - start)
