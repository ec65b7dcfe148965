"""Generated families of files, each compared with an independent reader: DICOM with pydicom, NRRD with Teem's unu, HDF5
with h5py, Zarr with zarr; and units of length in every format that has them."""

import json
import subprocess

import h5py
import nibabel
import numpy
import palpate
import pydicom
import pydicom.pixel_data_handlers.util
import pytest
import tifffile
import zarr
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset

NAN, INFINITE = float("nan"), float("inf")
SHAPE = (5, 4, 6)  # z, y, x


def ramp(dtype, shape=SHAPE, first=0):
    return (numpy.arange(numpy.prod(shape)).reshape(shape) * 7 % 250 + first).astype(dtype)


def refused(path, *words):
    with pytest.raises(palpate.InputError) as caught:
        palpate.load(path)
    message = str(caught.value)
    assert "\n" not in message and all(word in message for word in words), message


def noted(path, word):
    loaded = palpate.load(path)
    assert any(word in note for note in loaded.notes), loaded.notes
    return loaded.volume


# DICOM, compared with pydicom -----------------------------------------------------------------------

SYNTAXES = {"implicit": "1.2.840.10008.1.2", "explicit": "1.2.840.10008.1.2.1", "big": "1.2.840.10008.1.2.2",
            "deflated": "1.2.840.10008.1.2.1.99", "RLE": "1.2.840.10008.1.2.1"}


def slice_of(pixels, number, position, **changes):
    data = Dataset()
    data.SOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
    data.SOPInstanceUID, data.SeriesInstanceUID = f"1.2.3.{number}", "1.2.4"
    data.Modality, data.InstanceNumber, data.PatientName = "CT", number, "Nobody"
    data.ImagePositionPatient, data.ImageOrientationPatient = list(position), [1, 0, 0, 0, 1, 0]
    data.PixelSpacing, data.SliceThickness = [0.5, 0.25], 2
    data.Rows, data.Columns = pixels.shape
    data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
    data.BitsAllocated = data.BitsStored = 8 * pixels.dtype.itemsize
    data.HighBit = data.BitsStored - 1
    data.PixelRepresentation = int(pixels.dtype.kind == "i")
    data.RescaleSlope, data.RescaleIntercept = 1, 0
    data.PixelData = pixels.tobytes()
    for name, value in changes.items():
        if value is None:
            del data[name]
        else:
            setattr(data, name, value)
    return data


def save(folder, slices, syntax="explicit"):
    folder.mkdir()
    for data in slices:
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = data.SOPClassUID, data.SOPInstanceUID
        meta.TransferSyntaxUID = SYNTAXES[syntax]
        path = folder / f"{data.InstanceNumber:03}.dcm"
        file = FileDataset(str(path), data, file_meta=meta, preamble=b"\0" * 128)
        file.is_little_endian, file.is_implicit_VR = syntax != "big", syntax == "implicit"
        if syntax == "big" and data.BitsAllocated == 16:
            file.PixelData = numpy.frombuffer(data.PixelData, "<u2").byteswap().tobytes()
        if syntax == "RLE":
            file.compress("1.2.840.10008.1.2.5")
        file.save_as(path, write_like_original=False)
    return folder


def stack(array, step=2.0, start=3.0, change=lambda i: {}):
    return [slice_of(plane, i + 1, (1, 2, start + step * i), **change(i)) for i, plane in enumerate(array)]


def expect_pydicoms(folder):
    """Every value, and the place of the first and the last sample."""
    volume = palpate.load(folder).volume
    files = sorted((pydicom.dcmread(path) for path in folder.iterdir()), key=lambda data: data.ImagePositionPatient[2])
    for plane, data in enumerate(files):
        values = pydicom.pixel_data_handlers.util.apply_modality_lut(data.pixel_array, data)
        assert numpy.allclose(volume.array[plane], values, rtol=1e-6)
    rows, columns = files[0].PixelSpacing
    for plane, data in ((0, files[0]), (len(files) - 1, files[-1])):
        corner = numpy.array(data.ImagePositionPatient, float) + ((data.Columns - 1) * columns, (data.Rows - 1) * rows, 0)
        assert numpy.allclose(volume.geometry.physical((data.Columns - 1, data.Rows - 1, plane)), corner)


@pytest.mark.parametrize("syntax", SYNTAXES)
@pytest.mark.parametrize("dtype", ("u1", "i1", "u2", "i2"))
def test_dicom_of_every_type_and_syntax(tmp_path, dtype, syntax):
    first = -100 if dtype[0] == "i" else 0
    expect_pydicoms(save(tmp_path / "a", stack(ramp(dtype, first=first).clip(-100, 100).astype(dtype)), syntax))


@pytest.mark.parametrize("slope, intercept", ((1, -1024), (2, 5), (-1, 0), (0.5, -3.25), (1e-10, 0), (1, 1e10)))
def test_dicom_of_every_slope_and_intercept_the_same_or_one_for_each_slice(tmp_path, slope, intercept):
    for name, grow in (("same", 0), ("each", 1)):
        change = lambda i: {"RescaleSlope": slope * (1 + grow * i), "RescaleIntercept": intercept + grow * i}
        expect_pydicoms(save(tmp_path / name, stack(ramp("i2"), change=change)))


@pytest.mark.parametrize("slope", ("0", "nan"))
def test_a_slope_that_makes_no_sense_is_noted(tmp_path, slope):
    slices = stack(ramp("i2"), change=lambda i: {"RescaleSlope": None})
    for data in slices:
        data.add(pydicom.DataElement(0x00281053, "LO", slope))
    assert numpy.array_equal(noted(save(tmp_path / "a", slices), "RescaleSlope").array, ramp("i2"))


@pytest.mark.parametrize("step", (5.0, 0.5, 0.1, 0.01, 0.003, 0.001))
def test_slices_are_told_apart_and_missing_ones_noticed_however_near_they_are(tmp_path, step):
    change = lambda i: {"PixelSpacing": [step, step]}
    slices = stack(ramp("i2"), step, 0, change)
    expect_pydicoms(save(tmp_path / "all", slices))
    volume = noted(save(tmp_path / "some", slices[:2] + slices[3:]), "1 of 5 slices are missing")
    assert list(volume.geometry.size) == [6, 4, 5] and numpy.allclose(volume.geometry.spacing, step)


def test_directions_and_spacings_that_differ_by_rounding_are_one_series(tmp_path):
    change = lambda i: {"ImageOrientationPatient": [1, 0.00049 + 2e-5 * (i % 2), 0, -0.00049 - 2e-5 * (i % 2), 1, 0],
                        "PixelSpacing": [0.48849 + 2e-5 * (i % 2)] * 2}
    assert list(palpate.load(save(tmp_path / "a", stack(ramp("i2"), change=change))).volume.geometry.size) == [6, 4, 5]


def test_slices_without_a_position_lie_at_their_slice_location(tmp_path):
    change = lambda i: {"ImagePositionPatient": None, "SliceLocation": 20 - 3 * i}
    volume = noted(save(tmp_path / "a", stack(ramp("i2"), change=change)), "SliceLocation")
    assert volume.geometry.spacing[2] == 3 and numpy.array_equal(volume.array, ramp("i2")[::-1])


def test_slices_without_an_orientation_lie_at_their_slice_location_or_at_their_positions(tmp_path):
    for name, sign, more in (("SliceLocation", -2.5, {"ImagePositionPatient": None}), ("positions", 2.5, {})):
        change = lambda i: {"ImageOrientationPatient": None, "SliceThickness": 1.25, "SliceLocation": sign * i, **more}
        volume = noted(save(tmp_path / name, stack(ramp("i2"), -2.5, change=change)), "their " + name)
        assert volume.geometry.spacing[2] == 2.5 and numpy.array_equal(volume.array, ramp("i2")[::-1])


@pytest.mark.parametrize("second", ({"ImageType": ["ORIGINAL", "PRIMARY", "P"]}, {"EchoTime": 9.8}))
def test_images_of_another_kind_in_one_series_are_chosen_and_not_played(tmp_path, second):
    first = {"ImageType": ["ORIGINAL", "PRIMARY", "M"], "EchoTime": 4.9}
    slices = stack(ramp("i2"), change=lambda i: first) + stack(ramp("i2") + 1000, change=lambda i: {**first, **second})
    for number, data in enumerate(slices):
        data.InstanceNumber, data.SOPInstanceUID = number + 1, f"1.2.3.{number}"
    folder = save(tmp_path / "a", slices)
    with pytest.raises(palpate.SeriesChoice) as caught:
        palpate.load(folder)
    assert len({series["description"] for series in caught.value.series}) == 2
    least = [palpate.load(folder, series=str(number)).volume.minimum for number in (1, 2)]
    assert sorted(least) == [ramp("i2").min(), 1000 + ramp("i2").min()]


@pytest.mark.parametrize("order", ([1, 2, 3, 4, 5], [5, 4, 3, 2, 1], [2, 1, 5, 3, 4], [1, 1, 2, 2, 3]))
def test_frames_of_nuclear_medicine_lie_where_their_slice_vector_says(tmp_path, order):
    data = slice_of(ramp("u2")[0], 1, (1, 2, 3), SOPClassUID="1.2.840.10008.5.1.4.1.1.20", Modality="NM",
                    NumberOfFrames=len(order), FrameIncrementPointer=0x00540080, SliceVector=order,
                    SpacingBetweenSlices=2, PixelData=ramp("u2").tobytes())
    folder = save(tmp_path / "a", [data])
    if len(set(order)) < len(order):
        return refused(folder, "SliceVector")
    assert numpy.array_equal(palpate.load(folder).volume.array, ramp("u2")[numpy.argsort(order)])


def test_a_pixel_spacing_of_three_numbers_is_refused(tmp_path):
    refused(save(tmp_path / "a", stack(ramp("i2"), change=lambda i: {"PixelSpacing": [1, 2, 3]})), "PixelSpacing", "3")


def test_the_spacing_at_a_detector_and_mapped_values_are_noted(tmp_path):
    imager = lambda i: {"PixelSpacing": None, "ImagerPixelSpacing": [0.5, 0.25]}
    assert noted(save(tmp_path / "a", stack(ramp("i2"), change=imager)), "ImagerPixelSpacing").geometry.spacing[0] == 0.25
    mapped = lambda i: {"RealWorldValueMappingSequence": [Dataset()]}
    noted(save(tmp_path / "b", stack(ramp("i2"), change=mapped)), "Real World Value")


@pytest.mark.parametrize("dtype", ("u2", "i2"))
def test_samples_above_the_lowest_bits_are_shifted_down(tmp_path, dtype):
    array = ramp(dtype) * 8 - (500 if dtype == "i2" else 0)
    change = lambda i: {"BitsStored": 12, "HighBit": 15}
    volume = noted(save(tmp_path / "a", stack((array * 16).astype(dtype), change=change)), "HighBit")
    assert numpy.array_equal(volume.array, array)


@pytest.mark.parametrize("colours", ("PALETTE COLOR", "RGB", "YBR_FULL"))
def test_colours_are_refused_in_one_line(tmp_path, colours):
    refused(save(tmp_path / "a", stack(ramp("u1"), change=lambda i: {"PhotometricInterpretation": colours})), "colours")


@pytest.mark.parametrize("vr, code", (("FD", "d"), ("FL", "f"), ("SS", "h"), ("US", "H"), ("SL", "i"), ("UT", "")))
def test_a_slope_of_another_type_of_element_is_read(tmp_path, vr, code):
    slices = stack(ramp("i2"), change=lambda i: {"RescaleSlope": None})
    for data in slices:
        data.add(pydicom.DataElement(0x00281053, vr, 2 if code else "2"))
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", slices)).volume.array, 2 * ramp("i2"))


# NRRD, compared with unu ----------------------------------------------------------------------------

NRRD = "NRRD0005\ntype: {kind}\ndimension: 3\nsizes: 6 4 5\nspacings: 1 2 3\n{more}\n"
TEXTS = {"blanks": " ".join, "lines": "\n".join, "commas": ", ".join}


def expect_unus(path, kind, dtype):
    out = path.with_suffix(".out.nrrd")
    subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", "raw", "-i", path, "-o", out], check=True)
    data = out.read_bytes()[-int(numpy.prod(SHAPE)) * numpy.dtype(dtype).itemsize:]
    values = numpy.frombuffer(data, dtype).reshape(SHAPE).astype("float32")
    finite = numpy.isfinite(values)
    volume = palpate.load(path).volume
    assert numpy.array_equal(volume.array, numpy.where(finite, values, values[finite].min())), kind


@pytest.mark.parametrize("text", TEXTS)
def test_nrrd_as_text(tmp_path, text):
    for kind, dtype in (("int16", "i2"), ("uchar", "u1"), ("float", "f4")):
        array = ramp(dtype)
        words = [str(value) for value in array.ravel()]
        if dtype == "f4":
            words[0], words[1], words[2] = "nan", "inf", "-inf"
        path = tmp_path / f"{kind}.nrrd"
        path.write_text(NRRD.format(kind=kind, more="encoding: ascii\n") + TEXTS[text](words))
        expect_unus(path, kind, dtype)


@pytest.mark.parametrize("order", "<>")
def test_nrrd_of_every_type_behind_lines_and_bytes(tmp_path, order):
    for kind, dtype in (("int8", "i1"), ("uint8", "u1"), ("int16", "i2"), ("uint16", "u2"), ("int32", "i4"),
                        ("uint32", "u4"), ("float", "f4"), ("double", "f8")):
        data = ramp(dtype, first=-100 if dtype == "i1" else 0).astype(order + dtype).tobytes()
        (tmp_path / "a.raw").write_bytes(b"one\ntwo\n1234567" + data)
        more = f"endian: {'little' if order == '<' else 'big'}\nencoding: raw\ndata file: a.raw\n"
        for skips in ("line skip: 2\nbyte skip: 7\n", "byte skip: -1\n", "byteskip: 15\n"):
            path = tmp_path / f"{kind}.nhdr"
            path.write_text(NRRD.format(kind=kind, more=more + skips))
            expect_unus(path, kind, dtype)


# Fields of MetaImage that say two things --------------------------------------------------------------

META = "NDims = 3\nDimSize = 6 4 5\nElementType = {kind}\nElementSpacing = 1 2 3\n{more}ElementDataFile = LOCAL\n"


def meta(path, more="", kind="MET_SHORT", dtype="<i2"):
    path.write_bytes(META.format(kind=kind, more=more).encode() + ramp(dtype).tobytes())
    return path


def test_fields_of_meta_image_that_say_two_things(tmp_path):
    path = tmp_path / "a.mha"
    for more in ("Offset = 1 2 3\nPosition = 4 5 6\n", "Origin = 1 2 3\nOffset = 4 5 6\n", "ElementSize = 9 9 9\n"):
        assert numpy.array_equal(noted(meta(path, more), "differ").geometry.spacing, (1, 2, 3))
    refused(meta(path, "ElementByteOrderMSB = True\nBinaryDataByteOrderMSB = False\n"), "MSB")
    refused(meta(path, "HeaderSize = -1\nCompressedData = True\n"), "HeaderSize")
    for kind, dtype in (("MET_LONG", "<i4"), ("MET_ULONG", "<u4")):
        assert numpy.array_equal(palpate.load(meta(path, "", kind, dtype)).volume.array, ramp("i4"))


# Units of length, in every format that has them --------------------------------------------------------

UNITS = {"nm": 1e-6, "um": 1e-3, "micron": 1e-3, "microns": 1e-3, "Micrometer": 1e-3, "micrometre": 1e-3, "mm": 1,
         "millimeters": 1, "cm": 10, "decimeter": 100, "dm": 100, "m": 1000, "meter": 1000, "metres": 1000, "km": 1e6,
         "hectometer": 1e5, "inch": 25.4, "in": 25.4, "feet": 304.8, "yard": 914.4, "angstrom": 1e-7, "picometer": 1e-9,
         "thou": 0.0254}


def in_nrrd(path, unit):
    text = NRRD.format(kind="int16", more=f'endian: little\nencoding: raw\nunits: "{unit}" "{unit}" "{unit}"\n')
    path.with_suffix(".nrrd").write_bytes(text.encode() + ramp("<i2").tobytes())
    return palpate.load(path.with_suffix(".nrrd")).volume


def in_meta_image(path, unit):
    return palpate.load(meta(path.with_suffix(".mha"), f"DistanceUnits = {unit}\n")).volume


def in_image_j(path, unit):
    tifffile.imwrite(path.with_suffix(".tif"), ramp("u2"), imagej=True, resolution=(1, 0.5),
                     metadata={"axes": "ZYX", "spacing": 3, "unit": unit})
    return palpate.load(path.with_suffix(".tif")).volume


def in_ome_tiff(path, unit):
    lengths = {f"PhysicalSize{axis}": size for axis, size in zip("XYZ", (1, 2, 3))}
    units = {f"PhysicalSize{axis}Unit": unit for axis in "XYZ"}
    tifffile.imwrite(path.with_suffix(".ome.tif"), ramp("u2"), ome=True, photometric="minisblack",
                     metadata={"axes": "ZYX", **lengths, **units})
    return palpate.load(path.with_suffix(".ome.tif")).volume


def in_ome_zarr(path, unit):
    group = zarr.open_group(str(path), mode="w")
    group.create_dataset("0", data=ramp("u2"))
    scale = {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [3, 2, 1]}]}
    axes = [{"name": name, "type": "space", "unit": unit} for name in "zyx"]
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": [scale]}]
    store = palpate.open_store(str(path))
    return store.read((0, 0, 0), store.levels[0].size)


@pytest.mark.parametrize("write", (in_nrrd, in_meta_image, in_image_j, in_ome_tiff, in_ome_zarr))
def test_every_unit_of_length(tmp_path, write):
    for i, (unit, millimetres) in enumerate(UNITS.items()):
        spacing = write(tmp_path / str(i), unit).geometry.spacing
        assert numpy.allclose(spacing, numpy.multiply((1, 2, 3), millimetres), rtol=1e-6, atol=0), unit


# What TIFF files say of planes that TIFF does not know ---------------------------------------------------


def test_tiff_planes_that_are_no_slices_are_noted_or_refused(tmp_path):
    path = tmp_path / "a.tif"
    planes = [(33628, "I", 1, 0, True), (33629, "2I", 5, (1, 1) * 5, True)]  # MetaMorph
    tifffile.imwrite(path, ramp("u2")[0], photometric="minisblack", extratags=planes)
    refused(path, "MetaMorph", "5 planes")
    tifffile.imwrite(path, ramp("u2")[0], photometric=32844)  # logarithms of luminance
    refused(path, "PhotometricInterpretation 32844")


@pytest.mark.parametrize("shape", (SHAPE, (5, 40, 60)))
@pytest.mark.parametrize("dtype", ("u1", "i2", "f4"))
def test_a_tiff_of_ours_is_read_slice_by_slice_by_others(tmp_path, dtype, shape):
    for compress in (False, True):
        palpate.write(palpate.Volume(ramp(dtype, shape)), path := tmp_path / f"{compress}.tif", compress=compress)
        with tifffile.TiffFile(path) as file:
            assert numpy.array_equal(file.asarray(), ramp(dtype, shape))
            # ImageJ takes the samples for one piece, but for pages that have this tag.
            assert file.is_imagej and all(page.tags["Orientation"].value == 1 for page in file.pages)


# Segmentations -----------------------------------------------------------------------------------------


def test_segments_that_overlap_have_the_names_of_their_layer(tmp_path):
    path, names = tmp_path / "a.seg.nrrd", (("liver", 1, 0), ("tumour", 1, 1), ("bone", 2, 1))
    keys = "".join(f"Segment{i}_ID:=S{i}\nSegment{i}_Name:={name}\nSegment{i}_LabelValue:={value}\nSegment{i}_Layer:={layer}\n"
                   for i, (name, value, layer) in enumerate(names))
    header = ("NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 6 4 5\nencoding: raw\nkinds: list domain domain domain\n"
              "space: left-posterior-superior\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n")
    path.write_bytes((header + keys + "\n").encode() + bytes(240))
    for frame, expected in enumerate(({1: "liver"}, {1: "tumour", 2: "bone"})):
        assert palpate.load(path, frame=frame).values["labels"] == expected
    with pytest.raises(ValueError, match="overlap"):
        palpate.layers_by_label(palpate.load(path))


@pytest.mark.parametrize("dtype", ("u1", "i2", "i4", "u4", "i8", "f4", "f8"))
def test_labels_are_whole_numbers_of_any_type(tmp_path, dtype):
    path, labels = tmp_path / "a.nii", numpy.zeros(SHAPE, dtype)
    labels[1:4, 1:3, 1:4], labels[2, 2, 2] = 3, 7
    nibabel.save(nibabel.Nifti1Image(labels.T, numpy.diag([-1, -1, 1, 1]), dtype=labels.dtype), path)
    assert [layer.level for layer in palpate.layers_by_label(palpate.load(path)).layers] == [3, 7]
    for wrong in (3.5, 2 ** 24 + 1):
        if labels.dtype.kind == "f" or (labels.dtype.itemsize > 2 and wrong == 2 ** 24 + 1):
            labels[0, 0, 0] = wrong
            nibabel.save(nibabel.Nifti1Image(labels.T, numpy.eye(4), dtype=labels.dtype), path)
            with pytest.raises(ValueError, match="whole numbers"):
                palpate.layers_by_label(palpate.load(path))


OME = ('<?xml version="1.0"?>{comment}<{p}OME xmlns{x}="http://www.openmicroscopy.org/Schemas/OME/2016-06" UUID="urn:uuid:1">'
       '<{p}Image ID="Image:0"><{p}Pixels ID="Pixels:0" Type="uint16" DimensionOrder="XYZCT" SizeX="6" SizeY="4" SizeZ="5" '
       'SizeC="1" SizeT="1" PhysicalSizeX="1" PhysicalSizeY="2" PhysicalSizeZ="3">{data}</{p}Pixels></{p}Image></{p}OME>')


def ome(path, data="<{p}TiffData/>", prefix="", comment=""):
    text = OME.format(p=prefix, x=prefix and ":" + prefix[:-1], comment=comment, data=data.format(p=prefix))
    tifffile.imwrite(path, ramp("u2"), photometric="minisblack", description=text, metadata=None)
    return path


def test_ome_xml_with_prefixes_behind_comments_and_of_other_files(tmp_path):
    path = tmp_path / "a.ome.tif"
    for how in ({}, {"prefix": "ome:"}, {"comment": f"<!-- {'x' * 5000} -->"}):
        assert numpy.allclose(palpate.load(ome(path, **how)).volume.geometry.spacing, (1e-3, 2e-3, 3e-3)), how
    block = '<{{p}}TiffData IFD="{0}" FirstZ="{0}" PlaneCount="{1}"><{{p}}UUID>urn:uuid:{2}</{{p}}UUID></{{p}}TiffData>'
    refused(ome(path, block.format(0, 2, 1) + block.format(2, 3, 2)), "several files")
    noted(ome(path, block.format(0, 5, 2).replace("UUID>", 'UUID FileName="b.tif">', 1)), "another file")


def test_image_j_without_a_distance_between_slices_keeps_that_of_pixels(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), imagej=True, resolution=(2, 4),
                     metadata={"axes": "TYX", "unit": "um", "finterval": 0.5})
    volume = palpate.load(tmp_path / "a.tif", frame=1).volume
    assert numpy.allclose(volume.geometry.spacing[:2], (5e-4, 2.5e-4))


# Zarr and HDF5, compared with zarr and h5py -----------------------------------------------------------


def by_the_box(path):
    store = palpate.open_store(str(path))
    return store, store.read((0, 0, 0), store.levels[0].size).array


@pytest.mark.parametrize("order", "CF")
@pytest.mark.parametrize("fill", (NAN, INFINITE, -INFINITE, -1.5, 7, None))
def test_zarr_with_chunks_that_are_not_stored_and_samples_that_are_not_finite(tmp_path, fill, order):
    array = zarr.open(str(tmp_path / "a"), mode="w", shape=SHAPE, chunks=(2, 3, 4), dtype="f4", fill_value=fill, order=order)
    array[:4] = ramp("f4")[:4] + 10
    array[0, 0, 0], array[0, 0, 1] = NAN, INFINITE
    expected = array[:]
    if fill is None:
        expected[4:] = 0  # zarr leaves it open
    finite = numpy.isfinite(expected)
    store, values = by_the_box(tmp_path / "a")
    assert numpy.array_equal(values, numpy.where(finite, expected, expected[finite].min()))
    assert any("not finite" in note for note in store.notes)


@pytest.mark.parametrize("fill, value", (("0x40490fdb", numpy.float32(numpy.pi)), ("0x7fc00000", 0), ("NaN", 0), (2.5, 2.5)))
def test_fill_values_of_zarr_3(tmp_path, fill, value):
    (tmp_path / "zarr.json").write_text(json.dumps({
        "zarr_format": 3, "node_type": "array", "shape": [2, 2, 4], "data_type": "float32", "fill_value": fill,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [1, 2, 4]}}, "attributes": {},
        "chunk_key_encoding": {"name": "default"}, "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]}))
    (tmp_path / "c/0/0").mkdir(parents=True)
    (tmp_path / "c/0/0/0").write_bytes(numpy.arange(8, dtype="<f4").tobytes())
    assert numpy.all(by_the_box(tmp_path)[1][1] == value)


@pytest.mark.parametrize("names", (("z", "y", "x"), ("x", "y", "z"), ("Y", "X", "Z"), ("lat", "lon", "depth")))
def test_named_dimensions_of_a_zarr_array(tmp_path, names):
    array = zarr.open(str(tmp_path / "a"), mode="w", shape=SHAPE, chunks=(2, 3, 4), dtype="u2")
    array[:] = ramp("u2")
    array.attrs["_ARRAY_DIMENSIONS"] = names
    array.attrs["scale_factor"] = 0.1
    store, values = by_the_box(tmp_path / "a")
    lower = [name.lower() for name in names]
    expected = array[:].transpose([lower.index(name) for name in "zyx"]) if "x" in lower else array[:]
    assert numpy.array_equal(values, expected)
    assert any("scale_factor" in note for note in store.notes)
    assert any("names" in note for note in store.notes) == ("x" not in lower)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("filters", ({}, {"compression": "gzip"}, {"compression": "gzip", "shuffle": True, "fletcher32": True}))
def test_hdf5_of_big_data_viewer(tmp_path, filters, order):
    for dtype in ("u1", "u2", "i4", "f4"):
        path = tmp_path / f"{dtype}.h5"
        with h5py.File(path, "w") as file:
            file["s00/resolutions"], file["s00/subdivisions"] = [[1.0, 1, 1]], [[4, 3, 2]]
            array = ramp(dtype)
            if dtype == "f4":
                array[0, 0, 0] = NAN
            file.create_dataset("t00000/s00/0/cells", data=array.astype(order + dtype), chunks=(2, 3, 4), **filters)
        with h5py.File(path) as file:
            expected = file["t00000/s00/0/cells"][:].astype("float64")
        finite = numpy.isfinite(expected)
        assert numpy.array_equal(by_the_box(path)[1], numpy.where(finite, expected, expected[finite].min()))


@pytest.mark.parametrize("unit, note", (("um", ""), ("", "no unit"), (None, "no XML")))
def test_setups_of_big_data_viewer_have_any_numbers(tmp_path, unit, note):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for setup in (1, 3):
            file[f"s{setup:02d}/resolutions"], file[f"s{setup:02d}/subdivisions"] = [[1.0, 1, 1]], [[4, 3, 2]]
            file.create_dataset(f"t00000/s{setup:02d}/0/cells", data=ramp("u2", first=setup), chunks=(2, 3, 4))
    setups = "".join(f"<ViewSetup><id>{i}</id><name>n{i}</name><voxelSize><unit>{unit}</unit><size>2 3 4</size>"
                     "</voxelSize></ViewSetup>" for i in (1, 3))
    if unit is not None:
        (tmp_path / "a.xml").write_text(f"<SpimData><SequenceDescription><ViewSetups>{setups}</ViewSetups>"
                                        "</SequenceDescription></SpimData>")
    for channel, setup in enumerate((1, 3)):
        store = palpate.open_store(str(tmp_path / "a.h5"), channel=channel)
        volume = store.read((0, 0, 0), (6, 4, 5))
        assert numpy.array_equal(volume.array, ramp("u2", first=setup))
        scale = {"um": (0.002, 0.003, 0.004), "": (2, 3, 4), None: (1, 1, 1)}[unit]
        assert numpy.allclose(volume.geometry.spacing, scale)
        assert (store.channels == ["n1", "n3"]) == (unit is not None)
        assert any(note in text for text in store.notes) == bool(note)


# Neuroglancer's n5 -------------------------------------------------------------------------------------


def test_each_axis_of_n5_has_its_own_unit(tmp_path):
    root = zarr.N5Store(str(tmp_path / "a.n5"))
    array = zarr.create(SHAPE, chunks=(2, 3, 4), dtype="u2", store=root, path="0", overwrite=True)
    array[:] = ramp("u2")
    attributes = tmp_path / "a.n5/attributes.json"
    attributes.write_text(json.dumps({**json.loads(attributes.read_text() if attributes.exists() else "{}"), "n5": "2.0.0",
                                      "resolution": [1, 2, 3], "units": ["um", "nm", "mm"]}))
    one = tmp_path / "a.n5/0/attributes.json"
    one.write_text(json.dumps({**json.loads(one.read_text()), "resolution": [1, 2, 3], "units": ["um", "nm", "mm"]}))
    store = palpate.open_store(str(tmp_path / "a.n5/0"))
    assert numpy.allclose(store.levels[0].spacing, (1e-3, 2e-6, 3), rtol=1e-9, atol=0)
