"""Which free space is connected with all that lies outside the grid: this tells a proxy that fell through a wall from one that went
around it."""

import itertools

import numpy
import scipy.ndimage
import scipy.sparse.csgraph

from .experiment import DoesNotApply


def corners_of(grid, axes=(0, 1, 2)):
    """Each of the eight corners of every cell, or of the four of every face along two axes."""
    for corner in itertools.product(*((0, 1) if axis in axes else (0,) for axis in range(3))):
        yield grid[tuple(slice(o, n + o - (axis in axes)) for axis, (o, n) in enumerate(zip(corner, grid.shape)))]


class Outside:
    """Decided exactly for the linear field. The free part of a tetrahedron is convex and contains its lowest corner, and two free corners
    are joined by a free edge, so connected corners are connected free space. A free centre of a face or cell has a free sample among
    those that it is the mean of, and an edge to each of them: it joins all free samples of its face or cell.

    A smooth field's free space is not decided that way. For the smooth field of a closed shell, whose density falls from the middle of
    the wall to either side, a point goes down along the gradient until it is clear of the wall, where the linear field of the same
    samples tells.

    Raises ValueError where the background is solid: there is no outside then.
    """

    def __init__(self, subject):
        self._subject = subject
        field = subject.field
        if subject.sign * (field.background - subject.isovalue) > 0:
            raise DoesNotApply("all around the data is solid at this level, so nothing can come from outside: "
                             "choose another level")
        samples = field.volume.array.astype(float).transpose(2, 1, 0)  # [x, y, z]
        self._excess = subject.sign * (numpy.pad(samples, 1, constant_values=field.background)
                                       - subject.isovalue)
        labels, count = scipy.ndimage.label(self._excess <= 0)
        pairs = []
        for axes in ((0, 1), (0, 2), (1, 2), (0, 1, 2)):  # faces across z, y and x, then cells
            free = sum(corners_of(self._excess, axes)) <= 0
            around = numpy.stack([part[free] for part in corners_of(labels, axes)], axis=1)
            one = numpy.broadcast_to(around.max(axis=1, keepdims=True), around.shape)
            joined = (around > 0) & (around != one)
            pairs.append(numpy.stack([one[joined], around[joined]], axis=1))
        pairs = numpy.concatenate(pairs)
        graph = scipy.sparse.coo_matrix((numpy.ones(len(pairs)), pairs.T), shape=(count + 1, count + 1))
        _, component = scipy.sparse.csgraph.connected_components(graph, directed=False)
        self._reached = (component[labels] == component[labels[0, 0, 0]]) & (labels > 0)

    def holds(self, points):
        """Whether free points [mm, physical], (n, 3), belong to it. Of a point in the solid: whether the lowest corner of its tetrahedron
        does."""
        points = numpy.array(points, dtype=float)
        subject = self._subject
        if subject.field.interpolation == "cubic":
            for _ in range(40):
                gradient = subject.sign * subject.field.gradient(points)
                length = numpy.linalg.norm(gradient, axis=1, keepdims=True)
                points -= 0.1 * subject.voxel * gradient / numpy.where(length > 0, length, 1)
        geometry = subject.field.geometry
        index = (points - geometry.origin) @ numpy.asarray(geometry.direction) / geometry.spacing + 1  # of the padded samples
        cell = numpy.floor(index).astype(int)
        held = ((cell < 0) | (cell > numpy.array(self._excess.shape) - 2)).any(axis=1)
        inner = ~held
        cell, u = cell[inner], (index - cell - 0.5)[inner]  # places in cells, from their centres
        eight = numpy.array(list(itertools.product((0, 1), repeat=3)))
        x, y, z = (cell[:, None, :] + eight).transpose(2, 0, 1)
        excess, reached = self._excess[x, y, z], self._reached[x, y, z]
        order = numpy.argsort(-abs(u), axis=1, kind="stable")
        sides = (u > 0).astype(int)
        on = eight[None] == sides[:, None]  # (n, 8, 3): which samples are on the same side along an axis
        face = numpy.take_along_axis(on, order[:, None, :1], axis=2)[..., 0]
        edge = face & numpy.take_along_axis(on, order[:, None, 1:2], axis=2)[..., 0]
        rows = numpy.arange(len(cell))
        lowest_of_edge = numpy.where(edge, excess, numpy.inf).argmin(axis=1)
        means = numpy.stack([excess.mean(axis=1), numpy.where(face, excess, 0).sum(axis=1) / 4,
                             excess[rows, lowest_of_edge]], axis=1)
        of_corner = numpy.stack([excess.argmin(axis=1), numpy.where(face, excess, numpy.inf).argmin(axis=1),
                                 lowest_of_edge], axis=1)
        lowest = means.argmin(axis=1)
        held[inner] = reached[rows, of_corner[rows, lowest]] & (means[rows, lowest] <= 0)
        return held
