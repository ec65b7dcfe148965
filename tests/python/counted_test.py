"""TIFF files whose pages are times and channels as well as slices, as microscopes and tifffile count them. Each is compared
with tifffile, which reads the same headers."""

import struct

import numpy
import palpate
import pytest
import tifffile
from readers_test import noted, ramp, refused

PLANE = (4, 6)  # y, x
UNKNOWN_SPACING = "does not tell its spacing"


def lsm(path, pages, slices, times, scan=0, metres=(2e-7, 3e-7, 1e-6), seconds=0.5):
    """Each page is followed by its thumbnail. The structure is that of Zeiss, up to the time between two times."""
    header = struct.pack("<Ii8i6d2HI4Id", 0x0400494C, 120, *PLANE[::-1], slices, 1, times, 2, 3, 2, *metres, 0, 0, 0, scan, 0, 0,
                         0, 0, 0, 0, seconds)
    with tifffile.TiffWriter(path) as file:
        for number, page in enumerate(pages):
            tags = [(34412, 1, len(header), header, True)] if number == 0 else []
            file.write(page, metadata=None, contiguous=False, photometric="minisblack", extratags=tags, software=False)
            file.write(numpy.zeros((2, 3), "u1"), metadata=None, contiguous=False, photometric="minisblack", subfiletype=1)
    return path


def test_an_lsm_has_the_spacing_of_its_header(tmp_path):
    data = ramp("u2", (5, *PLANE))
    loaded = palpate.load(lsm(tmp_path / "a.lsm", data, 5, 1))
    assert numpy.array_equal(loaded.volume.array, data) and loaded.notes == []
    assert numpy.allclose(loaded.volume.geometry.spacing, (2e-4, 3e-4, 1e-3), rtol=1e-6)
    assert tifffile.TiffFile(tmp_path / "a.lsm").lsm_metadata["VoxelSizeZ"] == 1e-6
    noted(lsm(tmp_path / "b.lsm", data, 5, 1, metres=(0, 0, 0)), UNKNOWN_SPACING)


@pytest.mark.parametrize("scan, slices_first", ((6, True), (3, False)))
def test_times_of_an_lsm_are_no_slices(tmp_path, scan, slices_first):
    data = ramp("u2", (2, 3, *PLANE))  # t, z
    pages = (data if slices_first else data.swapaxes(0, 1)).reshape(6, *PLANE)
    path = lsm(tmp_path / "a.lsm", pages, 3, 2, scan)
    for time, expected in enumerate(data):
        loaded = palpate.load(path, frame=time)
        assert numpy.array_equal(loaded.volume.array, expected)
        assert any(f"time step {time} of 2" in note for note in loaded.notes)


def test_an_lsm_of_another_number_of_pages_is_refused(tmp_path):
    refused(lsm(tmp_path / "a.lsm", ramp("u2", (5, *PLANE)), 5, 2), "5 slices, 1 channels and 2 times, but has 5 pages")
    refused(lsm(tmp_path / "a.lsm", ramp("u2", (5, *PLANE)), 0, 2), "but has 5 pages")


def scan_image(path, pages, *lines):
    text = "".join(f"SI.{line}\n" for line in ("VERSION_MAJOR = 2020", *lines))
    tifffile.imwrite(path, pages.reshape(-1, *PLANE), metadata=None, software=text, description="frameNumbers = 1\n",
                     photometric="minisblack")
    return path


@pytest.mark.parametrize("lines, order, sizes", (
    (("hChannels.channelSave = [1;2]", "hStackManager.framesPerSlice = 1", "hStackManager.numSlices = 3"), "tzc", (1, 3, 2)),
    (("hChannels.channelSave = [1 3 4]", "hStackManager.framesPerSlice = 1", "hStackManager.numSlices = 2"), "tzc", (2, 2, 3)),
    (("hChannels.channelSave = 1", "hStackManager.framesPerSlice = 1", "hStackManager.numSlices = 9",
      "hStackManager.actualNumSlices = 4"), "tzc", (2, 4, 1)),
    (("hChannels.channelSave = [1;2]", "hStackManager.framesPerSlice = 3", "hStackManager.numSlices = 2"), "ztc", (2, 3, 2)),
    (("hChannels.channelSave = [1;2]", "hStackManager.framesPerSlice = Inf", "hStackManager.numSlices = 1"), "tzc", (4, 1, 2))))
def test_channels_and_times_of_scan_image_are_no_slices(tmp_path, lines, order, sizes):
    data = ramp("i2", (*sizes, *PLANE))
    path = scan_image(tmp_path / "a.tif", data, *lines)
    by_time = data.swapaxes(0, 1) if order == "ztc" else data
    for time, expected in enumerate(by_time[:, :, 0]):
        loaded = palpate.load(path, frame=time)
        assert numpy.array_equal(loaded.volume.array, expected)
        assert any("channel 0" in note for note in loaded.notes) == (sizes[2] > 1)


def test_pages_of_scan_image_that_may_be_slices_or_times_are_noted(tmp_path):
    path = scan_image(tmp_path / "a.tif", ramp("i2", (5, *PLANE)), "hChannels.channelSave = 2", "hStackManager.numSlices = 1",
                      "hStackManager.framesPerSlice = 1")
    assert numpy.array_equal(noted(path, "slices or times").array, ramp("i2", (5, *PLANE)))


@pytest.mark.parametrize("axes, sizes", (("TZYX", (2, 3)), ("CZYX", (2, 3)), ("ZCYX", (3, 2)), ("TZCYX", (2, 3, 4)), ("CYX", (3,)),
                                         ("TYX", (3,)), ("ZYX", (3,)), ("CTZYX", (2, 3, 4))))
def test_axes_of_tifffile_are_those_of_the_pages(tmp_path, axes, sizes):
    data = ramp("u2", (*sizes, *PLANE))
    tifffile.imwrite(tmp_path / "a.tif", data, photometric="minisblack", metadata={"axes": axes})
    expected = data
    for axis in "TCZ":
        if axis not in axes:
            expected = expected[None]
    lacking = [axis for axis in "TCZ" if axis not in axes]
    order = "".join(reversed(lacking)) + axes
    expected = expected.transpose([order.index(axis) for axis in "TCZYX"])
    for time, one in enumerate(expected):
        loaded = palpate.load(tmp_path / "a.tif", frame=time)
        assert numpy.array_equal(loaded.volume.array, one[0])
        assert any(f"of {one.shape[0]} was taken" in note for note in loaded.notes) == (one.shape[0] > 1)
        assert any(f"time step {time} of" in note for note in loaded.notes) == (len(expected) > 1)


def test_axes_of_other_meanings_are_noted(tmp_path):
    data = ramp("u2", (2, 3, *PLANE))
    for metadata in ({"axes": "QZYX"}, {}):
        tifffile.imwrite(tmp_path / "a.tif", data, photometric="minisblack", metadata=metadata)
        assert noted(tmp_path / "a.tif", "all its pages were taken as slices").array.shape == (6, *PLANE)


@pytest.mark.parametrize("metadata", ({"axes": "YX"}, {}))
def test_pages_that_were_added_one_by_one_are_slices(tmp_path, metadata):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for plane in ramp("u2"):
            file.write(plane, photometric="minisblack", contiguous=False, metadata=metadata)
    assert numpy.array_equal(palpate.load(tmp_path / "a.tif").volume.array, ramp("u2"))


def test_a_type_of_ome_xml_that_is_not_that_of_the_pages_is_noted(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), ome=True, metadata={"axes": "ZYX"})
    text = tifffile.TiffFile(tmp_path / "a.tif").pages[0].description
    assert not any("samples of type" in note for note in palpate.load(tmp_path / "a.tif").notes)
    tifffile.imwrite(tmp_path / "b.tif", ramp("u2"), metadata=None, description=text.replace("uint16", "int16").encode())
    assert numpy.array_equal(noted(tmp_path / "b.tif", "samples of type int16").array, ramp("u2"))
