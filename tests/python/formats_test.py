"""Files as other programs write them, written by hand or with other libraries: each was once refused or misread. Samples
and places are compared with those that were written."""

import os
import subprocess

import numpy
import palpate
import pytest
from readers_test import SHAPE, noted, ramp, refused


def program(*arguments):
    """All that the program says."""
    done = subprocess.run([os.environ["PALPATE"], *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    return done.stdout


# NRRD ------------------------------------------------------------------------------------------------


def nrrd(path, data, *fields):
    kinds = {"i2": "int16", "u1": "uint8", "f4": "float", "f8": "double", "i8": "int64", "u8": "uint64"}
    sizes = " ".join(str(size) for size in data.shape[::-1])
    head = (f"NRRD0005\ntype: {kinds[data.dtype.str[1:]]}\ndimension: {data.ndim}\nsizes: {sizes}\nendian: little\n"
            "encoding: raw\n")
    path.write_bytes((head + "".join(field + "\n" for field in fields) + "\n").encode() + data.tobytes())
    return path


@pytest.mark.parametrize("space", ("space dimension: 4", "space: left-posterior-superior-time", "space: RAST"))
@pytest.mark.parametrize("unit, seconds", (("", 2), ('space units: "mm" "mm" "mm" "ms"', 0.002)))
def test_nrrd_with_vectors_of_four_numbers_as_itk_writes_it(tmp_path, space, unit, seconds):
    data = ramp("i2", (3, *SHAPE))
    vectors = "space directions: (2,0,0,0) (0,2,0,0) (0,0,3,0) (0,0,0,2)"
    path = nrrd(tmp_path / "a.nrrd", data, space, vectors, "kinds: domain domain domain domain", "space origin: (1,2,3,4)",
                *([unit] if unit else []))
    for frame, expected in enumerate(data):
        loaded = palpate.load(path, frame=frame)
        assert numpy.array_equal(loaded.volume.array, expected)
    flip = -1 if space.endswith("RAST") else 1
    geometry = loaded.volume.geometry
    assert numpy.array_equal(geometry.spacing, (2, 2, 3)) and numpy.array_equal(geometry.origin, (flip, flip * 2, 3))
    assert numpy.array_equal(geometry.direction, numpy.diag([flip, flip, 1]))
    assert geometry.oriented == (space != "space dimension: 4")
    assert f"frames       from {2 * seconds} to {4 * seconds} s" in program("info", path)


@pytest.mark.parametrize("vectors", ("(2,0,0,0) (0,2,0,0) (0,0,3,1) (0,0,0,1)", "(0,0,0,1) (2,0,0,0) (0,2,0,0) (0,0,3,0)",
                                     "(2,0,0,0) (0,2,0,0) (0,0,3,0) (0,0,1,1)"))
def test_nrrd_with_times_among_its_places_is_refused(tmp_path, vectors):
    refused(nrrd(tmp_path / "a.nrrd", ramp("i2", (3, *SHAPE)), "space dimension: 4", f"space directions: {vectors}"),
            "places and times")


def test_a_slice_of_nrrd_lies_in_space(tmp_path):
    slice_ = nrrd(tmp_path / "a.nrrd", ramp("i2")[0], "space: left-posterior-superior", "space directions: (2,0,0) (0,0,3)",
                  "space origin: (1,2,3)")
    volume = palpate.load(slice_).volume
    assert numpy.array_equal(volume.array, ramp("i2")[:1]) and numpy.array_equal(volume.geometry.origin, (1, 2, 3))
    assert numpy.array_equal(volume.geometry.direction[:, :2], [[1, 0], [0, 0], [0, 1]]) and volume.geometry.oriented
