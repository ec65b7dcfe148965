"""What a replay gives: arrays, one row a tick."""

import dataclasses

import numpy

from . import _palpate
from ._palpate import RenderSetup


@dataclasses.dataclass(repr=False, eq=False)
class Trace:
    """Arrays with a row for each tick.

    t [s]; hip and scp: hand and proxy [mm, physical], shape (n, 3); force [N], (n, 3);
    density at the SCP and isovalue [data units]; constrained: bool; tetrahedra: how many the SCP
    moved through; update_ns: time of the proxy update; layer: number of the layer touched, -1:
    none; inside: layers that the SCP is in; torque [N mm], (n, 3); hand_orientation and
    proxy_orientation: w, x, y, z, (n, 4); contacts: points of a tool that hold it.

    summary: numbers about all ticks. path: (tick, corner [mm]) of the SCP's polyline. poses: (tick,
    position [mm], orientation) of a tool's proxy. Both are None unless asked for.
    """
    t: numpy.ndarray
    hip: numpy.ndarray
    scp: numpy.ndarray
    force: numpy.ndarray
    density: numpy.ndarray
    isovalue: numpy.ndarray
    constrained: numpy.ndarray
    tetrahedra: numpy.ndarray
    update_ns: numpy.ndarray
    layer: numpy.ndarray
    inside: numpy.ndarray
    torque: numpy.ndarray
    hand_orientation: numpy.ndarray
    proxy_orientation: numpy.ndarray
    contacts: numpy.ndarray
    summary: dict = None
    layer_names: tuple = ()
    has_tool: bool = False
    path: tuple = None
    poses: tuple = None

    def __len__(self):
        return len(self.t)

    def __repr__(self):
        return f"Trace({len(self)} ticks, {int(self.constrained.sum())} in contact)"


def replay(field, isovalue, time, position, orientation=None, *, setup=None, path=False,
           poses=False, progress=None, **settings):
    """Renders a motion of the hand offline: the same bits as `palpate replay`.

    field: Field. isovalue: a number [data units] or '53%'. time [s], rising, shape (n,). position
    [mm, physical], shape (n, 3). orientation: w, x, y, z, shape (n, 4), of a tool. setup: a
    RenderSetup; or its fields as keywords: method='paper', tool='sphere:2', friction=Friction(...), stiffness=0.5. progress(fraction) may raise to stop.
    Runs without the GIL. Returns a Trace.
    """
    if setup is not None and settings:
        raise TypeError("give a setup or its fields, not both")
    if setup is None:
        setup = RenderSetup(**settings)
    return Trace(**_palpate._replay(field, isovalue, time, position, orientation, setup, path,
                                    poses, progress))


def read_trace(path):
    """A trace file (CSV) as a Trace. Raises InputError."""
    return Trace(**_palpate._read_trace(path))


def read_trajectory(path):
    """A motion of the hand from CSV: (time [s], position [mm], orientation or None). Raises
    InputError."""
    return _palpate._read_trajectory(path)


@dataclasses.dataclass(repr=False, eq=False)
class Recording:
    """A live session as it was recorded.

    head: what it was at its start (version, begun, volume, solid, interpolation, background,
    isovalue, device, rate, method, force, limits, transform). trace: its ticks; commands: for each
    command, the number of the tick that it came before. complete: not cut off; lost: events that
    the recording lost.
    """
    head: dict
    trace: Trace
    commands: numpy.ndarray
    complete: bool
    lost: int

    def __repr__(self):
        return f"Recording({len(self.trace)} ticks, {len(self.commands)} commands)"


def read_recording(path):
    """A recording as a Recording. Raises InputError; validate() renders it again."""
    head, table, commands, complete, lost = _palpate._read_recording(path)
    return Recording(head, Trace(**table), commands, complete, lost)
