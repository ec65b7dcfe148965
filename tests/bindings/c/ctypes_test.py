#!/usr/bin/env python3
"""The C interface from Python's ctypes: structs laid out by hand, a callback device whose functions
run on a foreign thread, and snapshots."""

import ctypes
import sys
import time
from ctypes import POINTER, byref, c_char_p, c_double, c_int32, c_int64, c_uint32, c_uint64, c_void_p

library = ctypes.CDLL(sys.argv[1])
library.palpate_last_error.restype = c_char_p


class Geometry(ctypes.Structure):
    _fields_ = [("size_of", c_uint32), ("size", c_int32 * 3), ("spacing", c_double * 3),
                ("origin", c_double * 3), ("direction", c_double * 9)]


class RenderOptions(ctypes.Structure):
    _fields_ = [("size_of", c_uint32), ("has_isovalue", c_int32), ("isovalue", c_double),
                ("stiffness", c_double), ("damping", c_double), ("viscosity", c_double),
                ("force_limit", c_double), ("static_friction", c_double),
                ("dynamic_friction", c_double), ("penetration", c_double), ("scale", c_double),
                ("rate", c_double), ("tool", c_char_p), ("layers", c_char_p)]


class Reading(ctypes.Structure):
    _fields_ = [("size_of", c_uint32), ("status", c_int32), ("position", c_double * 3),
                ("orientation", c_double * 4), ("age", c_double), ("buttons", c_uint32),
                ("unused", c_uint32)]


class Wrench(ctypes.Structure):
    _fields_ = [("size_of", c_uint32), ("unused", c_int32), ("force", c_double * 3),
                ("torque", c_double * 3)]


READ = ctypes.CFUNCTYPE(c_int32, POINTER(Reading), c_void_p)
WRITE = ctypes.CFUNCTYPE(c_int32, POINTER(Wrench), c_void_p)
CLOSE = ctypes.CFUNCTYPE(None, c_void_p)


class OwnDevice(ctypes.Structure):
    _fields_ = [("size_of", c_uint32), ("buttons", c_int32), ("name", c_char_p),
                ("model", c_char_p), ("maximum_force", c_double), ("maximum_torque", c_double),
                ("stiffness", c_double), ("physical_damping", c_double),
                ("workspace_low", c_double * 3), ("workspace_high", c_double * 3),
                ("rate", c_double), ("has_orientation", c_int32), ("unused", c_int32),
                ("read", READ), ("write", WRITE), ("close", CLOSE), ("context", c_void_p)]


class RunOptions(ctypes.Structure):
    _fields_ = [("size_of", c_uint32), ("facing", c_int32), ("field", c_void_p),
                ("render", POINTER(RenderOptions)), ("device", c_char_p),
                ("own", POINTER(OwnDevice)), ("recording", c_char_p), ("no_real_time", c_int32),
                ("deadman_button", c_int32), ("progress", c_void_p), ("context", c_void_p)]


class Felt(ctypes.Structure):
    _fields_ = [("size_of", c_uint32), ("mode", c_int32), ("status", c_int32),
                ("contacts", c_int32), ("time", c_double), ("hip", c_double * 3),
                ("scp", c_double * 3), ("force", c_double * 3), ("torque", c_double * 3),
                ("hand", c_double * 4), ("proxy", c_double * 4), ("density", c_double),
                ("isovalue", c_double), ("layer", c_int32), ("inside", c_int32)]


class SnapshotBegin(ctypes.Structure):
    """A struct of an earlier version: it ends after `felt`."""
    _fields_ = [("size_of", c_uint32), ("device_status", c_int32), ("number", c_int64),
                ("missed", c_int64), ("version", c_uint64), ("felt", Felt)]


def sized(kind):
    return kind(size_of=ctypes.sizeof(kind))


def check(status):
    if status != 0:
        raise RuntimeError(f"status {status}: {library.palpate_last_error().decode()}")


def ball():
    samples = (ctypes.c_uint8 * 64 ** 3)()
    for k in range(64):
        for j in range(64):
            for i in range(64):
                r = ((i - 31.5) ** 2 + (j - 31.5) ** 2 + (k - 31.5) ** 2) ** 0.5
                samples[i + 64 * (j + 64 * k)] = max(0, int(250 - 5 * r))
    geometry = sized(Geometry)
    geometry.size[:] = [64] * 3
    geometry.origin[:] = [-31.5] * 3
    volume = c_void_p()
    check(library.palpate_volume_copy(byref(geometry), 0, samples, ctypes.c_size_t(64 ** 3),
                                      byref(volume)))
    return volume


def main():
    data, run = c_void_p(), c_void_p()
    volume = ball()
    check(library.palpate_data_create(volume, byref(data)))
    library.palpate_volume_destroy(volume)
    depth, step, forces, closed = 35.0, -0.02, [], []

    def read(reading, _):
        nonlocal depth, step
        # In and out: after a tick that took too long, forces wait for a hand that comes anew.
        if not 26 < depth + step <= 35:
            step = -step
        depth += step
        reading.contents.status = 1
        reading.contents.position[2] = depth
        return 0

    def write(wrench, _):
        forces.append(wrench.contents.force[2])
        return 0

    own = sized(OwnDevice)
    own.name, own.maximum_force, own.rate = b"python", 2, 500
    own.read, own.write, own.close = READ(read), WRITE(write), CLOSE(lambda _: closed.append(1))
    render = sized(RenderOptions)
    render.has_isovalue, render.isovalue, render.scale, render.stiffness = 1, 100, 1, 0.4
    options = sized(RunOptions)
    options.render, options.own, options.no_real_time = ctypes.pointer(render), ctypes.pointer(own), 1
    check(library.palpate_run_create(data, byref(options), byref(run)))
    check(library.palpate_run_start(run))
    # On a busy machine a reading may be older than 20 ms every time, and the force would never rise.
    check(library.palpate_run_set(run, b"force.stale_after", c_double(3600)))
    snapshot = sized(SnapshotBegin)
    while max(map(abs, forces), default=0) < 0.5 or sum(f * f for f in snapshot.felt.force) < 0.25:  # however long a busy machine takes
        time.sleep(1 / 60)
        if library.palpate_run_snapshot(run, byref(snapshot)) not in (0, 7):
            raise RuntimeError(library.palpate_last_error().decode())
    assert max(map(abs, forces)) <= 2, "the device's limit"
    assert snapshot.felt.mode == 1 and snapshot.number > 0
    radius = sum(c * c for c in snapshot.felt.scp) ** 0.5
    assert abs(radius - 30) < 0.3, radius
    assert library.palpate_run_set_isovalue(run, c_double(float("nan"))) == 1
    assert library.palpate_last_error()
    library.palpate_run_destroy(run)
    assert closed == [1] and forces[-1] == 0, "the last force is zero, then the device is closed"
    library.palpate_data_destroy(data)
    print(f"proxy at {radius:.2f} mm, largest force {max(map(abs, forces)):.2f} N")


for function in ("palpate_volume_destroy", "palpate_run_destroy", "palpate_data_destroy"):
    getattr(library, function).argtypes = [c_void_p]
    getattr(library, function).restype = None
main()
