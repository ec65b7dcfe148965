"""Feel surfaces in volumetric data through a haptic device.

Lengths are mm, forces N, torques N mm, times s. Points are in the volume's physical space (LPS) or,
where it is said, in the device's axes (device mm). Arrays of samples are indexed [z, y, x],
points are x, y, z, orientations are unit quaternions x, y, z, w.
"""

from . import _palpate, arguments

arguments.complete(_palpate)

from . import notebook, settings  # noqa: E402
from ._palpate import *  # noqa: F401,F403
from ._palpate import __version__, command
from .arrays import as_volume
from .errors import DeviceError, Error, InputError, OutputError, QueueFull, SeriesChoice
from .trace import Recording, Trace, read_recording, read_trace, read_trajectory, replay

settings.complete(_palpate)
notebook.complete(_palpate)
for _kind in (DeviceError, Error, InputError, OutputError, QueueFull, Recording, SeriesChoice,
              Trace, as_volume, read_recording, read_trace, read_trajectory, replay):
    _kind.__module__ = __name__

_HELPERS = ("arguments", "arrays", "errors", "notebook", "settings", "trace")
__all__ = sorted(name for name in globals() if not name.startswith("_") and name not in _HELPERS)
