#!/usr/bin/env python3
"""Script an experiment: how far do the surfaces that two methods feel lie from the true one?

A hand slides over a torus whose density is known. For each method and number of bits, the median
distance of the SCP from the analytic surface is printed as CSV.
"""

import numpy
from numpy.typing import NDArray

import palpate


def distance_from_surface(scene: palpate.Scene, points: NDArray[numpy.float64]) -> NDArray[numpy.float64]:
    """|f - isovalue| over the slope of the analytic density: a distance in mm."""
    step = 1e-3
    slopes = []
    for axis in range(3):
        aside = numpy.zeros(3)
        aside[axis] = step
        slopes.append((scene.exact(points + aside) - scene.exact(points - aside)) / (2 * step))
    slope = numpy.linalg.norm(slopes, axis=0)
    distance: NDArray[numpy.float64] = numpy.abs(scene.exact(points) - scene.isovalue) / slope
    return distance


def feel(scene: palpate.Scene, interpolation: str) -> NDArray[numpy.float64]:
    """The places of the proxy while it touches [mm], shape (n, 3)."""
    field = palpate.Field(scene.volume, interpolation=interpolation)
    settings = palpate.MotionSettings(duration_s=4, depth_mm=1, seed=7)
    time, position = palpate.motion("slide", field, scene.isovalue, settings)
    trace = palpate.replay(field, scene.isovalue, time, position)
    return trace.scp[trace.constrained]


print("samples,field,ticks,median_mm")
for sample_type in ("uint8", "float32"):
    torus = palpate.scene("torus:48x48x48", sample_type)
    for kind in ("linear", "cubic"):
        touched = feel(torus, kind)
        middle = numpy.median(distance_from_surface(torus, touched))
        print(f"{sample_type},{kind},{len(touched)},{middle:.4f}")
