"""Files as other programs write them, written by hand or with other libraries: each was once refused or misread. Samples
and places are compared with those that were written."""

import os
import subprocess

import numpy
import palpate
import pytest
import tifffile
from readers_test import SHAPE, noted, ramp, refused, save, slice_of


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


# Folders of TIFF slices ---------------------------------------------------------------------------------


def folder(path, names):
    """A folder with a TIFF slice of each name; all samples of a slice are its number in the list."""
    path.mkdir()
    for number, name in enumerate(names):
        tifffile.imwrite(path / f"{name}.tif", numpy.full((4, 5), number, "u2"), photometric="minisblack")
    return path


def slices_of(path, **options):
    loaded = palpate.load(path, **options)
    return loaded.volume.array[:, 0, 0].tolist(), " ".join(loaded.notes)


@pytest.mark.parametrize("name", ("img_z{z:03}_ch{c:02}", "ch{c}_{z}", "img_T{t:03}_z{z:03}_c{c:03}", "a_z{z}c{c}",
                                  "img_channel{c:03}_position000_time{t:09}_z{z:03}", "t{t}_slice{z}", "w{c}DAPI_{z}_t{t}"))
def test_names_of_slices_tell_channels_and_times(tmp_path, name):
    planes = [(t, c, z) for t in range(2 if "{t" in name else 1) for c in range(2 if "{c" in name else 1) for z in range(8, 13)]
    path = folder(tmp_path / "a", [name.format(t=t, c=c, z=z) for t, c, z in planes])
    for time in range(2 if "{t" in name else 1):
        values, notes = slices_of(path, frame=time)
        assert values == [number for number, (t, c, _) in enumerate(planes) if (t, c) == (time, 0)]
        assert ("2 channels" in notes) == ("{c" in name) and ("of 2" in notes) == ("{t" in name)
    assert palpate.load(path).time_steps == (2 if "{t" in name else 1)


@pytest.mark.parametrize("names, words", (
    (["a1", "a2", "b1", "b2"], "not certain"), (["1_1", "1_2", "2_1", "2_2"], "not certain"),
    (["t1_c1", "t1_c2", "t2_c1", "t2_c2"], "not certain"), (["z1_c1", "z1_c2", "z2_c1"], "count 4"),
    (["z1_s1", "z1_s2", "z2_s1", "z2_s2"], "not certain"), (["1_c1", "1_c2", "2_c1", "3_c2"], "count 6")))
def test_names_of_slices_that_leave_a_doubt_are_refused(tmp_path, names, words):
    refused(folder(tmp_path / "a", names), words, "folder of their own")


@pytest.mark.parametrize("names, note", (
    (["a9", "a10", "a11"], ""), (["s1_1", "s1_2", "s2_3", "s2_4"], ""), (["0001_z1.25", "0001_z1.5", "0001_z2.0"], ""),
    (["20240101_120301_001", "20240101_120305_002", "20240101_120311_003"], ""), (["scan.001.0001", "scan.001.0002"], ""),
    (["z1_t1200", "z2_t1200", "z3_t1201"], ""), (["a", "b", "c"], ""), (["one", "slice1", "slice2"], "not alike"),
    (["t1", "t2", "t3"], "count times"), (["1", "2", "4"], "1 numbers are missing"), (["1", "3", "5"], "")))
def test_numbers_that_go_together_are_slices(tmp_path, names, note):
    values, notes = slices_of(folder(tmp_path / "a", names))
    assert values == list(range(len(names)))
    assert all((word in notes) == (word in note) for word in ("not alike", "count times", "numbers are missing"))


def test_hidden_files_are_no_slices(tmp_path):
    path = folder(tmp_path / "a", ["a1", "a2", ".a0"])
    (path / "._a1.tif").write_bytes(b"\0\5\x16\7\0\2\0\0Mac OS X        " + bytes(100))
    (path / "._b.nrrd").write_bytes(b"\0\5\x16\7\0\2\0\0Mac OS X        " + bytes(100))
    assert slices_of(path)[0] == [0, 1]
    assert slices_of(path / ".a0.tif")[0] == [2]  # given by its name
    refused(folder(tmp_path / "b", [".a1", ".a2"]), "no DICOM or TIFF slices")
    path = save(tmp_path / "c", [slice_of(ramp("i2")[z], z, (0, 0, z)) for z in range(3)])
    (path / ".002.dcm.x7Gf2").write_bytes((path / "002.dcm").read_bytes()[:700])  # as rsync writes it
    assert numpy.array_equal(palpate.load(path).volume.array, ramp("i2")[:3])
