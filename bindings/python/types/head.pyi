"""Types of palpate, for editors and type checkers. bindings/python/types/generate.py adds those of the compiled part."""

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

from .arrays import as_volume as as_volume
from .errors import (DeviceError as DeviceError, Error as Error, InputError as InputError, OutputError as OutputError,
                     QueueFull as QueueFull, SeriesChoice as SeriesChoice)
from .trace import (Recording as Recording, Trace as Trace, read_recording as read_recording, read_trace as read_trace,
                    read_trajectory as read_trajectory, replay as replay)
