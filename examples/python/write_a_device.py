#!/usr/bin/env python3
"""Write a device: a mass of 100 g on a guide that falls onto a floor and comes to rest there.

The functions of the device run on a thread of their own. The servo's real-time thread never waits
for Python. If Python is late, there is no force.
"""

import time

import numpy
from numpy.typing import NDArray

import palpate


class FallingMass:
    """What the device's thread calls: info(), read(), and where there are, write() and close()."""

    mass, damping = 0.1, 20.0  # kg, N s/m: it falls in oil, and so bears late forces

    def __init__(self) -> None:
        self.height, self.speed, self.force = 8.0, 0.0, 0.0  # mm, m/s, N
        self.seen = time.monotonic()

    def info(self) -> palpate.DeviceInfo:
        limits = palpate.DeviceLimits(maximum_force=20, physical_damping=0.02)
        return palpate.DeviceInfo(name="falling mass", limits=limits)

    def read(self) -> palpate.DeviceReading:
        now = time.monotonic()
        left = min(now - self.seen, 0.05)
        self.seen = now
        while left > 0:  # a tenth of a millisecond at a time
            step = min(left, 1e-4)
            pull = (self.force - self.damping * self.speed) / self.mass - 9.81
            self.speed += step * pull
            self.height += step * self.speed * 1000
            left -= step
        return palpate.DeviceReading(position=(0, self.height, 0), status="ready")

    def write(self, force: NDArray[numpy.float64], torque: NDArray[numpy.float64]) -> None:
        self.force = force[1]


# Density falls with height: the level 0 is a floor at z = 0, and the device's y is up there.
heights = 15.5 - numpy.arange(32, dtype="float32")
samples = numpy.ascontiguousarray(numpy.broadcast_to(heights[:, None, None], (32, 32, 32)))
volume = palpate.Volume(samples, origin=(-15.5, -15.5, -15.5))

device = FallingMass()
transform = palpate.fit_workspace(volume.geometry, device.info())
transform.scale = 1
force_settings = palpate.ForceSettings(stiffness=1, limit=20)
renderer = palpate.Renderer(palpate.Field(volume), 0, palpate.RenderSetup(force=force_settings),
                            limits=device.info().limits, transform=transform)
with palpate.Servo(renderer, device) as servo:
    height, force = 8.0, 0.0
    # Until the spring of 1 N/mm carries the weight of 0.98 N.
    while abs(height + 0.98) + abs(force - 0.98) > 0.02 and not servo.device_problem:
        time.sleep(0.1)
        snapshot = servo.snapshot()
        if snapshot is None:
            continue
        tick = snapshot.tick
        height, force = tick.hip[2], float(numpy.linalg.norm(tick.force))
        print(f"{tick.time:.2f} s  height {height:6.2f} mm  force {force:.2f} N")
    print(servo.device_problem or f"rests at {height:.1f} mm with {force:.1f} N")
print("compute time a tick: p50 {p50} ns, p99 {p99} ns".format(**servo.report().compute))
