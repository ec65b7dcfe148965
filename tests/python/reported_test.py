"""Files of the kinds that people report to other programs: half floats, planes in another order, calibrations of signed
numbers, headers that contradict their numbers, VTK's older format. A refusal says what to do."""

import base64
import bz2
import gzip
import itertools
import json
import struct
import sys
import zlib
from pathlib import Path

import h5py
import nibabel
import numpy
import palpate
import pytest
import tifffile
import vtk
import zarr
from formats_test import nrrd
from headers_test import meta_image, mrc, nifti
from pydicom._uid_dict import UID_dictionary
from pydicom.encaps import encapsulate
from readers_test import SHAPE, SYNTAXES, noted, ramp, refused, save, slice_of, stack
from vtk.util import numpy_support

sys.path.insert(0, str(Path(__file__).parents[1] / "stream"))
from tiff_reference import TILE, tiles

# Half floats ------------------------------------------------------------------------------------------


def halves():
    """Every number of 16 bits, those that are not finite last."""
    numbers = numpy.arange(65536, dtype="u2").view("f2")
    finite = numpy.isfinite(numbers)
    return numpy.concatenate([numbers[finite], numbers[~finite]]).reshape(4, 128, 128)


def expect_halves(array):
    wanted = halves().astype("f4")
    wanted[~numpy.isfinite(wanted)] = -65504  # the least
    assert array.dtype == "f4" and numpy.array_equal(array, wanted)


@pytest.mark.parametrize("order", "<>")
def test_half_floats_of_tiff_in_strips(tmp_path, order):
    tifffile.imwrite(tmp_path / "a.tif", halves(), photometric="minisblack", byteorder=order)
    expect_halves(noted(tmp_path / "a.tif", "samples of type float16 became float32").array)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("predictor", (None, 3))
def test_half_floats_of_tiff_in_tiles(tmp_path, predictor, order):
    data = halves()
    tifffile.imwrite(tmp_path / "a.tif", tiles(data, order, zlib.compress, predictor), shape=data.shape, dtype="f2", tile=TILE, byteorder=order, compression="zlib",
                     predictor=predictor, photometric="minisblack", metadata=None)
    expect_halves(palpate.load(tmp_path / "a.tif").volume.array)
    store = palpate.open_store(tmp_path / "a.tif")
    expect_halves(store.read((0, 0, 0), store.levels[0].size).array)


@pytest.mark.parametrize("dtype", ("<f2", ">f2"))
def test_half_floats_of_zarr_2(tmp_path, dtype):
    zarr.save_array(str(tmp_path / "a.zarr"), halves().astype(dtype), chunks=(1, 64, 128))
    store = palpate.open_store(tmp_path / "a.zarr")
    expect_halves(store.read((0, 0, 0), store.levels[0].size).array)


@pytest.mark.parametrize("fill, value", ((1.5, 1.5), ("0x3e00", 1.5), ("0xbc00", -1), ("NaN", 2)))
def test_half_floats_of_zarr_3(tmp_path, fill, value):
    folder = tmp_path / "a.zarr"
    (folder / "c/0/0").mkdir(parents=True)
    (folder / "zarr.json").write_text(json.dumps({
        "zarr_format": 3, "node_type": "array", "shape": [2, 1, 3], "data_type": "float16", "fill_value": fill,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [1, 1, 3]}}, "attributes": {},
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "codecs": [{"name": "bytes", "configuration": {"endian": "big"}}]}))
    (folder / "c/0/0/0").write_bytes(numpy.array([2, 3, 4], ">f2").tobytes())
    store = palpate.open_store(folder)
    assert numpy.array_equal(store.read((0, 0, 0), (3, 1, 2)).array, [[[2, 3, 4]], [[value] * 3]])


@pytest.mark.parametrize("order", "<>")
def test_half_floats_of_mrc(tmp_path, order):
    path = mrc(tmp_path / "a.mrc", halves(), 12, order)
    expect_halves(palpate.load(path).volume.array)
    store = palpate.open_store(path)
    expect_halves(store.read((0, 0, 0), store.levels[0].size).array)


# Planes and values of TIFF ----------------------------------------------------------------------------


def image_j(path, data, *lines):
    tifffile.imwrite(path, data, photometric="minisblack", metadata=None,
                     description="\n".join(["ImageJ=1.53t", f"images={len(data)}", *lines, ""]))
    return path


@pytest.mark.parametrize("order", ("zct", "ZCT", "", "tzc"))
@pytest.mark.parametrize("frames", (1, 2))
def test_planes_of_micro_manager_may_be_slices_first(tmp_path, order, frames):
    """micro-manager/micro-manager#894: of all orders, ImageJ knows zct."""
    data = ramp("u2", (frames, 2, *SHAPE))  # t, c, z, y, x
    stored = data if order.lower() == "zct" else data.transpose(0, 2, 1, 3, 4)
    path = image_j(tmp_path / "a.tif", stored.reshape(-1, *SHAPE[1:]), f"slices={SHAPE[0]}", "channels=2", f"frames={frames}",
                   "hyperstack=true", *([f"order={order}"] if order else []))
    for frame in range(frames):
        assert numpy.array_equal(palpate.load(path, frame=frame).volume.array, data[frame, 0])


@pytest.mark.parametrize("tag, program", ((51123, "Micro-Manager"), (34361, "FluoView"), (65000, "")))
def test_tags_of_programs_that_count_pages_are_noted(tmp_path, tag, program):
    """cgohlke/tifffile#23: NDTiff has its axes in such a tag of each page."""
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), photometric="minisblack", metadata=None,
                     extratags=[(tag, "s", 0, json.dumps({"Axes": {"z": 0, "channel": 0}}), False)])
    loaded = palpate.load(tmp_path / "a.tif")
    assert numpy.array_equal(loaded.volume.array, ramp("u2"))
    assert any(f"what {program} says of its pages" in note for note in loaded.notes) == bool(program), loaded.notes


@pytest.mark.parametrize("dtype", ("u2", "i2"))
@pytest.mark.parametrize("slope, intercept", ((1, -32768), (2, -65536), (1, 0), (0.5, 10)))
def test_a_calibration_of_image_j_is_that_of_unsigned_numbers(tmp_path, dtype, slope, intercept):
    """ImageJ adds 32768 to signed numbers when it reads them."""
    data = ramp(dtype, first=-100 if dtype == "i2" else 0)
    path = image_j(tmp_path / "a.tif", data, f"slices={SHAPE[0]}", "cf=0", f"c0={intercept}", f"c1={slope}", "vunit=HU")
    shown = data.astype("f8") + (32768 if dtype == "i2" else 0)
    assert numpy.array_equal(palpate.load(path).volume.array, shown * slope + intercept)


@pytest.mark.parametrize("number", (33003, 34712, 65000))
def test_compressions_that_libtiff_does_not_have_are_refused_with_what_to_do(tmp_path, number):
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), photometric="minisblack", metadata=None)
    data = bytearray((tmp_path / "a.tif").read_bytes())
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        for page in file.pages:
            struct.pack_into("<H", data, page.tags["Compression"].valueoffset, number)
    (tmp_path / "a.tif").write_bytes(data)
    refused(tmp_path / "a.tif", f"TIFF number {number}", "deflate")


# Headers that contradict themselves ----------------------------------------------------------------------


@pytest.mark.parametrize("dim, size", (((3, 6, 20, 0), (6, 20, 1)), ((3, 6, 0, 20), (6, 1, 20)), ((4, 6, 4, 5, 0), (6, 4, 5)),
                                       ((3, 120, 0, 0), (120, 1, 1))))
def test_a_size_of_0_in_nifti_is_1_as_the_reference_library_takes_it(tmp_path, dim, size):
    path = nifti(tmp_path / "a.nii", lambda header: struct.pack_into(f"<{len(dim)}h", header, 40, *dim))
    volume = palpate.load(path).volume
    assert tuple(volume.geometry.size) == size and numpy.array_equal(volume.array.ravel(), ramp("i2").ravel())
    refused(nifti(tmp_path / "b.nii", lambda header: struct.pack_into("<4h", header, 40, 3, 0, 4, 5)), "size 0x4x5")


@pytest.mark.parametrize("order", "<>")
def test_a_wrong_machine_stamp_of_mrc_is_noted(tmp_path, order):
    stamp = b"\x11\x11" if order == "<" else b"\x44\x44"
    path = mrc(tmp_path / "a.mrc", ramp("i2"), 1, order, stamp=stamp)
    assert numpy.array_equal(noted(path, "machine stamp").array, ramp("i2"))
    loaded = palpate.load(mrc(path, ramp("i2"), 1, order, stamp=b"\x90\x42"))  # of Amira: any bytes
    assert numpy.array_equal(loaded.volume.array, ramp("i2")) and not any("stamp" in note for note in loaded.notes)


def test_dicom_of_no_frames_has_one(tmp_path):
    """pydicom/pydicom#1844"""
    folder = save(tmp_path / "a", stack(ramp("i2"), change=lambda i: {"NumberOfFrames": 0}))
    assert numpy.array_equal(noted(folder, "NumberOfFrames").array, ramp("i2"))
    refused(save(tmp_path / "b", [slice_of(ramp("i2")[0], 1, (0, 0, 0), NumberOfFrames=-1)]), "'-1' frames")


# Two slices of 12 bits, (37 * index) % 4000, without and with 2000 less and a sign, packed by OpenJPH.
HIGH_THROUGHPUT = {False: (
    "|4;u>04YEK0000800006000000000000008000060000000000009dD0sl|{2mk^A000L6QUDA90ssL31q1{@0smY86Ch}CaBy&NaBy&NaBy&F"
    "XlVar02crOPjF>!N>E53R%LP^FfKDOE-)_tkN^q*00000RsaG2lfVLCkNN`#bN~PVzyT}(697;Fhjaka`2z=Z0Kfq>022Tt(g6Z=0LkP4A~XQN"
    "0;T{JU<iWzpdv7Wb^uN~>7<juLIJ+E0RPz",
    "|4;u>04YEK0000800006000000000000008000060000000000009dD0sl|{2mk^A000L6QUDA90ssL31q1{@0smY86Ch}CaBy&NaBy&NaBy&F"
    "XlVar02crOPjF>!N>E53R%LP^FfKDOE-)_tkN^q*00000RR971lfVK{P67vX0002M0W1I$08jykbO6%%0|#^fzyUM>696RA0RnUY$>abcGyuQ?"
    "rT`US2!i~eA~1q>08TpTq?5ox0lu~X|Je"), True: (
    "|4;u>04YEK000080000600000000000000800006000000000000D~u0sl|{2mk^A000L6QUDA90ssL31q1{@0smY86Ch}CaBy&NaBy&NaBy&F"
    "XlVar02crOPjF>!N>E53R%LP^FfKDOE-)_tkN^q*00000RsaG2lfVLCFZu%qbN~PVzyT}(697;Fhjaka`2z=Z0Kfq>022Tt(g6Z=0LkP4A~XQN"
    "0;T{JU<iWzpdv7Wb^uN~>7<juLIJ+E0RPz",
    "|4;u>04YEK000080000600000000000000800006000000000000D~u0sl|{2mk^A000L6QUDA90ssL31q1{@0smY86Ch}CaBy&NaBy&NaBy&F"
    "XlVar02crOPjF>!N>E53R%LP^FfKDOE-)_tkN^q*00000RR971lfVK{t^x;i0002M0W1I$08jykbO6%%0|#^fzyUM>696RA0RnUY$>abcGyuQ?"
    "rT`US2!i~eA~1q>08TpTq?5ox0lu~X|Je")}


def use_syntax(uid):
    """One that pydicom does not know."""
    UID_dictionary[uid] = ("", "Transfer Syntax", "", "", "")
    SYNTAXES["other"] = uid


@pytest.mark.parametrize("number", (201, 202, 203))
@pytest.mark.parametrize("signed", (False, True))
def test_high_throughput_jpeg_2000_is_read(tmp_path, signed, number):
    """As of AWS HealthImaging; GDCM does not know its transfer syntaxes, the library that it unpacks JPEG 2000 with does."""
    array = (numpy.arange(96).reshape(2, 6, 8) * 37 % 4000 - 2000 * signed).astype("i2")
    slices = stack(array if signed else array.astype("u2"), change=lambda i: {"BitsStored": 12, "HighBit": 11})
    use_syntax(f"1.2.840.10008.1.2.4.{number}")
    for data, stream in zip(slices, HIGH_THROUGHPUT[signed]):
        data.PixelData = encapsulate([base64.b85decode(stream)])
        data["PixelData"].is_undefined_length = True
    loaded = palpate.load(save(tmp_path / "a", slices, "other"))
    assert numpy.array_equal(loaded.volume.array, array)
    cut = base64.b85decode(HIGH_THROUGHPUT[signed][0])[:-30]
    slices[0].PixelData = encapsulate([cut])
    refused(save(tmp_path / "b", slices, "other"), "JPEG 2000 image that is cut off")


def test_one_slice_of_several_is_noted(tmp_path):
    folder = save(tmp_path / "a", stack(ramp("i2")))
    assert numpy.array_equal(noted(folder / "002.dcm", "give their folder").array, ramp("i2")[1:2])
    assert not any("give their folder" in note for note in palpate.load(folder).notes)
    for other in ("001", "003", "004", "005"):
        (folder / f"{other}.dcm").unlink()
    (folder / "notes.txt").write_text("of the scan")
    assert not any("give their folder" in note for note in palpate.load(folder / "002.dcm").notes)


def test_jpeg_xl_is_refused_with_what_to_do(tmp_path):
    slices = stack(ramp("u2"))
    use_syntax("1.2.840.10008.1.2.4.110")
    for data in slices:
        data.PixelData = encapsulate([b"\xff\x0a" + bytes(100)])
        data["PixelData"].is_undefined_length = True
    refused(save(tmp_path / "a", slices, "other"), "JPEG XL", "without compression")


# VTK's older format, written by VTK ---------------------------------------------------------------------


def write_vtk(path, data, text=False, cells=False, second=None):
    image = vtk.vtkImageData()
    image.SetDimensions(*(size + cells for size in data.shape[::-1]))
    image.SetSpacing(0.5, 2, 3)
    image.SetOrigin(10, -20, 30)
    for name, samples in (("density", data), ("second", second)):
        if samples is not None:
            array = numpy_support.numpy_to_vtk(samples.ravel(), deep=True)
            array.SetName(name)
            (image.GetCellData() if cells else image.GetPointData()).AddArray(array)
    if second is None:
        (image.GetCellData() if cells else image.GetPointData()).SetActiveScalars("density")
    writer = vtk.vtkStructuredPointsWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(image)
    writer.SetFileType(vtk.VTK_ASCII if text else vtk.VTK_BINARY)
    assert writer.Write() == 1
    return path


@pytest.mark.parametrize("dtype, text", (*itertools.product(("i1", "i2", "u2", "i4", "u4", "i8", "f4", "f8"), (False, True)), ("u1", False)))
def test_structured_points_of_vtk(tmp_path, dtype, text):
    loaded = palpate.load(write_vtk(tmp_path / "a.vtk", ramp(dtype) // 2, text))
    geometry = loaded.volume.geometry
    assert numpy.array_equal(loaded.volume.array, ramp(dtype) // 2) and not geometry.oriented
    assert numpy.array_equal(geometry.spacing, (0.5, 2, 3)) and numpy.array_equal(geometry.origin, (10, -20, 30))
    assert not any("ignored" in note for note in loaded.notes), loaded.notes
    if not text:
        store = palpate.open_store(tmp_path / "a.vtk")
        assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, ramp(dtype) // 2)


@pytest.mark.parametrize("text", (False, True))
def test_arrays_of_fields_and_of_cells_of_vtk(tmp_path, text):
    volume = palpate.load(write_vtk(tmp_path / "a.vtk", ramp("i2"), text, second=ramp("f4"))).volume
    assert b"FIELD" in (tmp_path / "a.vtk").read_bytes() and numpy.array_equal(volume.array, ramp("i2"))
    volume = noted(write_vtk(tmp_path / "b.vtk", ramp("i2"), text, cells=True), "centres")
    assert numpy.array_equal(volume.array, ramp("i2")) and numpy.array_equal(volume.geometry.origin, (10.25, -19, 31.5))


def test_vtk_without_a_spacing_or_in_small_letters(tmp_path):
    text = write_vtk(tmp_path / "a.vtk", ramp("i2"), text=True).read_text()
    (tmp_path / "a.vtk").write_text(text.replace("SPACING 0.5 2 3\n", ""))
    assert numpy.array_equal(noted(tmp_path / "a.vtk", "no spacing").geometry.spacing, (1, 1, 1))
    refused(write_vtk(tmp_path / "b.vtk", ramp("u1"), text=True), "save it as binary")
    (tmp_path / "a.vtk").write_bytes(text.replace("SPACING", "ASPECT_RATIO").lower().replace("\n", "\r\n").encode())
    assert numpy.array_equal(palpate.load(tmp_path / "a.vtk").volume.geometry.spacing, (0.5, 2, 3))


FIELD = b"""FIELD FieldData 3
TIME 1 1 double
%s
METADATA
INFORMATION 1
NAME of LOCATION time
DATA 1 2

CYCLE 1 1 int
%s
pair 2 2 float
%s
"""


@pytest.mark.parametrize("text", (False, True))
def test_numbers_of_a_whole_vtk_file_are_not_its_samples(tmp_path, text):
    """VisIt and ParaView write the time before the grid."""
    numbers = (b"0.25", b"7", b"1 2\n3 4") if text else (struct.pack(">d", 0.25), struct.pack(">i", 7), b"DIMENSIONS 9 9 9"[:16])
    path = write_vtk(tmp_path / "a.vtk", ramp("i2"), text)
    whole = path.read_bytes()
    for before in (b"DIMENSIONS", b"SPACING", b"POINT_DATA"):
        path.write_bytes(whole.replace(before, FIELD % numbers + before, 1))
        volume = palpate.load(path).volume
        assert numpy.array_equal(volume.array, ramp("i2")) and numpy.array_equal(volume.geometry.origin, (10, -20, 30))
    path.write_bytes(whole.replace(b"POINT_DATA", b"FIELD FieldData 1\nname 1 1 string\nabc\nPOINT_DATA"))
    refused(path, "'string'")
    path.write_bytes(whole.replace(b"POINT_DATA", b"FIELD FieldData 1\nlong 1 2000000 double\n1\nPOINT_DATA"))
    refused(path, "too long")


def test_an_array_of_a_field_with_another_number_of_samples_is_refused(tmp_path):
    path = write_vtk(tmp_path / "a.vtk", ramp("i2"), second=ramp("f4"))
    path.write_bytes(path.read_bytes().replace(b"density 1 120", b"density 1 119"))
    refused(path, "119 samples")


@pytest.mark.parametrize("second", (None, ramp("i2")))
def test_binary_vtk_of_a_narrower_type_than_its_samples_is_refused(tmp_path, second):
    path = write_vtk(tmp_path / "a.vtk", ramp("i4"), second=second)
    whole = path.read_bytes()
    for narrower in (b"short", b"char", b"unsigned_char"):
        path.write_bytes(whole.replace(b" int\n", b" " + narrower + b"\n", 1))
        refused(path, "do not end where its header says")
        with pytest.raises(palpate.InputError, match="do not end"):
            palpate.open_store(path)


@pytest.mark.parametrize("name", ("a.mgh", "a.mgz"))
@pytest.mark.parametrize("size, is_refused", ((4, False), (128, True)))
def test_an_mgh_of_a_narrower_type_than_its_samples_is_refused(tmp_path, name, size, is_refused):
    """A few bytes may be tags, but not as many as millions of samples take."""
    nibabel.MGHImage(numpy.ones((size,) * 3, "i4"), numpy.eye(4)).to_filename(tmp_path / "b.mgh")
    whole = (tmp_path / "b.mgh").read_bytes()
    whole = whole[:20] + struct.pack(">i", 0) + whole[24:]  # bytes
    (tmp_path / name).write_bytes(gzip.compress(whole) if name == "a.mgz" else whole)
    if is_refused:
        refused(tmp_path / name, "a.mg")
    else:
        assert palpate.load(tmp_path / name).volume.array.shape == (size,) * 3


@pytest.mark.parametrize("tile", (None, (16, 16)))
@pytest.mark.parametrize("compression", (None, "zlib"))
@pytest.mark.parametrize("dtype, bits", (("u2", 8), ("u4", 16), ("u4", 8)))
def test_pages_of_tiff_with_wider_samples_than_their_header_says_are_refused(tmp_path, dtype, bits, compression, tile):
    tifffile.imwrite(tmp_path / "a.tif", ramp(dtype, (2, 80, 96)), photometric="minisblack", metadata=None, compression=compression, tile=tile)
    data = bytearray((tmp_path / "a.tif").read_bytes())
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        for page in file.pages:
            struct.pack_into("<H", data, page.tags["BitsPerSample"].valueoffset, bits)
    (tmp_path / "a.tif").write_bytes(data)
    refused(tmp_path / "a.tif", "a.tif")


def test_text_of_vtk_with_too_many_numbers_or_decimal_commas(tmp_path):
    text = write_vtk(tmp_path / "a.vtk", ramp("i2"), text=True, second=ramp("f4")).read_text()
    assert " 7 14 " in text and "\nsecond" in text
    (tmp_path / "a.vtk").write_text(text.replace(" 7 14 ", " 7,5 14 "))
    refused(tmp_path / "a.vtk", "decimal commas")
    (tmp_path / "a.vtk").write_text(text.replace("\nsecond", " 9\nsecond"))
    assert numpy.array_equal(noted(tmp_path / "a.vtk", "121; the rest was ignored").array, ramp("i2"))
    (tmp_path / "a.vtk").write_text(text.replace("\nsecond", " 9" * 120 + "\nsecond"))
    refused(tmp_path / "a.vtk", "there are 240")


def test_an_array_of_vti_without_a_name_is_refused_with_what_to_do(tmp_path):
    palpate.write(palpate.Volume(ramp("i2")), tmp_path / "a.vti")
    whole = (tmp_path / "a.vti").read_bytes()
    (tmp_path / "a.vti").write_bytes(whole.replace(b' Name="density"', b""))
    refused(tmp_path / "a.vti", "without a name", "Name")


def write_vti(path, data, encoded, between, compressor, width):
    """`between`: the arrays are between their tags, not behind them."""
    image = vtk.vtkImageData()
    image.SetDimensions(*data.shape[::-1])
    for name in ("density", "second"):
        array = numpy_support.numpy_to_vtk(data.ravel(), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(image)
    (writer.SetDataModeToBinary if between else writer.SetDataModeToAppended)()
    (writer.EncodeAppendedDataOn if encoded else writer.EncodeAppendedDataOff)()
    writer.SetCompressorType(compressor)
    (writer.SetHeaderTypeToUInt32 if width == 32 else writer.SetHeaderTypeToUInt64)()
    assert writer.Write() == 1
    return path.read_bytes()


@pytest.mark.parametrize("width", (32, 64))
@pytest.mark.parametrize("encoded, between, compressor", itertools.product((False, True), (False, True), (0, 1, 3)))
def test_lengths_of_vti_arrays_that_contradict_the_header_are_refused(tmp_path, encoded, between, compressor, width):
    """VTK reads as many bytes as the type takes, and a part of a wider length as samples."""
    path = tmp_path / "a.vti"
    whole = write_vti(path, ramp("i2"), encoded, between, compressor, width)
    assert numpy.array_equal(palpate.load(path).volume.array, ramp("i2"))
    for before, after in ((b'"Int16"', b'"Int8"'), (b'"Int16"', b'"Float32"'), (f'"UInt{width}"'.encode(), f'"UInt{96 - width}"'.encode())):
        path.write_bytes(whole.replace(before, after))
        refused(path, "a.vti")


@pytest.mark.parametrize("change, words", (
    (lambda data: data[:-10], "cut off"), (lambda data: data[:150], "header"), (lambda data: data[10:], "no file of VTK"),
    (lambda data: data.replace(b"STRUCTURED_POINTS", b"POLYDATA"), "mesh"),
    (lambda data: data.replace(b"SCALARS", b"VECTORS"), "vectors"), (lambda data: data.replace(b" short", b" short 3"), "3 values"),
    (lambda data: data.replace(b" short", b" bit"), "'bit'"), (lambda data: data.replace(b"SPACING 0.5", b"SPACING nan"), "spacing"),
    (lambda data: data.replace(b"DIMENSIONS 6", b"DIMENSIONS 60000"), "its grid is 60000x4x5"),
    (lambda data: data.replace(b"DIMENSIONS 6 4", b"DIMENSIONS 6"), "three numbers"),
    (lambda data: data.replace(b"ORIGIN 10", b"ORIGIN 1e30"), "position")), ids=range(11))
@pytest.mark.parametrize("text", (False, True))
def test_vtk_files_that_are_damaged_or_of_another_kind_are_refused(tmp_path, text, change, words):
    path = write_vtk(tmp_path / "a.vtk", ramp("i2"), text)
    path.write_bytes(change(path.read_bytes()))
    refused(path, words)


# What to do -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("data, words", (
    (gzip.compress(gzip.compress(bytes(1000))), "packed twice"), (bz2.compress(bytes(1000)), "bzip2; unpack it"),
    (b"PK\3\4" + bytes(1000), "zip; unpack it"), (b"\x28\xb5\x2f\xfd" + bytes(1000), "zstd; unpack it"),
    (b"<!DOCTYPE html><html><head>" + bytes(1000), "web page"), (b"<HTML><BODY>" + bytes(1000), "web page"),
    (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"), (b"/annex/objects/MD5E-s9--0.nii.gz\n", "datalad get")),
    ids=range(8))
@pytest.mark.parametrize("name", ("a.nii.gz", "a.nrrd", "a.mha", "a.mrc"))
def test_a_file_that_is_something_else_than_its_name_says_is_refused_with_what_to_do(tmp_path, name, data, words):
    (tmp_path / name).write_bytes(data)
    refused(tmp_path / name, words)


@pytest.mark.parametrize("pack", (gzip.compress, zlib.compress))
def test_samples_that_are_compressed_against_their_header_are_refused_for_that(tmp_path, pack):
    data = numpy.zeros(SHAPE, "i2")  # packs well
    for path in (nrrd(tmp_path / "a.nrrd", data, "space: RAS"), meta_image(tmp_path / "a.mha", data=data.tobytes())):
        path.write_bytes(path.read_bytes()[:-data.nbytes] + pack(data.tobytes()))
        refused(path, "not compressed, but they begin")
    refused(meta_image(tmp_path / "b.mha", "CompressedData = True", data=ramp("i2").tobytes()), "do not begin as")
    path = nrrd(tmp_path / "b.nrrd", ramp("i2"))
    path.write_bytes(path.read_bytes().replace(b"encoding: raw", b"encoding: gzip"))
    refused(path, "do not begin as")


@pytest.mark.parametrize("name, words", (("a.mnc", "mnc2nii"), ("a.mif", "mrconvert"), ("a.mif.gz", "unpack"), ("a.HEAD", "AFNI"),
                                         ("x+orig.BRIK.gz", "AFNI"), ("a.PAR", "dcm2niix"),
                                         ("a.npy", "palpate.Volume"), ("a.czi", "OME-TIFF"), ("a.vtu", ".vti"),
                                         ("a.nii.zst", "unpack"), ("a.png", "TIFF"), ("a.raw.gz", "give its dims and type"), ("a.other", "no extension of a known format")))
def test_a_format_that_is_not_read_is_refused_with_what_to_do(tmp_path, name, words):
    (tmp_path / name).write_bytes(b"something")
    refused(tmp_path / name, words)


def test_slices_that_are_packed_are_refused_with_what_to_do(tmp_path):
    folder = save(tmp_path / "a", stack(ramp("i2")))
    for path in list(folder.iterdir()):
        path.with_suffix(".dcm.gz").write_bytes(gzip.compress(path.read_bytes()))
        path.unlink()
    refused(folder, "gunzip")


def test_hdf5_of_another_program_is_refused_with_what_to_do(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["data"] = ramp("i2")
    with pytest.raises(palpate.InputError, match="another program.*OME-Zarr"):
        palpate.open_store(tmp_path / "a.h5")
