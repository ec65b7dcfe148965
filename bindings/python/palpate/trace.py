"""The result of a replay: arrays with one row per tick."""

import dataclasses
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _palpate, notebook

if TYPE_CHECKING:
    from . import Field, RenderSetup

_Path = Union[str, bytes, "os.PathLike[str]"]


@dataclasses.dataclass(repr=False, eq=False)
class Trace:
    """Arrays with a row for each tick.

    t [s]; hip and scp: hand and proxy [mm, physical], shape (n, 3); force [N], (n, 3);
    density at the SCP and isovalue [data units]; constrained: bool; tetrahedra: how many the SCP
    moved through; update_ns: time of the proxy update; layer: number of the layer touched, -1:
    none; inside: layers that the SCP is in; torque [N mm], (n, 3); hand_orientation_xyzw and
    proxy_orientation_xyzw, (n, 4); contacts: points of a tool that hold it.

    summary: numbers about all ticks, of a replay. path: (tick, corner [mm]) of the SCP's polyline. poses: (tick,
    position [mm], orientation x, y, z, w) of a tool's proxy. The last two are None unless asked for. nested_layers: so
    many of the layers, the first ones, are levels; the others are labels.
    """
    t: NDArray[numpy.float64]
    hip: NDArray[numpy.float64]
    scp: NDArray[numpy.float64]
    force: NDArray[numpy.float64]
    density: NDArray[numpy.float64]
    isovalue: NDArray[numpy.float64]
    constrained: NDArray[numpy.bool_]
    tetrahedra: NDArray[numpy.int32]
    update_ns: NDArray[numpy.int64]
    layer: NDArray[numpy.int32]
    inside: NDArray[numpy.int32]
    torque: NDArray[numpy.float64]
    hand_orientation_xyzw: NDArray[numpy.float64]
    proxy_orientation_xyzw: NDArray[numpy.float64]
    contacts: NDArray[numpy.int32]
    summary: dict[str, Any] = dataclasses.field(default_factory=dict)
    layer_names: tuple[str, ...] = ()
    nested_layers: int = 0
    has_tool: bool = False
    path: Optional[tuple[NDArray[numpy.int64], NDArray[numpy.float64]]] = None
    poses: Optional[tuple[NDArray[numpy.int64], NDArray[numpy.float64], NDArray[numpy.float64]]] = None

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self):
        return f"Trace({len(self)} ticks, {int(self.constrained.sum())} in contact)"

    def _repr_html_(self):
        return notebook.of_trace(self)

    def write(self, path: _Path) -> None:
        """Writes a CSV file, as `palpate replay` does, that read_trace() and other programs read.
        Raises OutputError; ValueError for arrays of other lengths."""
        columns = {name: getattr(self, name) for name in COLUMNS}
        _palpate._write_trace(path, columns, self.layer_names, self.nested_layers, self.has_tool)

    def plot(self, axes: Any = None) -> Any:
        """Draws force and depth of the hand below the proxy over time, with contact shaded. Needs
        Matplotlib. axes: two of it, else a new figure's. Returns them."""
        if axes is None:
            from matplotlib import pyplot
            axes = pyplot.subplots(2, sharex=True)[1]
        if numpy.size(axes) != 2:
            raise ValueError("axes: two are needed, for force and depth, as from pyplot.subplots(2)[1]")
        force, depth = axes
        force.plot(self.t, numpy.linalg.norm(self.force, axis=1))
        force.set_ylabel("force [N]")
        depth.plot(self.t, numpy.linalg.norm(self.scp - self.hip, axis=1))
        depth.set_ylabel("hand to proxy [mm]")
        depth.set_xlabel("time [s]")
        for one in axes:
            one.fill_between(self.t, 0, 1, where=self.constrained, alpha=0.15,
                             transform=one.get_xaxis_transform(), linewidth=0)
        return axes


COLUMNS = [field.name for field in dataclasses.fields(Trace)
           if field.default is field.default_factory is dataclasses.MISSING]


def replay(field: "Field", isovalue: Union[float, str], time: ArrayLike, position: ArrayLike, *,
           orientation_xyzw: Optional[ArrayLike] = None, setup: "Optional[RenderSetup]" = None, path: bool = False,
           poses: bool = False, progress: Optional[Callable[[float], Any]] = None, **settings: Any) -> Trace:
    """Renders a motion of the hand offline: the same bits as `palpate replay`.

    field: Field. isovalue: a number [data units] or '53%'. time [s], rising, shape (n,). position
    [mm, physical], shape (n, 3). orientation_xyzw: shape (n, 4), of a tool. setup: a
    RenderSetup; or its fields as keywords: method='paper', tool='sphere:2', friction=Friction(...), stiffness=0.5. progress(fraction) may raise to stop.
    Runs without the GIL. Returns a Trace.
    """
    if setup is not None and settings:
        raise TypeError("give a setup or its fields, not both")
    if setup is None:
        setup = _palpate.RenderSetup(**settings)
    return Trace(**_palpate._replay(field, isovalue, time, position, orientation_xyzw, setup, path,
                                    poses, progress))


def read_trace(path: _Path) -> Trace:
    """A trace file (CSV) as a Trace. Its layers are those that occur in the file, numbered in its order. Raises InputError."""
    return Trace(**_palpate._read_trace(path))


def read_trajectory(
        path: _Path) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], Optional[NDArray[numpy.float64]]]:
    """A motion of the hand from CSV: (time [s], position [mm], orientation x, y, z, w or
    None). Raises InputError."""
    return _palpate._read_trajectory(path)


@dataclasses.dataclass(repr=False, eq=False)
class Recording:
    """One hand of a live session as it was recorded.

    head: what it was at its start (version, begun, volume, solid, interpolation, background,
    isovalue, device, rate, method, force, friction, limits, transform). trace: its ticks; commands: for each
    command, the number of the tick that it came before. complete: not cut off; lost: events that
    the recording lost; hands: how many the recording has.
    """
    head: dict[str, Any]
    trace: Trace
    commands: NDArray[numpy.int64]
    complete: bool
    lost: int
    hands: int = 1

    def __repr__(self):
        return f"Recording({len(self.trace)} ticks, {len(self.commands)} commands)"


def read_recording(path: _Path, hand: int = 1) -> Recording:
    """A recording as a Recording; hand: which one of several, from 1. Raises InputError; validate() renders it again."""
    head, table, commands, complete, lost, hands = _palpate._read_recording(path, hand)
    return Recording(head, Trace(**table), commands, complete, lost, hands)
