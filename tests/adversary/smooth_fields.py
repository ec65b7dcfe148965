"""The smooth field from its definition, without the program's own code. A cube around each sample is cut into
24 tetrahedra (the sample, a face's centre, an edge of that face). In each there is a cubic, whose 20
Bernstein coefficients are means of the samples around the cube."""

import math

from fields import WALLS, Grid

# Coefficient (powers of the four barycentric coordinates): weights of the 27 samples in 1/192, by their
# offset along the axes d, s, e of the tetrahedron, e fastest. d and s point to the face and to the edge.
MASKS = {
    (0, 0, 0, 3): "0 0 0 0 0 0 0 0 0 0 0 0 0 24 24 0 24 24 0 0 0 0 24 24 0 24 24",
    (0, 0, 1, 2): "0 0 0 0 0 0 0 0 0 0 0 0 0 40 8 0 40 8 0 0 0 0 40 8 0 40 8",
    (0, 0, 2, 1): "0 0 0 0 0 0 0 0 0 0 0 0 8 40 0 8 40 0 0 0 0 8 40 0 8 40 0",
    (0, 0, 3, 0): "0 0 0 0 0 0 0 0 0 0 0 0 24 24 0 24 24 0 0 0 0 24 24 0 24 24 0",
    (0, 1, 0, 2): "0 0 0 0 0 0 0 0 0 0 0 0 0 40 24 0 24 8 0 0 0 0 40 24 0 24 8",
    (0, 1, 1, 1): "0 0 0 0 0 0 0 0 0 0 0 0 6 52 6 2 28 2 0 0 0 6 52 6 2 28 2",
    (0, 1, 2, 0): "0 0 0 0 0 0 0 0 0 0 0 0 24 40 0 8 24 0 0 0 0 24 40 0 8 24 0",
    (0, 2, 0, 1): "0 0 0 0 0 0 0 0 0 0 3 1 3 52 17 1 17 2 0 3 1 3 52 17 1 17 2",
    (0, 2, 1, 0): "0 0 0 0 0 0 0 0 0 1 3 0 17 52 3 2 17 1 1 3 0 17 52 3 2 17 1",
    (0, 3, 0, 0): "0 0 0 0 0 0 0 0 0 1 10 1 10 52 10 1 10 1 1 10 1 10 52 10 1 10 1",
    (1, 0, 0, 2): "0 0 0 0 0 0 0 0 0 0 0 0 0 48 32 0 32 16 0 0 0 0 32 16 0 16 0",
    (1, 0, 1, 1): "0 0 0 0 0 0 0 0 0 0 0 0 8 64 8 4 40 4 0 0 0 4 40 4 0 16 0",
    (1, 0, 2, 0): "0 0 0 0 0 0 0 0 0 0 0 0 32 48 0 16 32 0 0 0 0 16 32 0 0 16 0",
    (1, 1, 0, 1): "0 0 0 0 0 0 0 0 0 0 4 2 4 64 24 2 24 4 0 2 0 2 40 10 0 10 0",
    (1, 1, 1, 0): "0 0 0 0 0 0 0 0 0 2 4 0 24 64 4 4 24 2 0 2 0 10 40 2 0 10 0",
    (1, 2, 0, 0): "0 0 0 0 0 0 0 0 0 2 14 2 14 64 14 2 14 2 0 6 0 6 40 6 0 6 0",
    (2, 0, 0, 1): "0 0 0 0 4 2 0 2 0 0 4 2 4 72 28 2 28 4 0 2 0 2 28 4 0 4 0",
    (2, 0, 1, 0): "0 0 0 2 4 0 0 2 0 2 4 0 28 72 4 4 28 2 0 2 0 4 28 2 0 4 0",
    (2, 1, 0, 0): "0 1 0 1 4 1 0 1 0 2 16 2 16 72 16 2 16 2 0 3 0 3 28 3 0 3 0",
    (3, 0, 0, 0): "0 2 0 2 16 2 0 2 0 2 16 2 16 72 16 2 16 2 0 2 0 2 16 2 0 2 0",
}
# The three barycentric coordinates whose product it is, how many times, and the weights.
TERMS = [([i for i, power in enumerate(powers) for _ in range(power)],
          math.factorial(3) / math.prod(math.factorial(p) for p in powers),
          [(i, int(w) / 192) for i, w in enumerate(weights.split()) if w != "0"])
         for powers, weights in MASKS.items()]


class SmoothGrid(Grid):
    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.known = {}  # coefficients by tetrahedron

    def coefficients(self, cell, axes, signs):
        key = (*cell, *axes, *signs)
        if key not in self.known:
            around = []
            for i in range(27):
                offset = (i // 9 - 1, i // 3 % 3 - 1, i % 3 - 1)
                at = list(cell)
                for axis, sign, steps in zip(axes, signs, offset):
                    at[axis] += sign * steps
                around.append(self.sample(*at))
            means = [math.fsum(w * around[i] for i, w in weights) for _, _, weights in TERMS]
            terms = [(*product, many * mean) for (product, many, _), mean in zip(TERMS, means)]
            self.known[key] = terms, min(means), max(means)
        return self.known[key]

    def tetrahedron(self, index):
        """Its coefficients, and the weights of its corners at the point."""
        cell = [math.floor(x + 0.5) for x in index]
        u = [x - c for x, c in zip(index, cell)]
        d, s, e = axes = sorted(range(3), key=lambda a: -abs(u[a]))
        signs = (1 if u[d] >= 0 else -1, 1 if u[s] >= 0 else -1, 1)
        far, side, along = abs(u[d]), abs(u[s]), u[e]
        weights = (1 - 2 * far, 2 * (far - side), side - along, side + along)
        return self.coefficients(cell, axes, signs), weights

    def value(self, index):
        (terms, _, _), w = self.tetrahedron(index)
        return math.fsum(c * w[i] * w[j] * w[k] for i, j, k, c in terms)

    def along(self, a, b, level, sign):
        """The extremes between two walls are at the ends, or where the cubic's slope is zero; no need to look
        where no coefficient is in the solid."""
        delta = [y - x for x, y in zip(a, b)]
        at = lambda t: self.value([x + t * d for x, d in zip(a, delta)])
        moments = self.moments([x + 0.5 for x in a], delta)
        values = [at(0), at(1)]
        for low, high in zip(moments, moments[1:]):
            middle = (low + high) / 2
            (_, least, most), _ = self.tetrahedron([x + middle * d for x, d in zip(a, delta)])
            if max(sign * (least - level), sign * (most - level)) <= 0:
                continue
            values.append(at(high))
            for t in turns(*(at(low + (high - low) * part / 3) for part in range(4))):
                values.append(at(low + (high - low) * t))
        return values


def turns(f0, f1, f2, f3):
    """Where in (0, 1) the slope of a cubic is zero that has these values at 0, 1/3, 2/3 and 1."""
    c1 = (-11 * f0 + 18 * f1 - 9 * f2 + 2 * f3) / 2
    c2 = (18 * f0 - 45 * f1 + 36 * f2 - 9 * f3) / 2
    c3 = (-9 * f0 + 27 * f1 - 27 * f2 + 9 * f3) / 2
    square = c2 * c2 - 3 * c3 * c1
    if square < 0:
        return []
    q = -(c2 + math.copysign(math.sqrt(square), c2))
    found = [q / (3 * c3)] if c3 else []
    found += [c1 / q] if q else []
    return [t for t in found if 0 < t < 1]
