"""Files of kinds that other programs got wrong, by their public bug reports. Each was made by hand, or by the program that
writes such files, and is compared with the numbers it was made of."""

import gzip
import json
import os
import struct

import nibabel
import numpy
import palpate
import pydicom
import pytest
import tifffile
import zarr
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset

from dicom_readers_test import enhanced, frames_of, items
from formats_test import n5_array
from readers_test import SHAPE, noted, ramp, refused, save, slice_of, stack

DOSE = {"Modality": "RTDOSE", "SOPClassUID": "1.2.840.10008.5.1.4.1.1.481.2", "DoseGridScaling": 0.01, "DoseUnits": "GY",
        "RescaleSlope": None, "RescaleIntercept": None}


# dicompyler-core 284: offsets of a dose may be z of the patient, whichever way the patient lies.
@pytest.mark.parametrize("first, axes, normal", ((0, (1, 1), 1), (3, (1, 1), 1), (0, (-1, 1), -1), (3, (-1, 1), 1),
                                                 (3, (-1, -1), 1), (3, (1, -1), 1)))
def test_planes_of_a_dose_lie_at_their_offsets_or_at_z_of_the_patient(tmp_path, first, axes, normal):
    offsets = [first + 2.5 * i for i in range(SHAPE[0])]
    data = frames_of(ramp("u2"), GridFrameOffsetVector=offsets, ImageOrientationPatient=[axes[0], 0, 0, 0, axes[1], 0], **DOSE)
    loaded = palpate.load(save(tmp_path / "a", [data]))
    assert not any("intercept, and others" in note for note in loaded.notes), loaded.notes  # a dose has its own scaling
    for plane in range(SHAPE[0]):
        place = (1, 2, 3 + normal * 2.5 * plane)
        index = numpy.rint(loaded.volume.geometry.index(place)).astype(int)
        assert numpy.allclose(loaded.volume.geometry.physical(index), place)
        assert numpy.allclose(loaded.volume.array[index[2], index[1], index[0]], ramp("u2")[plane, 0, 0] * 0.01)


CORONAL = {"ImageOrientationPatient": [1, 0, 0, 0, 0, -1]}


# vtk-dicom 164: every slice has the position of the first one, or none.
@pytest.mark.parametrize("position", ((1, 2, 3), None))
def test_slices_without_a_place_of_their_own_are_a_stack_with_the_axes_of_their_planes(tmp_path, position):
    slices = [slice_of(plane, i + 1, (1, 2, 3), **CORONAL) for i, plane in enumerate(ramp("i2"))]
    for data in slices if position is None else ():
        del data.ImagePositionPatient
    volume = noted(save(tmp_path / "a", slices), "piled up by their numbers")
    assert numpy.array_equal(volume.array, ramp("i2")) and volume.geometry.spacing[2] == 2
    assert numpy.allclose(volume.geometry.direction, ((1, 0, 0), (0, 0, 1), (0, -1, 0))) and not volume.geometry.oriented
    one = palpate.load(save(tmp_path / "b", slices[:1])).volume.geometry
    assert numpy.allclose(one.direction, volume.geometry.direction) and one.oriented


def test_moments_of_one_slice_stay_moments(tmp_path):
    for name, more in (("a", "TriggerTime"), ("b", "TemporalPositionIdentifier"), ("c", "AcquisitionNumber")):
        slices = [slice_of(plane, i + 1, (1, 2, 3), **{more: i + 1}) for i, plane in enumerate(ramp("i2"))]
        assert palpate.load(save(tmp_path / name, slices)).time_steps == SHAPE[0]


# fo-dicom 47, pydicom 1305: an explicit file whose elements have no type, here and there or all of them.
@pytest.mark.parametrize("group, number", ((9, 0x1010), (0x29, 0x1010), (0x28, 0x30), (0x28, 0x1052), (0x28, 0x10), (0x7FE0, 0x10)))
@pytest.mark.parametrize("length", (0, 2, 4, 6, 8, 70, 600))
def test_elements_of_dicom_may_lack_their_type(tmp_path, group, number, length):
    data = slice_of(ramp("i2")[0], 1, (1, 2, 3), RescaleIntercept=-5)
    if group % 2:
        data.add_new((group, 0x10), "LO", "NOBODY")
        data.add_new((group, number), "LO", "x" * length)
    path = save(tmp_path / "a", [data]) / "001.dcm"
    raw = path.read_bytes()
    at = raw.index(struct.pack("<HH", group, number) + (b"OW" if group == 0x7FE0 else b"")) + 4
    wide = raw[at:at + 2] == b"OW"
    size = struct.unpack("<I", raw[at + 4:at + 8])[0] if wide else struct.unpack("<H", raw[at + 2:at + 4])[0]
    path.write_bytes(raw[:at] + struct.pack("<I", size) + raw[at + (8 if wide else 4):])
    volume = palpate.load(path).volume
    assert numpy.array_equal(volume.array[0], ramp("i2")[0] - 5)
    assert numpy.array_equal(volume.geometry.spacing, (0.25, 0.5, 2)) and numpy.array_equal(volume.geometry.origin, (1, 2, 3))


def test_a_data_set_without_types_may_be_called_explicit(tmp_path):
    path = save(tmp_path / "a", [slice_of(ramp("i2")[0], 1, (1, 2, 3), RescaleIntercept=-5)], "implicit") / "001.dcm"
    raw = path.read_bytes()
    uid = b"UI\x12\x001.2.840.10008.1.2\0"
    head = struct.unpack("<I", raw[140:144])[0]
    raw = raw[:140] + struct.pack("<I", head + 2) + raw[144:].replace(uid, b"UI\x14\x001.2.840.10008.1.2.1\0", 1)
    path.write_bytes(raw)
    assert numpy.array_equal(palpate.load(path).volume.array[0], ramp("i2")[0] - 5)
    at = raw.index(struct.pack("<HH", 0x28, 0x1052)) + 4
    path.write_bytes(raw[:at] + b"QQ" + raw[at + 2:])
    refused(path, "no known type")


# piximi 302, bioformats 2577: ImageJ writes its colour table as a palette.
def test_a_palette_leaves_the_numbers_of_a_tiff(tmp_path):
    table = numpy.zeros((3, 256), "u2")
    tifffile.imwrite(tmp_path / "a.tif", ramp("u1"), photometric="palette", colormap=table)
    assert numpy.array_equal(noted(tmp_path / "a.tif", "palette").array, ramp("u1"))


def behind_one_page(path, planes, description, order):
    tifffile.imwrite(path, planes[0], byteorder=order, description=description, metadata=None, resolution=(10, 5))
    with tifffile.TiffFile(path) as file:
        end = file.pages[0].dataoffsets[0] + file.pages[0].databytecounts[0]
    assert end == path.stat().st_size
    with path.open("ab") as file:
        file.write(planes[1:].astype(planes.dtype.newbyteorder(order)).tobytes())


# suite2p 135, scifio 317, TIFFStack 7: ImageJ's stacks above 4 GB have one page.
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("dtype", ("u1", "u2", "f4"))
def test_planes_of_image_j_behind_one_page_are_slices_and_times(tmp_path, dtype, order):
    path = tmp_path / "a.tif"
    behind_one_page(path, ramp(dtype), "ImageJ=1.53t\nimages=5\nslices=5\nunit=um\nspacing=0.3\n", order)
    assert numpy.array_equal(tifffile.imread(path), ramp(dtype))
    volume = palpate.load(path).volume
    assert numpy.array_equal(volume.array, ramp(dtype))
    assert numpy.allclose(volume.geometry.spacing, (1e-4, 2e-4, 3e-4))
    data = path.read_bytes()
    path.write_bytes(data[:-1])
    refused(path, "tells of 5 slices, but has 1")
    times = numpy.concatenate((ramp(dtype), ramp(dtype)[::-1]))
    behind_one_page(path, times, "ImageJ=1.53t\nimages=10\nslices=5\nframes=2\nunit=um\nspacing=0.3\n", order)
    assert numpy.array_equal(palpate.load(path, frame=1).volume.array, ramp(dtype)[::-1])
    tifffile.imwrite(tmp_path / "b.tif", ramp(dtype)[0])
    refused(tmp_path, "stack in a folder of slices")


def test_planes_of_tifffile_behind_one_page_are_slices(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), photometric="minisblack", truncate=True, metadata={"axes": "ZYX"})
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        pages = len(file.pages)
    assert pages == 1 and numpy.array_equal(palpate.load(tmp_path / "a.tif").volume.array, ramp("u2"))


# mobie-viewer-fiji 572: z5 wrote fill values as text.
@pytest.mark.parametrize("dtype, fill", (("u2", "7"), ("i1", "-7"), ("u1", "0")))
def test_fill_values_of_zarr_2_may_be_text(tmp_path, dtype, fill):
    array = zarr.open(str(tmp_path), mode="w", shape=SHAPE, chunks=SHAPE, dtype=dtype, fill_value=0)
    array[...] = ramp(dtype)
    metadata = json.loads((tmp_path / ".zarray").read_text())
    (tmp_path / ".zarray").write_text(json.dumps({**metadata, "fill_value": fill}))
    (tmp_path / "0.0.0").unlink()
    assert zarr.open(str(tmp_path))[0, 0, 0] == float(fill)
    store = palpate.open_store(str(tmp_path))
    assert numpy.all(store.read((0, 0, 0), store.levels[0].size).array == float(fill))


# zarr-python 412, EOPF data-model 67: Python's json writes NaN and Infinity as they are.
@pytest.mark.parametrize("word", ("NaN", "Infinity", "-Infinity"))
def test_metadata_of_zarr_may_have_numbers_that_json_has_not(tmp_path, word):
    array = zarr.open(str(tmp_path), mode="w", shape=SHAPE, chunks=SHAPE, dtype="f4", fill_value=0)
    array[...] = ramp("f4")
    text = (tmp_path / ".zarray").read_text()
    (tmp_path / ".zarray").write_text(text.replace('"fill_value": 0.0', f'"fill_value": {word}'))
    note = f'a \\"{word}\\\\'
    (tmp_path / ".zattrs").write_text(f'{{"_FillValue": {word}, "{note}": [{word}, 1], "_ARRAY_DIMENSIONS": ["z", "y", "x"]}}')
    assert f'"fill_value": {word}' in (tmp_path / ".zarray").read_text() and len(zarr.open(str(tmp_path)).attrs) == 3
    store = palpate.open_store(str(tmp_path))
    assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, ramp("f4"))
    (tmp_path / ".zattrs").write_text(f'{{"a": {word[:-1]}}}')
    with pytest.raises(palpate.InputError, match="is not JSON"):
        palpate.open_store(str(tmp_path))


def test_members_of_ome_zarr_may_be_null_and_names_of_axes_in_capitals(tmp_path):
    group = zarr.open_group(str(tmp_path), mode="w")
    group.create_dataset("0", data=ramp("u2"))
    scale = {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [3, 2, 1]}]}
    axes = [{"name": name, "type": kind, "unit": "millimeter"} for name, kind in zip("ZyX", ("space", None, "space"))]
    image = {"version": "0.4", "axes": axes, "datasets": [scale], "coordinateTransformations": None}
    group.attrs["multiscales"] = [image]
    assert numpy.array_equal(palpate.open_store(str(tmp_path)).levels[0].spacing, (1, 2, 3))


# paintera 61, heinrich-2021a 1, CNNectome 17: where a crop lies, in the unit of its resolution.
@pytest.mark.parametrize("where", ("", "s0"))
def test_n5_lies_at_its_offset(tmp_path, where):
    n5_array(tmp_path / "s0", ramp("u2"))
    n5_array(tmp_path / "s1", ramp("u2")[:3, :2, :3])
    path = tmp_path / where / "attributes.json"
    given = json.loads(path.read_text()) if path.exists() else {}
    path.write_text(json.dumps({**given, "resolution": [2, 2, 4], "units": ["nm"] * 3, "offset": [20, 30, 40]}))
    levels = palpate.open_store(str(tmp_path)).levels
    assert numpy.allclose(levels[0].origin, (2e-5, 3e-5, 4e-5), rtol=1e-9, atol=0)
    assert numpy.allclose(levels[1].origin, (2.1e-5, 3.1e-5, 4.2e-5), rtol=1e-9, atol=0)


# MIRTK 151
@pytest.mark.parametrize("name", ("a.nii", "a.nii.gz"))
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("code", ("sform", "qform", "neither"))
def test_nifti_2_is_read_as_nibabel_reads_it(tmp_path, name, order, code):
    affine = numpy.array(((0, -2e-3, 0, 5), (3e-3, 0, 0, 6), (0, 0, 4e-3, 7), (0, 0, 0, 1)))
    image = nibabel.Nifti2Image(numpy.stack((ramp("i2"), ramp("i2") * 3)).T, None, nibabel.Nifti2Header(endianness=order))
    image.set_qform(affine, code=int(code == "qform"))
    image.set_sform(affine, code=int(code == "sform"))
    image.header.set_xyzt_units("micron", "msec")
    image.header["pixdim"][4] = 40
    nibabel.save(image, tmp_path / name)
    loaded = palpate.load(tmp_path / name, frame=1)
    assert numpy.array_equal(loaded.volume.array, ramp("i2") * 3) and loaded.time_steps == 2
    geometry = loaded.volume.geometry
    assert numpy.allclose(geometry.spacing, (3e-6, 2e-6, 4e-6), rtol=1e-6, atol=0) and geometry.oriented == (code != "neither")
    if geometry.oriented:
        corner = (affine @ (5, 3, 4, 1))[:3] * (-1, -1, 1) * 1e-3
        assert numpy.allclose(geometry.physical((5, 3, 4)), corner)


@pytest.mark.parametrize("slope, intercept", ((2, -5), (float("nan"), 0), (1, 0)))
def test_nifti_2_has_a_slope_and_an_intercept(tmp_path, slope, intercept):
    nibabel.save(nibabel.Nifti2Image(ramp("i2").T, numpy.eye(4)), path := tmp_path / "a.nii")
    data = bytearray(path.read_bytes())
    data[176:192] = struct.pack("<dd", slope, intercept)
    path.write_bytes(data)
    assert numpy.array_equal(palpate.load(path).volume.array, nibabel.load(path).get_fdata().T)
    path.write_bytes(data[:539])
    refused(path, "too short")
    path.write_bytes(data[:4] + b"ni2" + data[7:])
    refused(path, ".hdr/.img")


def test_a_direction_of_nrrd_that_is_nan_is_none(tmp_path):
    head = ("NRRD0004\ntype: short\ndimension: 4\nsizes: 6 4 5 2\nkinds: domain domain domain list\nendian: little\n"
            "encoding: raw\nspace: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4) {}\nspace origin: (1,2,3)\n\n")
    for none in ("none", "(nan,nan,nan)"):
        (tmp_path / "a.nrrd").write_bytes(head.format(none).encode() + numpy.stack([ramp("<i2")] * 2).tobytes())
        assert numpy.array_equal(palpate.load(tmp_path / "a.nrrd", frame=1).volume.geometry.spacing, (2, 3, 4))
    (tmp_path / "a.nrrd").write_bytes(head.format("(nan,0,nan)").encode() + bytes(480))
    refused(tmp_path / "a.nrrd", "spacing of nan")


# pynrrd 82: a space origin without a space says nothing.
def test_a_space_origin_of_nrrd_without_a_space_is_noted(tmp_path):
    (tmp_path / "a.nrrd").write_bytes(b"NRRD0005\ntype: int16\ndimension: 3\nsizes: 6 4 5\nendian: little\nencoding: raw\n"
                                      b"spacings: 2 3 4\nspace origin: (1,2,3)\n\n" + ramp("<i2").tobytes())
    assert numpy.array_equal(noted(tmp_path / "a.nrrd", "'space origin' but no space").geometry.spacing, (2, 3, 4))


# ome-zarr-py 298: a store in an archive.
def test_archives_are_named_as_such_however_they_are_opened(tmp_path):
    (tmp_path / "a.zarr.zip").write_bytes(struct.pack("<I", 0x04034B50) + bytes(100))
    refused(tmp_path / "a.zarr.zip", "unpack it")
    with pytest.raises(palpate.InputError, match="unpack it"):
        palpate.open_store(str(tmp_path / "a.zarr.zip"))


# Meshes -----------------------------------------------------------------------------------------------------


# assimp 5890, tinyobjloader 389. A path of Windows at the end of a comment is no continued line.
@pytest.mark.parametrize("end", ("\n", "\r\n"))
def test_comments_end_lines_of_an_obj_file_and_are_never_continued(tmp_path, end):
    lines = ("# from C:\\models\\", "v 0 0 0 # first", "v 1 0 0#second", "v 0 1 0", "f 1 2 \\", "3 # all")
    (tmp_path / "a.obj").write_bytes("".join(line + end for line in lines).encode())
    mesh = palpate.read_mesh(tmp_path / "a.obj")
    assert numpy.array_equal(mesh.vertices, ((0, 0, 0), (1, 0, 0), (0, 1, 0))) and len(mesh.triangles) == 1


def test_an_stl_text_may_begin_with_blanks(tmp_path):
    (tmp_path / "a.stl").write_text("\n  solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                                    "endloop\nendfacet\nendsolid a\n")
    assert len(palpate.read_mesh(tmp_path / "a.stl").triangles) == 1


# pynrrd 12, ITK's MetaIO: the samples of a header may be in several files, by a list or by numbers.
@pytest.mark.parametrize("form", ("NRRD", "MetaImage"))
@pytest.mark.parametrize("packed", (False, True))
@pytest.mark.parametrize("names, step", (("LIST\n4.raw\n3.raw\n2.raw\n1.raw\n0.raw", -1), ("%d.raw 4 0 -1", -1), ("%02d.raw 0 4 1", 1),
                                         ("LIST 2\n0.raw\n1.raw\n2.raw\n3.raw\n4.raw\n", 1)))
def test_the_slices_of_a_header_may_be_in_several_files(tmp_path, form, packed, names, step):
    for i, plane in enumerate(ramp("<i2")):
        data = gzip.compress(plane.tobytes()) if packed else plane.tobytes()
        for name in (f"{i}.raw", f"{i:02}.raw"):
            (tmp_path / name).write_bytes(data)
    path = tmp_path / ("a.nhdr" if form == "NRRD" else "a.mhd")
    path.write_text("NRRD0004\ntype: short\ndimension: 3\nsizes: 6 4 5\nendian: little\nspacings: 2 3 4\n"
                    f"encoding: {'gzip' if packed else 'raw'}\ndata file: {names}" if form == "NRRD" else
                    "NDims = 3\nDimSize = 6 4 5\nElementSpacing = 2 3 4\nElementType = MET_SHORT\n"
                    f"CompressedData = {packed}\nElementDataFile = {names}")
    volume = palpate.load(path).volume
    assert numpy.array_equal(volume.array, ramp("i2")[::step]) and numpy.array_equal(volume.geometry.spacing, (2, 3, 4))
    (tmp_path / "3.raw").rename(tmp_path / "03.raw")
    (tmp_path / "03.raw").write_bytes(bytes(5))
    refused(path, "3.raw'")
    path.write_text(path.read_text().replace("%d.raw 4 0 -1", "%d.raw 3 0 -1").replace("0 4 1", "0 3 1").replace("\n0.raw", ""))
    refused(path, "4 data files for 5 slices")


def test_a_list_of_meta_image_may_say_2d_and_blanks_may_stand_before_ome_xml(tmp_path):
    for i, plane in enumerate(ramp("i2")):
        (tmp_path / f"{i}.raw").write_bytes(plane.tobytes())
    names = "".join(f"{i}.raw\n" for i in range(5))
    (tmp_path / "a.mhd").write_text("NDims = 3\nDimSize = 6 4 5\nElementType = MET_SHORT\nElementSpacing = 2 3 4\n"
                                    f"BinaryDataByteOrderMSB = False\nElementDataFile = LIST 2D\n{names}")
    assert numpy.array_equal(palpate.load(tmp_path / "a.mhd").volume.array, ramp("i2"))
    xml = ('\n <?xml version="1.0"?><OME><Image><Pixels DimensionOrder="XYZCT" Type="uint16" SizeX="6" SizeY="4" SizeZ="5" SizeC="1" '
           'SizeT="1" PhysicalSizeX="2" PhysicalSizeY="3" PhysicalSizeZ="4"><TiffData/></Pixels></Image></OME>')
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), description=xml, metadata=None)
    assert numpy.allclose(palpate.load(tmp_path / "a.tif").volume.geometry.spacing, (2e-3, 3e-3, 4e-3))


@pytest.mark.parametrize("names, words", (("%d.raw 5 1 1", "is empty"), ("%d.raw 1 5 0", "make no sense"), ("LIST\n\n", "is empty"),
                                          ("%d.raw 0 99999999 1", "more than 65536"), ("%d.raw 1 5 -1", "is empty"),
                                          ("%d.raw 1 5000000000 1", "make no sense"), ("%1000000000d.raw 1 5 1", "cannot be read"),
                                          ("%d.raw 1073741824 1073741824 1073741824", "cannot be read"),
                                          ("LIST\n" + "a" * 300000, "too long"), ("LIST\n" + "a/" * 3000, "too long")), ids=range(10))
def test_lists_of_data_files_that_make_no_sense_are_refused(tmp_path, names, words):
    head = "NRRD0004\ntype: short\ndimension: 3\nsizes: 6 4 5\nendian: little\nencoding: raw\ndata file: "
    (tmp_path / "a.nhdr").write_text(head + names)
    (tmp_path / "a.mhd").write_text(f"NDims = 3\nDimSize = 6 4 5\nElementType = MET_SHORT\nElementDataFile = {names}")
    refused(tmp_path / "a.nhdr", words)
    refused(tmp_path / "a.mhd", words)


# nibabel 1004, vtk-dicom 96: pairs of files, of NIfTI and of the format before it, which does not place the body.
@pytest.mark.parametrize("packed", ("", ".gz"))
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("kind", (nibabel.Nifti1Pair, nibabel.Nifti2Pair, nibabel.AnalyzeImage, nibabel.Spm2AnalyzeImage))
def test_a_pair_of_header_and_image_is_one_volume(tmp_path, kind, order, packed):
    header, affine = kind.header_class(endianness=order), numpy.diag([-2, -3, 4, 1])
    header.set_data_dtype("i2")
    image = kind(ramp("i2").T, affine, header)
    nibabel.save(image, tmp_path / "a.img")
    if kind is nibabel.Spm2AnalyzeImage:  # nibabel writes a slope of its own
        data = bytearray((tmp_path / "a.hdr").read_bytes())
        data[112:116] = struct.pack(order + "f", 0.5)
        (tmp_path / "a.hdr").write_bytes(data)
    for name in ("a.hdr", "a.img") if packed else ():
        (tmp_path / (name + packed)).write_bytes(gzip.compress((tmp_path / name).read_bytes()))
        (tmp_path / name).unlink()
    is_nifti = "Nifti" in kind.__name__
    for name in ("a.hdr", "a.img"):
        loaded = palpate.load(tmp_path / (name + packed))
        assert numpy.array_equal(loaded.volume.array, nibabel.load(tmp_path / ("a.img" + packed)).get_fdata().T)
        geometry = loaded.volume.geometry
        assert numpy.array_equal(geometry.spacing, (2, 3, 4)) and geometry.oriented == is_nifti
        assert numpy.array_equal(geometry.direction, numpy.eye(3))
    (tmp_path / ("a.hdr" + packed)).unlink()
    refused(tmp_path / ("a.img" + packed), "the other is not beside it")


def test_a_slice_of_dicom_may_be_called_img(tmp_path):
    path = save(tmp_path / "a", stack(ramp("i2")[:1])) / "001.dcm"
    assert numpy.array_equal(palpate.load(path.rename(tmp_path / "a.img")).volume.array, ramp("i2")[:1])


def grey_tiff(path, pages, bits, fill_order=1):
    """Pages of 6x4 samples of so many bits, as they are."""
    data = b"II*\0" + struct.pack("<I", 8)
    for page in pages:
        entries = {256: 6, 257: 4, 258: bits, 259: 1, 262: 1, 277: 1, 278: 4, 279: len(page), 266: fill_order}
        entries[273] = len(data) + 2 + 12 * (len(entries) + 1) + 4
        data += struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in
                                                            sorted(entries.items()))
        following = entries[273] + len(page)
        data += struct.pack("<I", 0 if page is pages[-1] else following) + page
    path.write_bytes(data)
    return path


# tifffile, Fiji: masks of one bit, and cameras of 10 and 12 bits, packed without a gap; rows begin at bytes.
@pytest.mark.parametrize("bits", (1, 2, 4, 6, 10, 12, 14))
def test_samples_of_any_number_of_bits_are_read(tmp_path, bits):
    array = ramp("u2") * 67 % 2**bits
    rows = [["".join(f"{sample:0{bits}b}" for sample in row) for row in plane] for plane in array]
    pages = [b"".join(int(row.ljust(-len(row) % 8 + len(row), "0"), 2).to_bytes((len(row) + 7) // 8, "big") for row in plane)
             for plane in rows]
    assert numpy.array_equal(palpate.load(grey_tiff(tmp_path / "a.tif", pages, bits)).volume.array, array)
    reverse = [bytes(int(f"{byte:08b}"[::-1], 2) for byte in page) for page in pages]
    assert numpy.array_equal(palpate.load(grey_tiff(tmp_path / "b.tif", reverse, bits, 2)).volume.array, array)


@pytest.mark.parametrize("name", ("a.lsm", "a.btf", "a.tf8", "a.data"))
def test_a_tiff_of_another_name_is_known_by_its_bytes(tmp_path, name):
    for big in (False, True):
        tifffile.imwrite(tmp_path / name, ramp("i8"), photometric="minisblack", metadata=None, bigtiff=big, byteorder="><"[big])
        assert numpy.array_equal(palpate.load(tmp_path / name).volume.array, ramp("i8"))


def region(units=3, x=0.02, y=-0.03):
    part = Dataset()
    part.PhysicalUnitsXDirection = part.PhysicalUnitsYDirection = units
    part.PhysicalDeltaX, part.PhysicalDeltaY = x, y
    return part


# OHIF 202, VolView 863: ultrasound has the size of its pixels with its regions.
@pytest.mark.parametrize("regions, spacing, note", (
    ([region()], (0.2, 0.3), "of its ultrasound regions"), ([region(4), region()], (0.2, 0.3), "of its ultrasound regions"),
    ([region(), region(x=0.05)], (1, 1), "different sizes"), ([region(4)], (1, 1), "no pixel spacing")))
def test_pixels_of_ultrasound_have_the_size_of_their_region(tmp_path, regions, spacing, note):
    changes = {"PixelSpacing": None, "SequenceOfUltrasoundRegions": regions, "Modality": "US"}
    folder = save(tmp_path / "a", [slice_of(ramp("u1")[0], 1, (1, 2, 3), **changes)])
    assert numpy.allclose(noted(folder, note).geometry.spacing[:2], spacing)


def test_values_of_pet_have_the_units_of_their_tag(tmp_path):
    change = lambda i: {"Modality": "PT", "Units": "BQML", "RescaleSlope": 1 + i}
    assert palpate.load(save(tmp_path / "a", stack(ramp("i2"), change=change))).values["units"] == "BQML"


# dicom-numpy 1: a program may lose the slope of a slice, or the intercept.
@pytest.mark.parametrize("lost", ({"RescaleSlope": None}, {"RescaleIntercept": None}))
def test_a_slice_that_lacks_the_slope_or_the_intercept_of_the_others_is_named(tmp_path, lost):
    change = lambda i: {"RescaleSlope": 2, "RescaleIntercept": -5, **(lost if i == 1 else {})}
    noted(save(tmp_path / "some", stack(ramp("i2"), change=change)), "1 of its 5 slices (the first in '002.dcm') gives no slope or no")
    loaded = palpate.load(save(tmp_path / "all", stack(ramp("i2"), change=lambda i: {**change(i), **lost})))
    assert not any("of its 5 slices" in note for note in loaded.notes), loaded.notes


# STIR 1123: frames have a mapping to real values of their own, which is not applied.
def test_a_mapping_of_values_in_the_groups_of_frames_is_noted(tmp_path):
    group = lambda i: {"RealWorldValueMappingSequence": items(RealWorldValueSlope=0.5, RealWorldValueIntercept=0.0)}
    noted(enhanced(tmp_path / "a", list(ramp("u2")), range(5), group), "Real World Value Mapping")


# dcm2niix: reports of a scanner and spectra lie beside the images; numbers that no image needs may be words.
def test_objects_without_an_image_beside_slices_are_passed_over(tmp_path):
    change = lambda i: {"InstanceNumber": None, "RescaleSlope": [2, 2]}
    slices = stack(ramp("i2"), change=change)
    for i, data in enumerate(slices):
        data.add(pydicom.DataElement(0x00200013, "LO", f"A{i}"))
        data.add(pydicom.DataElement(0x00200012, "LO", "one"))
    folder = tmp_path / "a"
    folder.mkdir()
    report, spectrum = Dataset(), slice_of(ramp("i2")[0], 1, (1, 2, 3), PixelData=None)
    report.SOPClassUID, report.SOPInstanceUID, report.SeriesInstanceUID = "1.3.12.2.1107.5.9.1", "1.2.9", "1.2.10"
    spectrum.SOPClassUID = "1.2.840.10008.5.1.4.1.1.4.2"
    for i, data in enumerate((*slices, report, spectrum)):
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = data.SOPClassUID, data.SOPInstanceUID
        meta.TransferSyntaxUID = "1.2.840.10008.1.2.1"
        file = FileDataset(str(folder / f"{i}.dcm"), data, file_meta=meta, preamble=bytes(128))
        file.is_little_endian, file.is_implicit_VR = True, False
        file.save_as(file.filename, write_like_original=False)
    assert numpy.array_equal(palpate.load(folder).volume.array, ramp("i2") * 2)


# assimp, Blender: a text of Windows may begin with a byte order mark, in front of the first vertex.
def test_a_byte_order_mark_does_not_hide_the_first_vertex_of_an_obj_file(tmp_path):
    text = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nv 50 50 50\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (tmp_path / "a.obj").write_text(text)
    (tmp_path / "b.obj").write_text("\ufeff" + text, encoding="utf-8")
    plain, marked = (palpate.read_mesh(tmp_path / name) for name in ("a.obj", "b.obj"))
    assert numpy.array_equal(plain.vertices, marked.vertices) and len(marked.vertices) == 5


@pytest.mark.parametrize("field", ("line skip: 0", "line skip: 1", "encoding: gzip"))
def test_a_pipe_is_no_data_file_and_is_not_waited_for(tmp_path, field):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "a.nhdr").write_text(f"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\n{'' if 'enc' in field else 'encoding: raw' + chr(10)}"
                                     f"{field}\ndata file: pipe\n\n")
    refused(tmp_path / "a.nhdr", "'pipe' cannot be read")


def test_a_header_of_envi_is_named(tmp_path):
    (tmp_path / "a.hdr").write_text("ENVI\nsamples = 8\nlines = 8\nbands = 8\n")
    (tmp_path / "a.img").write_bytes(bytes(512))
    refused(tmp_path / "a.hdr", "ENVI")
    refused(tmp_path / "a.img", "ENVI")
