"""Volumes from arrays of any kind, by what they can do: NumPy, nibabel, zarr, h5py, dask."""

import numpy

from ._palpate import Volume

# The smallest of Palpate's sample types that holds all values of a type; else float32.
_WIDER = {"bool": "uint8", "int8": "int16"}
_KEPT = ("uint8", "int16", "uint16", "float32")


def as_volume(data, spacing=None, origin=None, direction=None, frame=None):
    """A Volume from `data`, without a copy where its samples can be shared.

    data: a Volume; a nibabel image (its affine, RAS, gives spacing, origin and direction, LPS);
    or anything with a shape that NumPy can read, indexed [z, y, x]: an array, zarr, h5py, dask.
    bool becomes uint8, int8 int16 and anything else that Palpate does not keep float32.
    spacing, origin [mm] (x, y, z) and direction (3, 3) go before what `data` says.
    frame: of four-dimensional data this one, from 0; an axis in front ([t, z, y, x]), in nibabel
    the last.
    """
    if isinstance(data, Volume):
        return data
    if hasattr(data, "affine") and hasattr(data, "dataobj"):
        samples, place = _from_nibabel(data, frame)
    else:
        samples, place = _frame_of(data, frame, axis=0), {}
    given = {"spacing": spacing, "origin": origin, "direction": direction}
    place.update({name: value for name, value in given.items() if value is not None})
    return Volume(_kept(numpy.asarray(samples)), copy=True, **place)


def _frame_of(data, frame, axis):
    axes = len(getattr(data, "shape", numpy.shape(data)))
    if axes == 4 and frame is None:
        raise ValueError("the data have four axes: choose a frame")
    if axes == 4:
        count = data.shape[axis]
        if not 0 <= frame < count:
            raise ValueError(f"frame {frame}: there are {count}, from 0")
        return data[frame] if axis == 0 else data[..., frame]
    if frame is not None:
        raise ValueError(f"the data have {axes} axes, so they have no frames")
    return data[...] if hasattr(data, "__getitem__") and hasattr(data, "shape") else data


def _from_nibabel(image, frame):
    """Samples [z, y, x] and their place: nibabel's are [x, y, z], its space is RAS."""
    samples = numpy.asanyarray(_frame_of(image.dataobj, frame, axis=3))
    affine = numpy.diag([-1.0, -1.0, 1.0, 1.0]) @ numpy.asarray(image.affine, dtype=float)
    spacing = numpy.linalg.norm(affine[:3, :3], axis=0)
    if not numpy.all(spacing > 0):
        raise ValueError("the image's affine has an axis of length 0")
    return samples.T, {"spacing": spacing, "origin": affine[:3, 3],
                       "direction": affine[:3, :3] / spacing}


def _kept(samples):
    """Of a type and byte order that a Volume takes."""
    if samples.dtype.kind not in "biuf":
        raise ValueError(f"samples of type {samples.dtype} are no numbers that can be felt")
    name = samples.dtype.name
    wanted = name if name in _KEPT else _WIDER.get(name, "float32")
    return samples.astype(wanted, copy=False)
