"""Volumes from arrays of any kind, by what they can do: NumPy, nibabel, zarr, h5py, dask."""

import copy
import operator
import warnings
from typing import TYPE_CHECKING, Any, Optional

import numpy
from numpy.typing import ArrayLike

from . import _palpate

if TYPE_CHECKING:
    from . import Volume
else:
    from ._palpate import Volume

# The smallest of Palpate's sample types that holds all values of a type; else float32.
_WIDER = {"bool": "uint8", "int8": "int16"}
_KEPT = ("uint8", "int16", "uint16", "float32")


def as_volume(data: Any, spacing: Optional[ArrayLike] = None, origin: Optional[ArrayLike] = None,
              direction: Optional[ArrayLike] = None, frame: Optional[int] = None) -> Volume:
    """A Volume from `data`, without a copy where its samples can be shared.

    data: a Volume; a nibabel image of any format (its affine, RAS, gives spacing, origin and
    direction, LPS); or anything with a shape that NumPy can read, indexed [z, y, x]: an array,
    zarr, h5py, dask. Dimensions that are named x, y and z, as xarray's are, may have any order.
    bool becomes uint8, int8 int16 and anything else that Palpate does not keep float32, with a
    warning where whole numbers change or differences between samples are lost. NaN and infinity
    become the least finite sample, with a warning. An array with masked elements is a
    ValueError: fill them first.
    spacing, origin [mm] (x, y, z) and direction (3, 3) go before what `data` says. Coordinates of
    dimensions, as xarray has them, are not used, with a warning: their unit is not known.
    frame: of four-dimensional data this one, from 0; an axis in front ([t, z, y, x]), in nibabel
    the last. It is not needed if there is only one, and further axes may have a length of 1.
    """
    given = {"spacing": spacing, "origin": origin, "direction": direction}
    given = {name: value for name, value in given.items() if value is not None}
    if isinstance(data, Volume):
        if frame is not None:
            raise ValueError("a Volume has three axes, so it has no frames")
        return _placed(data, given) if given else data
    if hasattr(data, "affine") and hasattr(data, "dataobj"):
        samples, place = _from_nibabel(data, frame)
    else:
        _tell_of_coordinates(data, given)
        samples, place = _frame_of(data, frame, axis=0), {}
    assumed = place.pop("assumed", False)
    volume = Volume(_kept(numpy.asanyarray(samples)), copy=None, **{**place, **given})
    if not assumed:
        return volume
    geometry = copy.copy(volume.geometry)
    geometry.measured, geometry.oriented = "spacing" in given, "direction" in given
    return volume._placed(geometry)


def _placed(volume, given):
    """The same samples, with this in place of what the volume says."""
    place = copy.copy(volume.geometry)
    for name, value in given.items():
        setattr(place, name, value)
    place.measured |= "spacing" in given
    place.oriented |= "direction" in given
    return volume._placed(place)


def _in_order(data):
    """With the axes z, y and x last, if they have these names."""
    names = getattr(data, "dims", ())
    names = [name.lower() if isinstance(name, str) else name for name in names] if isinstance(names, tuple) else []
    if len(set(names)) != len(names) or not {"z", "y", "x"} <= set(names):
        return data
    order = [axis for axis, name in enumerate(names) if name not in ("z", "y", "x")]
    order += [names.index(name) for name in "zyx"]
    return data if order == sorted(order) else numpy.asanyarray(data).transpose(order)


def _tell_of_coordinates(data, given):
    """Warns if the dimensions x, y and z have coordinates other than 0, 1, 2, ... in place of which nothing is given."""
    coordinates = getattr(data, "coords", None)
    names = getattr(data, "dims", ())
    if not hasattr(coordinates, "keys") or not isinstance(names, tuple) or {"spacing", "origin"} <= set(given):
        return
    unused = []
    for name in names:
        if isinstance(name, str) and name.lower() in ("x", "y", "z") and name in coordinates.keys():
            values = numpy.asarray(coordinates[name])
            if not numpy.array_equal(values, numpy.arange(len(values))):
                unused.append(name)
    if unused:
        warnings.warn(f"the coordinates of {', '.join(unused)} were not used: give spacing and origin in mm", stacklevel=3)


def _frame_of(data, frame, axis):
    data = _in_order(data)
    if hasattr(data, "__dlpack__") and not hasattr(data, "__array__"):
        data = numpy.from_dlpack(data)
    if not hasattr(data, "shape") or isinstance(data, memoryview):
        data = numpy.asanyarray(data)
    shape = data.shape if axis == 0 else data.shape[::-1]  # the three of space come last
    beyond = len(shape) - 4
    if beyond > 0 and all(length == 1 for length in shape[:beyond]):
        data, shape = data[(0,) * beyond if axis == 0 else (..., *(0,) * beyond)], shape[beyond:]
    if len(shape) == 4 and frame is None:
        if shape[0] != 1:
            raise ValueError("the data have four axes: choose a frame")
        frame = 0
    if len(shape) == 4:
        frame, count = operator.index(frame), shape[0]
        if not 0 <= frame < count:
            raise ValueError(f"frame {frame}: there are {count}, from 0")
        return data[frame] if axis == 0 else data[..., frame]
    if frame is not None:
        raise ValueError(f"the data have {len(shape)} axes, so they have no frames")
    return data[...] if hasattr(data, "__getitem__") else data


def _from_nibabel(image, frame):
    """Samples [z, y, x] and their place: nibabel's are [x, y, z], its space is RAS. Frames of MINC come first."""
    frames_first = getattr(image.header, "data_layout", "F") == "C"
    samples = numpy.asanyarray(_frame_of(image.dataobj, frame, axis=0 if frames_first else 3))
    shape = (*samples.shape, 1, 1, 1)[:3]
    if _lacks_place(image):
        _warn("the image's file does not give its place (goodRASFlag): 1 mm was taken along every axis, and coronal slices "
              "around the origin, as FreeSurfer does")
        direction = numpy.array([[1.0, 0, 0], [0, 0, -1], [0, -1, 0]])
        origin = -0.5 * direction @ numpy.array(shape)
        return samples.T, {"spacing": (1, 1, 1), "origin": origin, "direction": direction, "assumed": True}
    affine, placed = _affine_of(image, shape)
    affine = numpy.diag([-1.0, -1.0, 1.0, 1.0]) @ affine
    spacing = numpy.linalg.norm(affine[:3, :3], axis=0)
    if not numpy.all(spacing > 0):
        raise ValueError("the image's affine has an axis of length 0")
    place = {"spacing": spacing, "origin": affine[:3, 3]}
    if placed:
        place["direction"] = _direction_of(affine, spacing, shape)
    return samples.T, place


def _lacks_place(image):
    """Whether an MGH file says that it gives no place. nibabel replaces this by a place of its own in the header."""
    if not hasattr(image.header, "keys") or "goodRASFlag" not in image.header.keys():
        return False
    try:
        with image.file_map["image"].get_prepare_fileobj("rb") as file:
            return int.from_bytes(file.read(30)[28:], "big", signed=True) <= 0
    except Exception:  # it was not read from a file, or that is gone
        return False


LENGTHS = {0: 1.0, 1: 1000.0, 2: 1.0, 3: 1e-3}  # [mm] of the units that NIfTI has


def _affine_of(image, shape):
    """Index to RAS [mm], chosen as load() chooses it for a NIfTI file (docs/io.md), and whether the image
    says it."""
    header = image.header
    is_nifti = hasattr(header, "get_qform")
    is_analyze = not is_nifti and hasattr(header, "keys") and "pixdim" in header.keys()
    if is_nifti:
        affine = numpy.asarray(image.affine, dtype=float)
        placed = header["sform_code"] > 0 or header["qform_code"] > 0
        placed = placed or image.affine is not None and not numpy.allclose(affine, header.get_base_affine())
    elif is_analyze:  # it has no orientation; SPM keeps one in a file .mat
        affine = numpy.asarray(image.affine, dtype=float)
        placed = "mat" in dict(image.files_types) and not numpy.allclose(affine, header.get_best_affine())
    else:
        placed = image.affine is not None
        affine = numpy.asarray(image.affine, dtype=float) if placed else numpy.eye(4)
    if not placed:
        _warn("the image's header says nothing of its orientation in the body: its axes were taken as those of LPS")
        affine = numpy.diag([-1.0, -1.0, 1.0, 1.0]) @ numpy.diag([*header.get_zooms()[:3], 1.0])
    elif is_nifti and header["qform_code"] > 0 and _has_no_spacings(affine, header["pixdim"][1:4], shape):
        _warn("the image's affine has axes of length 1, but its header gives other spacings: its qform was taken")
        affine = header.get_qform()
    elif is_nifti and header["qform_code"] > 0 and _is_sheared(affine, shape):
        _warn("the image's affine is sheared, which a grid cannot be: its qform was taken")
        affine = header.get_qform()
    if not is_nifti:
        return affine, placed
    code = int(header["xyzt_units"]) & 7
    if code not in LENGTHS:
        _warn(f"the image's unit of length '{code}' is not known: mm were taken")
    unit = LENGTHS.get(code, 1.0)
    return numpy.diag([unit, unit, unit, 1.0]) @ affine, placed


def _warn(what):
    warnings.warn(what, stacklevel=5)


def _has_no_spacings(affine, given, shape):
    """Whether the axes are of length 1 where a NIfTI header gives other spacings."""
    lengths = numpy.linalg.norm(affine[:3, :3], axis=0)
    other = [size > 1 and abs(spacing) > 0 and abs(abs(spacing) - 1) > 0.01 for size, spacing in zip(shape, given)]
    return numpy.abs(lengths - 1).max() <= 1e-4 and any(other)


def _is_sheared(affine, shape):
    spacing = numpy.linalg.norm(affine[:3, :3], axis=0)
    return _palpate._straightened(shape, spacing, affine[:3, :3] / spacing) is None


def _direction_of(affine, spacing, shape):
    nearest = _palpate._straightened(shape, spacing, affine[:3, :3] / spacing)
    if nearest is None:
        return affine[:3, :3] / spacing  # Volume refuses it
    direction, moved = nearest
    if moved > 0:
        _warn("the image's axes are not quite at right angles: the nearest grid with right angles was taken, whose samples lie "
              f"up to {moved:.6g} mm from the image's")
    return direction


def _finite(samples):
    """NaN and infinity become the least finite sample, as load() does it. Slice by slice, as in _kept()."""
    count = sum(part.size - numpy.count_nonzero(numpy.isfinite(part)) for part in samples)
    if count in (0, samples.size):  # of the latter a Volume says that none is finite
        return samples
    warnings.warn(f"{count} samples were not finite (NaN, infinity or beyond 3.4e38) and became the least finite "
                  "value", stacklevel=4)
    least = min(part[numpy.isfinite(part)].min(initial=numpy.inf) for part in samples)
    finite = numpy.empty(samples.shape, samples.dtype)
    for part, made in zip(samples, finite):
        made[...] = numpy.where(numpy.isfinite(part), part, least)
    return finite


def _tell_of_loss(samples, made):
    """Warns if samples and what float32 made of them differ by more than its rounding of their range."""
    if samples.dtype.kind != "f":
        changed = sum(numpy.count_nonzero(to.astype(part.dtype) != part) for part, to in zip(samples, made))
        if changed:
            warnings.warn(f"{changed} whole numbers beyond 16777216 were rounded: float32 does not hold them, so "
                          "different ones may have become equal", stacklevel=4)
        return
    least, most, error, beyond, finite = numpy.inf, -numpy.inf, 0, 0, 0
    for part, to in zip(samples, made):
        is_finite = numpy.isfinite(part)
        held = is_finite & numpy.isfinite(to)
        finite += numpy.count_nonzero(is_finite)
        beyond += numpy.count_nonzero(is_finite) - numpy.count_nonzero(held)
        least = min(least, part.min(initial=numpy.inf, where=held))
        most = max(most, part.max(initial=-numpy.inf, where=held))
        error = max(error, numpy.abs(part - to).max(initial=0, where=held))
    if beyond and beyond == finite:
        raise ValueError("the samples are beyond 3.4e38, the largest number of float32: scale them first")
    if error > 1e-6 * (most - least if most > least else abs(most)):
        warnings.warn(f"samples of type {samples.dtype} became float32, which changed them by up to {error:.3g}, where they lie "
                      f"between {least:.6g} and {most:.6g}: subtract an offset or scale them first", stacklevel=4)


def _kept(samples):
    """Of a type and byte order that a Volume takes. Slice by slice, so that Ctrl-C stops it."""
    if samples.dtype.kind not in "biuf":
        raise ValueError(f"samples of type {samples.dtype} are no numbers that can be felt")
    name = samples.dtype.name
    wanted = name if name in _KEPT else _WIDER.get(name, "float32")
    if samples.ndim != 3 or numpy.ma.is_masked(samples):  # Volume refuses them
        return samples.astype(wanted, copy=False)
    samples = numpy.asarray(samples)
    if samples.dtype != wanted:
        made = numpy.empty(samples.shape, wanted)
        with numpy.errstate(over="ignore", under="ignore", invalid="ignore"):
            for part, to in zip(samples, made):
                to[...] = part
            if wanted == "float32":
                _tell_of_loss(samples, made)
        samples = made
    return _finite(samples) if wanted == "float32" else samples
