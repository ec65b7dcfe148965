"""Bodies whose density is their depth, layers in them, and the closed form of the force on a hand that goes straight in."""

import dataclasses

import numpy
import palpate

from .hands import Way

RATE = 1000  # [Hz] of every hand here
BALL_RADIUS = 80.0  # [mm]
DEEPEST = 64.0  # [mm] of a hand in either body
# Level [mm], stiffness [N/mm], puncture force [N] and drag [N/mm per mm]. Levels are no multiples of a tick's way.
TISSUES = {"skin": (10, 0.4, 1.2, 0.03), "fat": (16, 0.2, 0.7, 0.01), "fascia": (30, 0.9, 2.0, 0.05),
           "muscle": (33.5, 0.5, 1.0713, 0.03), "bone": (60, 1.5, numpy.inf, 0)}
LEVEL, STIFFNESS, PUNCTURE, DRAG = (numpy.array(column, dtype=float) for column in zip(*TISSUES.values()))


@dataclasses.dataclass
class Body:
    """Its density at depth d [mm] is d."""

    name: str
    volume: palpate.Volume

    def felt(self, interpolation):
        return palpate.Field(self.volume, interpolation=interpolation)

    def way(self, random):
        """Straight in: flat, anywhere; of the balls, up to 4 degrees off the grid's axis."""
        x, y = random.uniform(size=2)
        if self.name == "flat":
            return Way(numpy.array([3 + 2 * x, 3 + 2 * y, 0]), numpy.array([0.0, 0, 1]))
        tilt, turn = numpy.radians(4) * numpy.sqrt(x), 2 * numpy.pi * y
        outward = numpy.array([numpy.sin(tilt) * numpy.cos(turn), numpy.sin(tilt) * numpy.sin(turn), numpy.cos(tilt)])
        return Way(BALL_RADIUS * outward, -outward)


def flat():
    """Density z, a sample per mm, so that both fields are exact."""
    z = numpy.arange(101, dtype=numpy.float32)
    return Body("flat", palpate.Volume(numpy.ascontiguousarray(numpy.broadcast_to(z[:, None, None], (101, 9, 9)))))


def balls():
    """Concentric balls around (0, 0, 0), 0.125 mm apart, in an upright block from above the outermost surface to below the innermost."""
    x, z = -5.9 + 0.125 * numpy.arange(96), 8 + 0.125 * numpy.arange(576)
    radius = numpy.sqrt(z[:, None, None]**2 + x[:, None]**2 + x**2)
    return Body("balls", palpate.Volume((BALL_RADIUS - radius).astype(numpy.float32), [0.125] * 3, [x[0], x[0], z[0]]))


def layered(name, rows, needle=False):
    """rows: name, level, stiffness [N/mm], puncture force [N], and of a needle the drag [N/mm per mm]."""
    keys = ("stiffness", "puncture_force", "drag")[:3 if needle else 2]
    return palpate.Layers(name=name, needle=palpate.Needle() if needle else None, layers=[
        palpate.Layer(name=layer, level=level, properties=dict(zip(keys, of))) for layer, level, *of in rows])


def layers(needle=False, count=None):
    """The tissues, or the outermost ones; for a needle with their drag."""
    return layered("five tissues", [(name, *of) for name, of in list(TISSUES.items())[:count]], needle)


def renderer(field, made):
    """Without damping, ramp and limits, so that the force is what the layers make it. made: Layers, or None for the skin's level
    alone."""
    force = palpate.ForceSettings(ramp=0, rate_limit=numpy.inf, limit=1e6)
    level = made.layers[0].level if made else LEVEL[0]
    return palpate.Renderer(field, level, palpate.RenderSetup(layers=made, force=force),
                            palpate.DeviceLimits(maximum_force=1e6, physical_damping=1))


def times(count):
    return (1 + numpy.arange(count)) / RATE


def pushed(fresh, way, depth, needle=False):
    """(trace, force [N] against the hand) of a hand that goes straight in to these depths, by a copy of a renderer."""
    pointing = {"pointing": numpy.tile(way.inward, (len(depth), 1))} if needle else {}
    trace = fresh.copy().follow(times(len(depth)), way.at(depth), **pointing)
    return trace, -trace["force"] @ way.inward


def thinned(depth, is_apart, wanted=()):
    """Rows whose depths are apart from the one before, and others that are wanted."""
    kept, last = [], -numpy.inf
    for row, one in enumerate(depth):
        if is_apart(one, last) or (len(wanted) and wanted[row]):
            kept.append(row)
            last = one
    return kept


def spring(depth):
    """The spring's force [N] on a hand that went straight in to these depths: each surface holds until its puncture force, and the next
    is met at its level, or where the last one let the hand go behind it."""
    gone = numpy.concatenate([[-numpy.inf], (LEVEL + PUNCTURE / STIFFNESS)[:-1]])
    stretch = numpy.asarray(depth)[:, None] - LEVEL
    force = STIFFNESS * stretch
    held = (depth[:, None] > numpy.maximum(gone, LEVEL)) & (force < PUNCTURE)
    return numpy.where(held.any(axis=1), numpy.take_along_axis(force, held.argmax(axis=1)[:, None], 1)[:, 0], 0)


def lengths(depth):
    """Of the shaft in each tissue, to the next surface [mm]."""
    return numpy.maximum(0, numpy.minimum(numpy.asarray(depth)[:, None], numpy.append(LEVEL[1:], numpy.inf)) - LEVEL)


def drag(depth):
    """What rubs on a needle's shaft in motion [N]: drag times length, in each tissue whose surface gave way."""
    return (lengths(depth) * DRAG * (depth[:, None] >= LEVEL + PUNCTURE / STIFFNESS)).sum(axis=1)
