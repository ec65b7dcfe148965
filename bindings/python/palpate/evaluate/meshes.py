"""The nearest points of triangles."""

import numpy


def nearest_in_triangles(a, b, c, point):
    """The nearest point of each triangle, (n, 3)."""
    def on_edge(p, q):
        along = q - p
        squared = (along**2).sum(axis=1)
        part = ((point - p) * along).sum(axis=1) / numpy.where(squared > 0, squared, 1)
        return p + numpy.clip(part, 0, 1)[:, None] * along

    normal = numpy.cross(b - a, c - a)
    squared = (normal**2).sum(axis=1)
    within = squared > 0
    for p, q in ((a, b), (b, c), (c, a)):
        within &= (numpy.cross(q - p, point - p) * normal).sum(axis=1) >= 0
    part = ((point - a) * normal).sum(axis=1) / numpy.where(squared > 0, squared, 1)
    inner = numpy.where(within[:, None], point - part[:, None] * normal, numpy.inf)
    found = numpy.stack([on_edge(a, b), on_edge(b, c), on_edge(c, a), inner])
    return found[((found - point)**2).sum(axis=2).argmin(axis=0), numpy.arange(len(a))]


def nearest_points(mesh, points):
    """Of the whole surface, to each point."""
    corners = mesh.vertices[mesh.triangles]
    longest = numpy.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2).max(axis=1)
    for point in points:
        first = numpy.linalg.norm(corners[:, 0] - point, axis=1)
        found = nearest_in_triangles(*corners[first - longest <= first.min()].transpose(1, 0, 2), point)
        yield found[((found - point)**2).sum(axis=1).argmin()]
