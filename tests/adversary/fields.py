"""A field evaluated from its definition, apart from the program's own code: each cell of eight samples is
cut into 24 tetrahedra (cell's centre, a face's centre, an edge of that face), linear in each."""

import math
from itertools import product


class Grid:
    """Samples on a grid, x fastest. Outside it, the background. Axes may have any spacing and direction."""

    def __init__(self, size, samples, spacing=(1, 1, 1), origin=(0, 0, 0), axes=None, background=None):
        self.size, self.samples, self.spacing, self.origin = size, samples, spacing, origin
        self.axes = axes or ((1, 0, 0), (0, 1, 0), (0, 0, 1))  # the direction of x, y and z, LPS
        self.low, self.high = min(samples), max(samples)
        self.background = self.low if background is None else background

    @property
    def range(self):
        return max(self.high, self.background) - min(self.low, self.background)

    def sample(self, i, j, k):
        nx, ny, nz = self.size
        if 0 <= i < nx and 0 <= j < ny and 0 <= k < nz:
            return self.samples[i + nx * (j + ny * k)]
        return self.background

    def physical(self, index):
        return tuple(self.origin[c] + math.fsum(self.axes[a][c] * self.spacing[a] * index[a]
                                                for a in range(3)) for c in range(3))

    def index(self, point):
        moved = [point[c] - self.origin[c] for c in range(3)]
        return tuple(math.fsum(self.axes[a][c] * moved[c] for c in range(3)) / self.spacing[a]
                     for a in range(3))

    def value(self, index):
        """The field at a point in index space, by barycentric coordinates of its tetrahedron."""
        cell = [math.floor(x) for x in index]
        corners = {d: self.sample(cell[0] + d[0], cell[1] + d[1], cell[2] + d[2])
                   for d in product((0, 1), repeat=3)}
        u = [x - c - 0.5 for x, c in zip(index, cell)]  # from the cell's centre
        order = sorted(range(3), key=lambda a: -abs(u[a]))
        d, s, e = order
        side_d, side_s = int(u[d] > 0), int(u[s] > 0)
        on_face = [v for c, v in corners.items() if c[d] == side_d]
        on_edge = {c[e]: v for c, v in corners.items() if c[d] == side_d and c[s] == side_s}
        centre = math.fsum(corners.values()) / 8
        face = math.fsum(on_face) / 4
        # Weights of cell's centre, face's centre, and the edge's ends.
        w_edge = 2 * abs(u[s])
        high = abs(u[s]) + u[e]
        return math.fsum(((1 - 2 * abs(u[d])) * centre, (2 * abs(u[d]) - w_edge) * face,
                          high * on_edge[1], (w_edge - high) * on_edge[0]))

    def is_background(self, a, b):
        """Whether all of a segment (index space) is too far outside for any sample to count."""
        return any(max(x, y) < -2 or min(x, y) > n + 1 for x, y, n in zip(a, b, self.size))

    def along(self, a, b, level, sign):
        """The field's values at both ends of a segment (index space) and wherever it meets the wall of a
        tetrahedron: between these it is linear, so its extremes are among them."""
        delta = [y - x for x, y in zip(a, b)]
        return [self.value([x + t * d for x, d in zip(a, delta)]) for t in self.moments(a, delta)]

    @staticmethod
    def moments(a, delta):
        """Parts of the way from a by delta at which it meets a wall, 0 and 1 among them."""
        moments = {0.0, 1.0}
        for coefficients in WALLS:
            start = sum(c * x for c, x in zip(coefficients, a))
            change = sum(c * x for c, x in zip(coefficients, delta))
            if change == 0:
                continue
            first, last = sorted((start, start + change))
            for k in range(math.ceil(first), math.floor(last) + 1):
                moments.add(min(1.0, max(0.0, (k - start) / change)))
        return sorted(moments)


# The planes that separate tetrahedra: x=k, y=k, z=k, x+-y=k, x+-z=k, y+-z=k for all whole k, and those
# through the cells' centres among them.
WALLS = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1),
         (0, 1, -1))


def rotation(random):
    """Three orthonormal axes at random, right- or left-handed as files have them."""
    while True:
        a = [random.gauss(0, 1) for _ in range(3)]
        b = [random.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in a))
        if length < 0.1:
            continue
        a = [x / length for x in a]
        along = sum(x * y for x, y in zip(a, b))
        b = [y - along * x for x, y in zip(a, b)]
        length = math.sqrt(sum(x * x for x in b))
        if length < 0.1:
            continue
        b = [x / length for x in b]
        c = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        return tuple(a), tuple(b), tuple(c)


def samples_of(kind, size, random):
    """Unkind data: what breaks geometric code is flat, thin, huge, tiny or jagged."""
    nx, ny, nz = size
    cells = list(product(range(nz), range(ny), range(nx)))
    if kind == "noise":
        return [random.random() for _ in cells]
    if kind == "bytes":
        return [random.randrange(256) for _ in cells]
    if kind == "two-levels":
        return [random.choice((0, 1)) for _ in cells]
    if kind == "box":
        return [int(min(i, j, k, nx - 1 - i, ny - 1 - j, nz - 1 - k) > 0) for k, j, i in cells]
    if kind == "sheet":
        return [float(i == nx // 2) for k, j, i in cells]
    if kind == "offset":  # a small range on a large value
        base = random.choice((1e4, 1e6))
        return [base + random.random() for _ in cells]
    if kind == "small":
        return [1e-30 * random.random() for _ in cells]
    if kind == "large":
        return [1e30 * random.random() for _ in cells]
    if kind == "ball":
        centre = [(n - 1) / 2 for n in size]
        return [max(0.0, min(size) / 2 - math.dist((i, j, k), centre)) for k, j, i in cells]
    raise ValueError(kind)


KINDS = ("noise", "bytes", "two-levels", "box", "sheet", "offset", "small", "large", "ball")
