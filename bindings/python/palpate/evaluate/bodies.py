"""Bodies with a known true surface, and trajectories of a hand just below it."""

import collections
import dataclasses

import numpy
import palpate

from .experiment import DoesNotApply
from .hands import Ring
from .subjects import cube, synthetic

RADIUS, SLOPE = 0.35, 1.4  # of the ball, in a unit box
DEPTH = 0.03  # of the hand, in the same unit
TURNS = 20
FILTERS = {"uint8 smoothed": palpate.smoothed, "uint8 dequantized": palpate.dequantized}
STORED = {"uint8": "uint8", **dict.fromkeys(FILTERS, "uint8"), "float32": "float32"}
SAMPLES = tuple(STORED)  # 8 bits as they are, smoothed in one pass, dequantized, and not rounded at all


# grid: samples along the longest axis; depth [mm] of the hand below the true surface, where that is constant; start: a free place [mm];
# hand(parts): from 0 to 1, points [mm], (n, 3); ideal(hands): unit vectors of a perfect force, None where they are not known.
Body = collections.namedtuple("Body", "subject trajectory samples grid depth start hand ideal", defaults=[None])


def unit(vectors):
    return vectors / numpy.linalg.norm(vectors, axis=-1, keepdims=True)


def around(angle, *others):
    return numpy.stack([numpy.cos(angle), numpy.sin(angle), *others], axis=-1)


def with_samples(subject, samples):
    if samples not in FILTERS:
        return subject
    return dataclasses.replace(subject, field=palpate.Field(FILTERS[samples](subject.field.volume), interpolation="linear"))



def ball(grid, samples):
    """The ball of the protocol, density 1/2 + 1.4 (0.35 - r), by slices."""
    full = 1.0 if samples == "float32" else 255.0

    def density(r):
        return full * numpy.clip(0.5 + SLOPE * (RADIUS - r / grid), 0, 1)

    at = numpy.arange(grid) - 0.5 * (grid - 1)
    flat = at[:, None]**2 + at[None, :]**2
    array = numpy.empty([grid] * 3, dtype=STORED[samples])
    for k, z in enumerate(at):
        values = density(numpy.sqrt(flat + z * z))
        array[k] = values if full == 1 else numpy.floor(values + 0.5)
    return with_samples(cube("ball", array, 0.5 * full, exact=lambda p: density(numpy.linalg.norm(p, axis=1))), samples)


def tilt():
    """No plane of the grid, and no diagonal either: a turn by 0.7 about (1, 2, 3)."""
    x, y, z = unit(numpy.array([1.0, 2, 3]))
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(0.7) * cross + (1 - numpy.cos(0.7)) * cross @ cross


def ball_by(trajectory, grid, samples):
    """On a tilted great circle, one turn; or from pole to pole of a tilted axis in 20 turns, evenly."""
    def direction(parts):
        if trajectory == "circle":
            return around(2 * numpy.pi * parts, 0 * parts) @ tilt().T
        z, angle = 1 - 2 * parts, 2 * numpy.pi * TURNS * parts
        across = numpy.sqrt(numpy.maximum(0, 1 - z * z))
        return numpy.stack([across * numpy.cos(angle), across * numpy.sin(angle), z], axis=-1) @ tilt().T

    def hand(parts):
        return (RADIUS - DEPTH) * grid * direction(numpy.asarray(parts, dtype=float))

    return Body(ball(grid, samples), trajectory, samples, grid, DEPTH * grid, 1.5 * hand([0])[0], hand, unit)


def torus_by_helix(grid, samples):
    """Once around the ring and 20 times around its tube. docs/scenes.md: a ring of 0.3 of the box, and at level 0.4 a tube of 0.12."""
    subject = with_samples(synthetic(f"torus:{grid}x{grid}x{grid // 2}", type=STORED[samples]), samples)
    ring, tube = 0.3 * grid, 0.12 * grid

    def at(parts, from_ring):
        along = 2 * numpy.pi * numpy.asarray(parts, dtype=float)
        out, turned = around(along, 0 * along), TURNS * along[:, None]
        return ring * out + from_ring * (numpy.cos(turned) * out + numpy.sin(turned) * [0, 0, 1])

    return Body(subject, "helix", samples, grid, DEPTH * grid, at([0], 1.3 * tube)[0], lambda parts: at(parts, tube - DEPTH * grid),
                lambda hands: unit(hands - ring * unit(hands * [1, 1, 0])))


def ripples_by_spiral(grid, samples):
    """In a plane below the deepest trough of the Marschner-Lobb signal, a spiral of 20 turns over its ripples. On the level, sin(pi z /
    2) is a quarter of the ripple: troughs are at -0.161 of half the box."""
    subject = with_samples(synthetic(f"marschner-lobb:{grid}x{grid}x{grid}", type=STORED[samples]), samples)
    half, trough = 0.5 * (grid - 1), -2 / numpy.pi * numpy.arcsin(0.25)

    def hand(parts):
        parts = numpy.asarray(parts, dtype=float)
        flat = (0.15 + 0.7 * parts)[:, None] * around(2 * numpy.pi * TURNS * parts)
        return half * numpy.column_stack([flat, numpy.full(len(parts), trough - 2 * DEPTH)])

    return Body(subject, "spiral", samples, grid, numpy.nan, hand([0])[0] + [0, 0, half], hand)


def of_a_user(subject):
    """Around the z axis, from outside. Raises ValueError where a hand cannot go around it."""
    geometry = subject.field.geometry
    if subject.sign * (subject.field.background - subject.isovalue) > 0:
        raise DoesNotApply(f"{subject.name}: all around the data is solid at this level, so a hand cannot come to it; choose another level")
    depth = float(DEPTH * (geometry.size * geometry.spacing).min())
    ring = Ring(subject, depth)
    start = ring.centre + subject.diagonal * unit(ring.at([0.0])[0] - ring.centre)
    return Body(subject, "ring", subject.field.volume.type, int(max(geometry.size)), depth, start,
                lambda parts: ring.at(numpy.asarray(parts) * ring.length))
