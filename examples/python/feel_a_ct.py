#!/usr/bin/env python3
"""Feel a CT in five minutes: read a volume, press a hand onto its skin, look at the force.

usage: feel_a_ct.py [VOLUME [ISOVALUE]]
"""

import pathlib
import sys

import numpy

import palpate

# 1. A volume: any file that Palpate reads, here the CT of a head that comes with it.
path = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else palpate.sample_volume()
loaded = palpate.load(path)
print(loaded.volume)
for note in loaded.notes:
    print("note:", note)

# 2. What is felt: the surface of a level of it. Bright is solid.
if len(sys.argv) > 2:
    isovalue = float(sys.argv[2])
else:
    isovalue = palpate.SAMPLE_SKIN if len(sys.argv) == 1 else loaded.suggested_isovalues[0]
field = palpate.Field(loaded.volume)

# 3. A hand that comes from the front (in LPS, the front is at low y) and meets the surface.
centre = field.geometry.centre
front = centre - [0, 200, 0]
hit = field.cast_ray(isovalue, front, centre)
if hit is None:
    sys.exit(f"no surface at {isovalue} on the way to the middle: choose another level")
surface, normal = hit
print("the surface is at", numpy.round(surface, 2), "mm, its normal", numpy.round(normal, 2))

# 4. It presses 2 mm deep within half a second, one position a millisecond.
time = numpy.arange(500) * 1e-3
depth = numpy.linspace(-3, 2, len(time))
position = surface - normal * depth[:, None]
trace = palpate.replay(field, isovalue, time, position, stiffness=0.8)
force = numpy.linalg.norm(trace.force, axis=1)
for tick in range(99, 500, 100):
    where = "in contact" if trace.constrained[tick] else "free"
    print(f"{time[tick]:.3f} s  {depth[tick]:5.2f} mm deep  {where:10}  force {force[tick]:.2f} N")

# 5. The whole surface as a mesh, for other programs: mesh.write("skin.ply").
print(palpate.extract(field, isovalue))
