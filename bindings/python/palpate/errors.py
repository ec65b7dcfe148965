"""The exceptions of Palpate. Wrong arguments are Python's own ValueError and TypeError."""

from collections.abc import Sequence
from typing import Any


class Error(Exception):
    """Base of all exceptions of Palpate."""


class InputError(Error, ValueError):
    """A file could not be read or is not valid. One line: the file, what is wrong, what to do."""


class SeriesChoice(InputError):
    """A file or folder has several DICOM series. ``series`` describes each; choose one by its
    UID or number with ``load(..., series=...)``."""

    def __init__(self, message: str, series: Sequence[dict[str, Any]] = ()) -> None:
        super().__init__(message, series)
        self.series = list(series)

    def __str__(self) -> str:
        return str(self.args[0])


class OutputError(Error, OSError):
    """A file could not be written. Nothing half-written is left behind."""


class DeviceError(Error, OSError):
    """A device is not available. The message says what was looked for and what to do."""


class QueueFull(Error, RuntimeError):
    """Commands come faster than a servo carries them out; those before are still carried out."""
