"""Types of palpate, for editors and type checkers: what is written in Python. bindings/python/types/generate.py adds
those of the compiled part."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Optional, Protocol, Union, overload

import numpy
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self

__version__: str
_Path = Union[str, bytes, PathLike[str]]

BALL_VOXEL: float
FORCE_FLAGS: dict[str, int]
STEP_KINDS: tuple[str, ...]
SAMPLE_BONE: float
SAMPLE_SKIN: float

class _Device(Protocol):
    def info(self) -> DeviceInfo: ...
    def read(self) -> DeviceReading: ...

class Error(Exception): ...
class InputError(Error, ValueError): ...
class SeriesChoice(InputError):
    series: list[dict[str, Any]]
    def __init__(self, message: str, series: Sequence[dict[str, Any]] = ()) -> None: ...
class OutputError(Error, OSError): ...
class DeviceError(Error, OSError): ...
class QueueFull(Error, RuntimeError): ...

@dataclasses.dataclass
class Trace:
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
    summary: dict[str, Any] = ...
    layer_names: tuple[str, ...] = ()
    nested_layers: int = 0
    has_tool: bool = False
    path: Optional[tuple[NDArray[numpy.int64], NDArray[numpy.float64]]] = None
    poses: Optional[tuple[NDArray[numpy.int64], NDArray[numpy.float64],
                          NDArray[numpy.float64]]] = None
    def __len__(self) -> int: ...
    def write(self, path: _Path) -> None: ...
    def plot(self, axes: Any = None) -> Any: ...

@dataclasses.dataclass
class Recording:
    head: dict[str, Any]
    trace: Trace
    commands: NDArray[numpy.int64]
    complete: bool
    lost: int
    hands: int

def as_volume(data: Any, spacing: Optional[ArrayLike] = None, origin: Optional[ArrayLike] = None,
              direction: Optional[ArrayLike] = None, frame: Optional[int] = None) -> Volume: ...
def replay(field: Field, isovalue: Union[float, str], time: ArrayLike, position: ArrayLike,
           *, orientation_xyzw: Optional[ArrayLike] = None, setup: Optional[RenderSetup] = None,
           path: bool = False, poses: bool = False,
           progress: Optional[Callable[[float], Any]] = None, **settings: Any) -> Trace: ...
def read_trace(path: _Path) -> Trace: ...
def read_trajectory(path: _Path) -> tuple[
    NDArray[numpy.float64], NDArray[numpy.float64], Optional[NDArray[numpy.float64]]]: ...
def read_recording(path: _Path, hand: int = 1) -> Recording: ...
