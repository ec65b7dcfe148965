"""Folders of TIFF slices: their order by the numbers in their names, and refused ones."""

import numpy
import palpate
import pytest
import tifffile
from readers_test import refused


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
    (["t1", "t2", "t3"], "count times"), (["s1_a", "s1_b"], ""), (["1", "3", "5"], "")))
def test_numbers_that_go_together_are_slices(tmp_path, names, note):
    values, notes = slices_of(folder(tmp_path / "a", names))
    assert values == list(range(len(names)))
    assert all((word in notes) == (word in note) for word in ("not alike", "count times"))


@pytest.mark.parametrize("names, words", (
    (["1", "2", "4"], "1 is missing"), (["2", "4", "8"], "1 is missing"), (["z1_c1", "z2_c1", "z5_c1"], "2 are missing"),
    (["z1_t1", "z1_t2", "z2_t1", "z2_t2", "z4_t1", "z4_t2"], "1 is missing"),
    (["1", "9000000000000000000", "9000000000000000001"], "are missing")))
def test_a_folder_that_lacks_slices_is_refused(tmp_path, names, words):
    refused(folder(tmp_path / "a", names), words, "copy the missing slices")


@pytest.mark.parametrize("names", (["s1", "s01", "s2"], ["s1", "s01"], ["img_0", "img_0_mask", "img_1", "img_1_mask"]))
def test_a_number_that_two_slices_have_is_refused(tmp_path, names):
    refused(folder(tmp_path / "a", names), "the same numbers", "folder of their own")


def calibrated(path, *slices):
    """A folder of slices as ImageJ writes them, each with lines of its own and so many pixels per micrometre."""
    path.mkdir()
    for z, (lines, resolution) in enumerate(slices):
        tifffile.imwrite(path / f"s{z}.tif", numpy.full((4, 6), 10 * z, "u1"), photometric="minisblack", metadata=None,
                         description="ImageJ=1.53t\nunit=um\n" + lines, resolution=resolution)
    return path


def test_a_folder_of_slices_without_a_distance_has_no_known_spacing(tmp_path):
    loaded = palpate.load(calibrated(tmp_path / "a", ("", (2, 2)), ("", (2, 2))))
    assert not loaded.volume.geometry.measured and "distance between slices" in " ".join(loaded.notes)
    told = palpate.load(calibrated(tmp_path / "b", ("spacing=3\n", (2, 2)), ("spacing=3\n", (2, 2)))).volume.geometry
    assert told.measured and numpy.allclose(told.spacing, (5e-4, 5e-4, 3e-3))
    ome = tmp_path / "c"
    ome.mkdir()
    for z in range(2):
        tifffile.imwrite(ome / f"s{z}.ome.tif", numpy.full((4, 6), z, "u1"), metadata={"axes": "YX", "PhysicalSizeX": 0.5})
    loaded = palpate.load(ome)
    assert not loaded.volume.geometry.measured and "without the OME-XML, 1 mm" in " ".join(loaded.notes)


def test_slices_of_several_calibrations_are_refused(tmp_path):
    line = "spacing=2\ncf=0\nc0=0\nc1={}\n".format
    refused(calibrated(tmp_path / "a", (line(1), (2, 2)), (line(2), (2, 2))), "'s1.tif' has another calibration")
    values, _ = slices_of(calibrated(tmp_path / "b", (line(3), (2, 2)), (line(3), (2.0001, 2))))
    assert values == [0, 30]
    other = calibrated(tmp_path / "c", ("spacing=2\n", (2, 2)), ("spacing=2\n", (2, 3)))
    refused(other, "'s1.tif' has a spacing of 0.000333333 mm along y, the first slice of 0.0005 mm", "give the spacing")
    assert numpy.allclose(palpate.load(other, spacing=(1, 2, 3)).volume.geometry.spacing, (1, 2, 3))
