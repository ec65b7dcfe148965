"""Headers that give a value twice, leave it out or give it in an unusual way are read as they are meant, or refused. No
output replaces a file that a header names."""

import gzip
import json
import os
import struct
import subprocess

import h5py
import nibabel
import numpy
import palpate
import pydicom
import pytest
import tifffile
import zarr
from formats_test import nrrd
from readers_test import SHAPE, noted, ramp, refused, save, slice_of, stack


def run(*arguments):
    """The exit status, and all that the program says."""
    done = subprocess.run([os.environ["PALPATE"], *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    return done.returncode, done.stdout


def meta_image(path, *fields, data=b"", file="LOCAL"):
    lines = ["NDims = 3", "DimSize = 6 4 5", "ElementType = MET_SHORT", "ElementSpacing = 1 2 3", *fields,
             f"ElementDataFile = {file}"]
    path.write_bytes("".join(line + "\n" for line in lines).encode() + data)
    return path


# Outputs ---------------------------------------------------------------------------------------------


def numbered_meta(folder):
    meta_image(folder / "y.mhd", file="part%d.raw 0 4 1")
    for number, plane in enumerate(ramp("i2")):
        (folder / f"part{number}.raw").write_bytes(plane.tobytes())
    return folder / "y.mhd", folder / "part3.raw"


def listed_nrrd(folder):
    (folder / "a.nhdr").write_text("NRRD0004\ntype: short\ndimension: 3\nsizes: 6 4 6\nendian: little\nencoding: gzip\n"
                                   "data file: LIST\nfirst.nii\nsecond.nii\n")
    for name, part in (("first.nii", ramp("i2")[:3]), ("second.nii", ramp("i2")[2:])):
        (folder / name).write_bytes(gzip.compress(part.tobytes()))
    return folder / "a.nhdr", folder / "second.nii"


def detached_meta(folder):
    meta_image(folder / "y.mhd", file="all.raw")
    (folder / "all.raw").write_bytes(ramp("i2").tobytes())
    return folder / "y.mhd", folder / "all.raw"


def series_of_headers(folder):
    for number in range(3):
        meta_image(folder / f"t_{number}.mhd", file=f"samples{number}.raw")
        (folder / f"samples{number}.raw").write_bytes(ramp("i2").tobytes())
    return folder / "t_%d.mhd", folder / "samples2.raw"


def store(folder):
    group = zarr.open_group(str(folder / "s.zarr"), mode="w")
    group.create_dataset("0", data=ramp("i2"), chunks=(2, 2, 3))
    group.attrs["multiscales"] = [{"version": "0.4", "axes": [{"name": name, "type": "space"} for name in "zyx"],
                                   "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 1]}]}]}]
    return folder / "s.zarr", folder / "s.zarr" / "0" / "1.0.1"


def metadata_of_store(folder):
    assert run("convert", "synthetic:sphere:16x16x16", folder / "s.zarr")[0] == 0
    return folder / "s.zarr", folder / "s.zarr" / "zarr.json"


def disc(folder):
    slices = save(folder / "IMAGES", stack(ramp("i2")))
    (folder / "DICOMDIR").write_bytes(b"")
    return folder, sorted(slices.iterdir())[1]


@pytest.mark.parametrize("make", (numbered_meta, listed_nrrd, detached_meta, series_of_headers, store, metadata_of_store, disc))
def test_an_output_replaces_no_file_that_is_read_with_its_source(tmp_path, make):
    source, read = make(tmp_path)
    before = read.read_bytes()
    output = tmp_path / "link.csv"
    hand = tmp_path / "hand.csv"
    hand.write_text("t,x,y,z\n0,0,0,0\n1,1,0,0\n")
    output.symlink_to(read)
    for name in (read, output):
        status, said = run("replay", source, "--isovalue", "50%", "--trajectory", hand, "--output", name)
        assert status == 2 and "is an input and would be replaced" in said, said
        assert read.read_bytes() == before
    status, said = run("replay", source, "--isovalue", "50%", "--trajectory", hand, "--output", tmp_path / "trace.csv")
    assert "would be replaced" not in said
    status, said = run("replay", source, "--isovalue", "50%", "--trajectory", hand, "--output", tmp_path / "trace.csv")
    assert "would be replaced" not in said


def test_converting_replaces_no_data_file_of_its_header(tmp_path):
    source, read = detached_meta(tmp_path)
    before = read.read_bytes()
    status, said = run("convert", source, read)
    assert status == 2 and "is an input and would be replaced" in said, said
    assert read.read_bytes() == before
    assert run("convert", source, tmp_path / "other.raw")[0] == 0


# Fields ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("twice, is_used", (("ElementSpacing = 1 2 5", True), ("DimSize = 6 5 4", True),
                                            ("Offset = 0 0 0\nOffset = 0 0 1", True), ("ElementSpacing = 1 2 3", False),
                                            ("Comment = a\nComment = b", False)))
def test_a_field_of_meta_image_that_is_given_twice_is_refused_if_it_counts(tmp_path, twice, is_used):
    path = meta_image(tmp_path / "a.mha", twice, data=ramp("i2").tobytes())
    if is_used:
        refused(path, "twice")
    else:
        assert (palpate.load(path).volume.array == ramp("i2")).all()


@pytest.mark.parametrize("space", ("space: RAS", "space dimension: 3"))
def test_spacings_of_a_nrrd_in_a_space_are_refused_with_what_to_do(tmp_path, space):
    refused(nrrd(tmp_path / "a.nrrd", ramp("i2"), space, "spacings: 0.5 0.7 2"), "write them as space directions")
    refused(nrrd(tmp_path / "b.nrrd", ramp("i2"), space, "spacings: 0.5 nan nan", "space directions: (1,0,0) (0,1,0) (0,0,1)"),
            "both a spacing and a direction")


def test_samples_behind_extensions_of_an_unknown_place_are_refused(tmp_path):
    head = bytearray(348)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, 6, 4, 5, 1, 1, 1, 1)
    struct.pack_into("<hh", head, 70, 4, 16)
    struct.pack_into("<4f", head, 76, 1, 1, 1, 1)
    head[344:348] = b"n+1\0"
    extension = struct.pack("<ii", 32, 6) + bytes(24)
    (tmp_path / "a.nii").write_bytes(bytes(head) + b"\1\0\0\0" + extension + ramp("i2").tobytes())
    refused(tmp_path / "a.nii", "vox_offset")
    (tmp_path / "b.nii").write_bytes(bytes(head) + b"\0\0\0\0" + ramp("i2").tobytes())
    assert (noted(tmp_path / "b.nii", "within itself").array == ramp("i2")).all()


@pytest.mark.parametrize("scaling, factor, note", (("0.5", 0.5, ""), ("0", 1, "DoseGridScaling"), ("nan", 1, "DoseGridScaling"),
                                                   ("", 1, "DoseGridScaling")))
def test_a_scaling_of_a_dose_that_makes_no_sense_is_noted(tmp_path, scaling, factor, note):
    data = slice_of(ramp("u2")[0], 1, (0, 0, 0))
    data.add_new(0x3004000E, "DS", scaling)
    path = save(tmp_path / "dose", [data])
    assert numpy.allclose(noted(path, note or "time" if note else "").array[0], factor * ramp("u2")[0])


def test_slope_and_intercept_are_not_those_of_a_dose(tmp_path):
    data = slice_of(ramp("u2")[0], 1, (0, 0, 0), RescaleSlope=2, RescaleIntercept=7)
    data.add_new(0x3004000E, "DS", "0.5")
    assert numpy.allclose(noted(save(tmp_path / "dose", [data]), "not those of a dose").array[0], 0.5 * ramp("u2")[0])


@pytest.mark.parametrize("scale", (None, [{"type": "scale", "scale": [2, 2, 2]}]))
def test_a_store_without_a_scale_has_no_known_spacing(tmp_path, scale):
    path = store(tmp_path)[0]
    group = zarr.open_group(str(path))
    images = group.attrs["multiscales"]
    images[0]["datasets"][0] = {"path": "0", **({"coordinateTransformations": scale} if scale else {})}
    group.attrs["multiscales"] = images
    told = json.loads(run("info", path, "--json", "--quiet")[1])
    assert told["spacing_known"] == (scale is not None)
    assert any("give no scale" in note for note in told["notes"]) == (scale is None)


# Attributes and members ------------------------------------------------------------------------------


def as_letters(text):
    return numpy.frombuffer(text.encode(), "S1")


@pytest.mark.parametrize("written", (as_letters, str, numpy.bytes_, float))
def test_attributes_of_imaris_may_be_texts_of_any_kind_or_numbers(tmp_path, written):
    with h5py.File(tmp_path / "a.ims", "w") as file:
        image = file.create_group("DataSetInfo/Image")
        for axis, end in enumerate((3, 8, 10)):
            image.attrs[f"ExtMin{axis}"], image.attrs[f"ExtMax{axis}"] = written("0"), written(str(end))
        image.attrs["Unit"] = "mm" if written is float else written("mm")
        channel = file.create_group("DataSet/ResolutionLevel 0/TimePoint 0/Channel 0")
        for name, size in zip("XYZ", SHAPE[::-1]):
            channel.attrs[f"ImageSize{name}"] = written(str(size))
        padded = numpy.zeros((8, 8, 8), "u2")
        padded[tuple(map(slice, SHAPE))] = ramp("u2")
        channel.create_dataset("Data", data=padded, chunks=(8, 8, 8))
    store_ = palpate.open_store(tmp_path / "a.ims")
    assert numpy.allclose(store_.levels[0].spacing, (0.5, 2, 2))
    assert (palpate.LoadedVolume(store_).volume.array == ramp("u2")).all()


def test_a_member_that_json_has_twice_is_refused(tmp_path):
    path = store(tmp_path)[0]
    zarray = path / "0" / ".zarray"
    zarray.write_text(zarray.read_text().replace('"fill_value"', '"shape": [5, 4, 5], "fill_value"'))
    status, said = run("info", path)
    assert status == 3 and "has a member twice" in said, said
    layers = tmp_path / "a.json"
    layers.write_text('{"palpate_layers": 1, "layers": [{"name": "a", "level": 100, "level": 300}]}')
    status, said = run("replay", "synthetic:sphere:8x8x8", "--layers", layers, "--trajectory", layers, "--output", tmp_path / "t")
    assert "has a member twice" in said, said


@pytest.mark.parametrize("twice", (False, True))
def test_an_attribute_that_xml_has_twice_is_refused(tmp_path, twice):
    size = 'PhysicalSizeX="1" PhysicalSizeY="1" PhysicalSizeZ="1" ' + ('PhysicalSizeX="2" ' if twice else "")
    xml = ('<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><Image><Pixels DimensionOrder="XYZCT" SizeX="6" '
           f'SizeY="4" SizeZ="5" SizeC="1" SizeT="1" Type="uint16" {size}><TiffData/></Pixels></Image></OME>')
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), description=xml, metadata=None)
    if twice:
        refused(tmp_path / "a.tif", "PhysicalSizeX", "twice")
    else:
        assert numpy.allclose(palpate.load(tmp_path / "a.tif").volume.geometry.spacing, 1e-3)


def test_tiles_that_are_not_read_one_by_one_are_converted_as_a_whole(tmp_path):
    samples = numpy.arange(256).reshape(1, 16, 16) % 16
    packed = (samples[0, :, ::2] * 16 + samples[0, :, 1::2]).astype("u1").tobytes()  # 4 bits each
    tags = ((256, 16), (257, 16), (258, 4), (259, 1), (262, 1), (277, 1), (322, 16), (323, 16), (324, 8), (325, len(packed)))
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags)
    (tmp_path / "a.tif").write_bytes(struct.pack("<2sHI", b"II", 42, 8 + len(packed)) + packed + struct.pack("<H", len(tags)) +
                                     entries + bytes(4))
    assert run("info", tmp_path / "a.tif")[0] == 0
    assert run("convert", tmp_path / "a.tif", tmp_path / "a.nrrd")[0] == 0
    assert (palpate.load(tmp_path / "a.nrrd").volume.array == samples).all()
    status, said = run("info", tmp_path / "a.tif", "--level", 0)
    assert status == 3 and "not read by the tile" in said


# Headers that say something in another way --------------------------------------------------------------


@pytest.mark.parametrize("told", ("C:\\scan\\a.raw", "sub\\a.raw", "/media/disc/scan/a.raw", "sub/a.raw"))
def test_a_data_file_that_was_moved_beside_its_header_is_found(tmp_path, told):
    (tmp_path / "a.raw").write_bytes(ramp("i2").tobytes())
    path = meta_image(tmp_path / "a.mhd", file=told)
    assert numpy.array_equal(noted(path, "not there").array, ramp("i2"))
    header = nrrd(tmp_path / "b.nhdr", ramp("i2"), f"data file: {told}")
    header.write_bytes(header.read_bytes()[:-ramp("i2").nbytes])
    assert numpy.array_equal(noted(header, "not there").array, ramp("i2"))
    (tmp_path / "b").mkdir()
    status, said = run("convert", path, tmp_path / "a.raw")  # it is the one that is read
    assert status != 0 and (tmp_path / "a.raw").read_bytes() == ramp("i2").tobytes(), said
    (tmp_path / "a.raw").unlink()
    refused(path, "a.raw", "cannot be read")


def test_a_data_file_is_first_where_its_header_says(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.raw").write_bytes(bytes(ramp("i2").nbytes))
    (tmp_path / "sub" / "a.raw").write_bytes(ramp("i2").tobytes())
    loaded = palpate.load(meta_image(tmp_path / "a.mhd", file="sub/a.raw"))
    assert numpy.array_equal(loaded.volume.array, ramp("i2")) and not any("not there" in note for note in loaded.notes)


@pytest.mark.parametrize("space", ("right anterior superior", "RightAnteriorSuperior", "right-anterior-superior", "RAS"))
def test_the_name_of_a_space_may_have_blanks_as_teem_reads_it(tmp_path, space):
    path = nrrd(tmp_path / "a.nrrd", ramp("i2"), f"space: {space}", "space directions: (1,0,0) (0,2,0) (0,0,3)",
                "space origin: (1,2,3)")
    geometry = palpate.load(path).volume.geometry
    assert numpy.array_equal(geometry.origin, (-1, -2, 3)) and geometry.oriented
    subprocess.run(["teem-unu", "save", "-f", "nrrd", "-i", path, "-o", tmp_path / "b.nrrd"], check=True)
    assert b"space: right-anterior-superior" in (tmp_path / "b.nrrd").read_bytes()


def nifti(path, change):
    image = nibabel.Nifti1Image(ramp("i2").transpose(2, 1, 0), numpy.diag([2, 2, 3, 1]))
    image.set_qform(numpy.diag([2, 2, 3, 1]), 1)
    image.set_sform(numpy.diag([2, 2, 3, 1]), 1)
    image.to_filename(path)
    header = bytearray(path.read_bytes())
    change(header)
    path.write_bytes(header)
    return path


@pytest.mark.parametrize("bits", (8, 12, 32))
def test_bits_that_do_not_fit_the_type_of_a_nifti_are_noted(tmp_path, bits):
    path = nifti(tmp_path / "a.nii", lambda header: header.__setitem__(slice(72, 74), struct.pack("<h", bits)))
    assert numpy.array_equal(noted(path, f"{bits} bits per sample").array, ramp("i2"))


def test_a_nifti_whose_sform_is_no_number_has_its_qform(tmp_path):
    path = nifti(tmp_path / "a.nii", lambda header: header.__setitem__(slice(280, 328), struct.pack("<12f", *[numpy.nan] * 12)))
    assert numpy.array_equal(noted(path, "its qform was taken").geometry.spacing, (2, 2, 3))


@pytest.mark.parametrize("syntax", ("explicit", "implicit"))
def test_a_dicom_image_without_a_class_is_read(tmp_path, syntax):
    save(tmp_path / "a", stack(ramp("i2")), syntax)
    for path in (tmp_path / "a").iterdir():
        data = pydicom.dcmread(path)
        del data.SOPClassUID, data.file_meta.MediaStorageSOPClassUID
        data.save_as(path)
    assert numpy.array_equal(noted(tmp_path / "a", "SOPClassUID").array, ramp("i2"))


def test_bits_beyond_the_stored_ones_are_noted(tmp_path):
    data = ramp("u2")
    fitting = [slice_of(plane, i, (0, 0, 2 * i), BitsStored=10, HighBit=9) for i, plane in enumerate(data)]
    loaded = palpate.load(save(tmp_path / "a", fitting))
    assert numpy.array_equal(loaded.volume.array, data) and not any("BitsStored" in note for note in loaded.notes)
    beyond = [slice_of(plane + 2000, i, (0, 0, 2 * i), BitsStored=10, HighBit=9) for i, plane in enumerate(data)]
    volume = noted(save(tmp_path / "b", beyond), "beyond the stored ones")
    assert numpy.array_equal(volume.array, data + 2000 & 1023)
    signed = (ramp("i2") - 300).view("u2")  # with and without an extended sign
    for name, mask in (("c", 0xffff), ("d", 0x3ff)):
        slices = [slice_of(plane & mask, i, (0, 0, 2 * i), BitsStored=10, HighBit=9, PixelRepresentation=1)
                  for i, plane in enumerate(signed)]
        loaded = palpate.load(save(tmp_path / name, slices))
        assert numpy.array_equal(loaded.volume.array, ramp("i2") - 300) and not any("BitsStored" in n for n in loaded.notes)


# MGH, compared with nibabel -----------------------------------------------------------------------------

CORONAL = [[-1, 0, 0, 90.5], [0, 0, 1.5, -120], [0, -2, 0, 80], [0, 0, 0, 1]]


def mgh(path, data, affine=None):
    image = nibabel.MGHImage(data.transpose(2, 1, 0), numpy.array(CORONAL if affine is None else affine, float))
    image.to_filename(path)
    return image


@pytest.mark.parametrize("dtype", ("u1", "i2", "i4", "f4"))
@pytest.mark.parametrize("name", ("a.mgh", "a.mgz"))
def test_mgh_is_read_as_nibabel_reads_it(tmp_path, name, dtype):
    image = mgh(tmp_path / name, ramp(dtype))
    volume = palpate.load(tmp_path / name).volume
    assert numpy.array_equal(volume.array, ramp(dtype)) and volume.geometry.oriented
    for index in ((0, 0, 0), (5, 3, 4)):
        x, y, z, _ = image.affine @ (*index, 1)
        assert numpy.allclose(volume.geometry.physical(index), (-x, -y, z), rtol=1e-6)


def test_an_oblique_mgh_with_footer_and_frames(tmp_path):
    angle = numpy.deg2rad(20)
    affine = numpy.diag([1.0, 2, 3, 1])
    affine[:3, :3] = [[numpy.cos(angle), -numpy.sin(angle), 0], [numpy.sin(angle), numpy.cos(angle), 0], [0, 0, 1]] @ affine[:3, :3]
    data = ramp("i2", (2, *SHAPE))
    image = nibabel.MGHImage(data.transpose(3, 2, 1, 0), affine)
    image.to_filename(path := tmp_path / "a.mgh")
    path.write_bytes(path.read_bytes() + bytes(10000))  # tags of FreeSurfer
    for packed in (False, True):
        if packed:
            (path := tmp_path / "b.mgz").write_bytes(gzip.compress((tmp_path / "a.mgh").read_bytes()))
        for frame, expected in enumerate(data):
            loaded = palpate.load(path, frame=frame)
            assert numpy.array_equal(loaded.volume.array, expected) and not any("ignored" in note for note in loaded.notes)
        x, y, z, _ = image.affine @ (1, 2, 3, 1)
        assert numpy.allclose(loaded.volume.geometry.physical((1, 2, 3)), (-x, -y, z), rtol=1e-5)
    store_ = palpate.open_store(str(tmp_path / "a.mgh"), time=1)
    assert numpy.array_equal(store_.read((0, 0, 0), store_.levels[0].size).array, data[1])


def test_an_mgh_without_a_place_is_noted_and_a_damaged_one_refused(tmp_path):
    mgh(path := tmp_path / "a.mgh", ramp("i2"))
    whole = path.read_bytes()
    path.write_bytes(whole[:28] + bytes(2) + whole[30:])
    geometry = noted(path, "goodRASFlag").geometry
    assert not geometry.oriented and numpy.array_equal(geometry.spacing, (1, 1, 1))
    coronal = numpy.array([[-1, 0, 0], [0, 0, 1], [0, -1, 0]])  # FreeSurfer's default: left, inferior, anterior
    for index in ((0, 0, 0), (5, 3, 4)):
        x, y, z = coronal @ (numpy.array(index) - geometry.size / 2)
        assert numpy.allclose(geometry.physical(index), (-x, -y, z))
    path.write_bytes(b"\0\0\2\1" + whole[4:])  # FreeSurfer 7.3: version 1 with the intent 2
    assert palpate.load(path).volume.geometry.oriented
    for damaged, words in ((whole[:400], "cut off"), (whole[:200], "no MGH file"), (b"\0\0\0\2" + whole[4:], "no MGH file"),
                           (b"\1\0\0\1" + whole[4:], "no MGH file"),
                           (whole[:20] + b"\0\0\0\7" + whole[24:], "type 7"), (whole[:4] + b"\xff" * 4 + whole[8:], "size"),
                           (whole[:30] + bytes(4) + whole[34:], "spacing of 0")):
        path.write_bytes(damaged)
        refused(path, words)


# MRC, by its format -------------------------------------------------------------------------------------


def mrc(path, data, mode, order="<", cell=(12, 12, 15), samples=None, axes=(1, 2, 3), start=(0, 0, 0), origin=(0, 0, 0), angles=(90,) * 3,
        kind=1, extended=b"", greatest=0, imod=None, letters=b"MAP ", stamp=None):
    """`cell` [Angstrom] and `samples` along x, y and z."""
    size = data.shape[::-1]
    head = bytearray(1024)
    struct.pack_into(f"{order}10i3f3f3i3f2i", head, 0, *size, mode, *start, *(samples or size), *cell, *angles, *axes, 0, greatest, 0,
                     kind, len(extended))
    if imod is not None:
        struct.pack_into(f"{order}2i", head, 152, 1146047817, imod)
    struct.pack_into(f"{order}3f", head, 196, *origin)
    head[208:212] = letters
    head[212:214] = stamp if stamp is not None else b"\x44\x44" if order == "<" else b"\x11\x11"
    path.write_bytes(bytes(head) + extended + data.astype(data.dtype.newbyteorder(order)).tobytes())
    return path


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("dtype, mode", (("i1", 0), ("i2", 1), ("f4", 2), ("u2", 6)))
def test_mrc_of_every_mode_and_byte_order(tmp_path, dtype, mode, order):
    data = (ramp("i4") - (125 if dtype == "i1" else 0)).astype(dtype)
    for stamp in (None, b"\0\0"):  # older files have none
        path = mrc(tmp_path / "a.mrc", data, mode, order, extended=b"x" * 80, stamp=stamp)
        loaded = palpate.load(path)
        assert numpy.array_equal(loaded.volume.array, data)
        assert numpy.allclose(loaded.volume.geometry.spacing, (2e-7, 3e-7, 3e-7)) and not loaded.volume.geometry.oriented
    (tmp_path / "b.map.gz").write_bytes(gzip.compress(path.read_bytes()))
    assert numpy.array_equal(palpate.load(tmp_path / "b.map.gz").volume.array, data)


def test_bytes_of_mrc_have_a_sign_unless_the_header_says_otherwise(tmp_path):
    data = ramp("u1")
    assert palpate.load(mrc(tmp_path / "a.mrc", data, 0)).volume.array.min() < 0
    for imod, signed in ((0, False), (1, True)):
        assert numpy.array_equal(palpate.load(mrc(tmp_path / "a.mrc", data, 0, imod=imod)).volume.array, data.view("i1") if signed else data)
    assert numpy.array_equal(noted(mrc(tmp_path / "a.mrc", data, 0, greatest=249), "unsigned").array, data)


@pytest.mark.parametrize("axes", ((1, 2, 3), (3, 2, 1), (2, 1, 3), (2, 3, 1), (0, 0, 0)))
def test_columns_of_mrc_may_lie_along_any_axis(tmp_path, axes):
    data, cell, samples = ramp("i2"), (60, 80, 90), (30, 20, 30)  # the map is a part of its cell
    spacing = numpy.divide(cell, samples)
    order = [axis - 1 for axis in axes] if any(axes) else [0, 1, 2]
    for origin in ((0, 0, 0), (10, 20, 30)):
        volume = palpate.load(mrc(tmp_path / "a.rec", data, 1, cell=cell, samples=samples, axes=axes, start=(1, 2, 3), origin=origin)).volume
        index, begin = (4, 2, 3), numpy.zeros(3)
        for column, axis in enumerate(order):
            begin[axis] = (origin[axis] if any(origin) else (1, 2, 3)[column] * spacing[axis])
        expected = begin.copy()
        for column, axis in enumerate(order):
            expected[axis] += index[column] * spacing[axis]
        assert numpy.allclose(volume.geometry.origin, begin * 1e-7)
        assert numpy.allclose(volume.geometry.physical(index), expected * 1e-7)
        assert numpy.array_equal(volume.array, data)


def test_volumes_of_an_mrc_are_frames_and_one_without_a_cell_is_noted(tmp_path):
    data = ramp("i2", (6, 4, 6))
    path = mrc(tmp_path / "a.mrc", data, 1, samples=(6, 4, 3), cell=(6, 4, 3), kind=401)
    for frame in range(2):
        assert numpy.array_equal(palpate.load(path, frame=frame).volume.array, data[3 * frame:3 * frame + 3])
    assert numpy.array_equal(noted(mrc(path, data, 1, cell=(0, 0, 0)), "size of its cell").geometry.spacing, (1, 1, 1))


def test_an_mrc_that_is_not_read_is_refused(tmp_path):
    path, data = tmp_path / "a.mrc", ramp("i2")
    for changes, words in (({"mode": 3}, "mode 3"), ({"mode": 4}, "mode 4"), ({"angles": (90, 90, 120)}, "right angles"),
                           ({"axes": (1, 1, 3)}, "MAPC"), ({"letters": bytes(4), "axes": (9, 2, 3)}, "no MRC file")):
        refused(mrc(path, data, **({"mode": 1} | changes)), words)
    mrc(path, data, 1)
    path.write_bytes(path.read_bytes()[:-10])
    refused(path, "cut off")
    (tmp_path / "a.PAR").write_text("# === DATA DESCRIPTION FILE ===")
    for samples in (bytes(4000), bytes(range(250)) * 16):
        (tmp_path / "a.REC").write_bytes(samples)
        refused(tmp_path / "a.REC", "dcm2niix")
    path.write_bytes(b"PAR and REC of another program")
    refused(path, "too short")


def test_segments_of_old_versions_of_slicer_have_a_layer_each(tmp_path):
    path = tmp_path / "a.seg.nrrd"
    keys = "".join(f"Segment{i}_ID:=S{i}\nSegment{i}_Name:={name}\n" for i, name in enumerate(("bone", "vessel")))
    header = ("NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 6 4 5\nencoding: raw\nkinds: list domain domain domain\n"
              "space: left-posterior-superior\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n")
    path.write_bytes((header + keys + "\n").encode() + bytes(240))
    assert [palpate.load(path, frame=frame).values["labels"] for frame in (0, 1)] == [{1: "bone"}, {1: "vessel"}]
