"""Every route to a file's samples gives the same, and what an independent reader gives: read whole, by the box, by the
command line, converted to Zarr and to NRRD; nibabel and tifffile. Families of generated files, and real ones."""

import gzip
import itertools
import json
import os
import subprocess
from pathlib import Path

import nibabel
import numpy
import palpate
import pytest
import tifffile

NAN, INFINITE = float("nan"), float("inf")


def command(*words):
    done = subprocess.run([os.environ["PALPATE"], *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def probed(volume, points):
    """The samples nearest to physical points."""
    indices = [numpy.rint(volume.geometry.index(point)).astype(int) for point in points]
    return [float(volume.array[k, j, i]) for i, j, k in indices]


def expect_same(volume, whole):
    place, expected = volume.geometry, whole.geometry
    assert list(place.size) == list(expected.size)
    for name in ("spacing", "origin", "direction"):
        assert numpy.allclose(getattr(place, name), getattr(expected, name), rtol=1e-6, atol=1e-9), name
    assert volume.type == whole.type
    assert (volume.minimum, volume.maximum) == (whole.minimum, whole.maximum)
    random = numpy.random.default_rng(1)
    points = [expected.physical(random.integers(0, expected.size)) for _ in range(10)]
    assert probed(volume, points) == probed(whole, points)
    assert numpy.array_equal(volume.array, whole.array)


def by_the_box(path, time=0):
    """The volume, by an open store; None for a file that is read as a whole only."""
    try:
        store = palpate.open_store(str(path), time=time)
    except palpate.InputError as error:
        assert "piece by piece" in str(error) or "strips" in str(error), error
        return None
    return store.read((0, 0, 0), store.levels[0].size)


def expect_info(words, whole):
    told = json.loads(command("info", "--json", *words))
    assert told["size"] == list(whole.geometry.size) and told["type"] == whole.type
    assert numpy.allclose(told["spacing_mm"], whole.geometry.spacing, rtol=1e-6)
    assert numpy.allclose(told["origin_mm"], whole.geometry.origin, rtol=1e-6, atol=1e-9)
    assert numpy.allclose(told["direction"], numpy.asarray(whole.geometry.direction).T, atol=1e-9)
    assert told["minimum"] == whole.minimum and told["maximum"] == whole.maximum


def expect_every_route(path, folder):
    """Those in other processes as well."""
    whole = palpate.load(path).volume
    boxes = by_the_box(path)
    expect_info([path], whole)
    if boxes is not None:
        expect_same(boxes, whole)
        expect_info([path, "--level", "0"], whole)
    for name in ("converted.zarr", "converted.nrrd"):
        out = folder / name
        command("convert", path, out, "--quiet")
        if name.endswith(".zarr"):  # it keeps no directions
            store = palpate.open_store(str(out))
            assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, whole.array)
            assert numpy.allclose(store.levels[0].spacing, whole.geometry.spacing, rtol=1e-6)
        else:
            expect_same(palpate.load(out).volume, whole)


# NIfTI, compared with nibabel ---------------------------------------------------------------------

SHAPE = (5, 4, 3)  # x, y, z
UNITS = {0: 1.0, 1: 1000.0, 2: 1.0, 3: 1e-3}


def turned(degrees, spacing, origin):
    """An affine of axes at right angles."""
    angle = numpy.radians(degrees)
    turn = numpy.array([[numpy.cos(angle), -numpy.sin(angle), 0], [numpy.sin(angle), numpy.cos(angle), 0], [0, 0, 1]])
    affine = numpy.eye(4)
    affine[:3, :3] = turn @ numpy.diag(spacing)
    affine[:3, 3] = origin
    return affine


AFFINE = turned(30, (2, 3, 4), (10, -20, 30))
FORMS = {"none": (None, None), "qform": (AFFINE, None), "sform": (None, AFFINE), "both": (AFFINE, AFFINE),
         "moved": (AFFINE, turned(30, (2, 3, 4), (10, -20, 35))), "turned": (AFFINE, turned(75, (2, 3, 4), (0, 0, 0))),
         "mirrored": (None, AFFINE @ numpy.diag([1, 1, -1, 1]))}


def samples(dtype, shape=SHAPE, seed=1):
    made = numpy.random.default_rng(seed).integers(0, 120, shape)
    return (made - 60 if numpy.dtype(dtype).kind in "if" else made).astype(dtype)


def write_nifti(path, array, unit=2, forms=(AFFINE, None), slope=NAN, intercept=NAN, big=False):
    """nibabel's header, filled by hand, so that nothing is tidied up; the samples after it."""
    header = nibabel.Nifti1Header(endianness=">" if big else "<")
    header.set_data_dtype(array.dtype)
    header.set_data_shape(array.shape)
    header["pixdim"][1:4] = (2, 3, 4)
    header["xyzt_units"] = unit | 8
    qform, sform = forms
    header.set_qform(qform, 1 if qform is not None else 0)
    header.set_sform(sform, 2 if sform is not None else 0)
    header["scl_slope"], header["scl_inter"] = slope, intercept
    header["vox_offset"] = 352
    header["magic"] = b"n+1"
    data = array.astype(array.dtype.newbyteorder(">" if big else "<")).tobytes(order="F")
    packed = gzip.compress if str(path).endswith(".gz") else bytes
    path.write_bytes(packed(header.binaryblock + b"\0" * 4 + data))
    return path


@pytest.mark.filterwarnings("ignore:the image's header says nothing")
@pytest.mark.parametrize("form", ("none", "qform"))
@pytest.mark.parametrize("unit", (2, 3))
def test_nifti_spacings_of_0_and_below_are_nibabels(tmp_path, unit, form):
    path = write_nifti(tmp_path / "a.nii", samples("i2"), unit, FORMS[form])
    data = path.read_bytes()
    path.write_bytes(data[:80] + numpy.array([2, 0, -3], "<f4").tobytes() + data[92:])
    expect_same(palpate.as_volume(nibabel.load(path)), palpate.load(path).volume)


def expect_nibabels(path, unit, frame=None):
    """The value and the place of every sample."""
    whole = palpate.load(path, frame=frame).volume
    image = nibabel.load(path)
    values = image.get_fdata()
    values = (values if frame is None else values[..., frame]).astype("float32")
    finite = numpy.isfinite(values)
    values = numpy.where(finite, values, values[finite].min())
    assert numpy.allclose(whole.array.T, values, rtol=1e-6)
    corners = list(itertools.product((0, 4), (0, 3), (0, 2)))
    if image.header["qform_code"] > 0 or image.header["sform_code"] > 0:
        for index in corners:
            ras = UNITS[unit] * (image.affine @ (*index, 1))[:3]
            assert numpy.allclose(whole.geometry.physical(index), ras * (-1, -1, 1), rtol=1e-5, atol=1e-4 * UNITS[unit])
    boxes = by_the_box(path, time=frame or 0)
    if boxes is not None:
        expect_same(boxes, whole)
    expect_image(image, whole, frame)


@pytest.mark.filterwarnings("ignore:the image:UserWarning", "ignore:.*finite:UserWarning")
def expect_image(image, whole, frame):
    """as_volume() of nibabel's image is the file."""
    ours = palpate.as_volume(image, frame=frame)
    assert numpy.allclose(ours.geometry.spacing, whole.geometry.spacing, rtol=1e-5)
    assert numpy.allclose(ours.geometry.origin, whole.geometry.origin, rtol=1e-5, atol=1e-6)
    assert numpy.allclose(ours.geometry.direction, whole.geometry.direction, atol=1e-5)
    assert numpy.allclose(ours.array, whole.array, rtol=1e-6)


quiet = pytest.mark.filterwarnings("ignore::UserWarning", "ignore::RuntimeWarning")


@quiet
@pytest.mark.parametrize("forms", FORMS)
@pytest.mark.parametrize("unit", UNITS)
def test_nifti_in_every_unit_and_with_every_pair_of_transforms(tmp_path, unit, forms):
    expect_nibabels(write_nifti(tmp_path / "a.nii", samples("int16"), unit, FORMS[forms]), unit)


@quiet
@pytest.mark.parametrize("intercept", (0, 7, -1024, NAN))
@pytest.mark.parametrize("slope", (0, NAN, INFINITE, 1, 2, -0.5, 1e-3))
def test_nifti_with_every_slope_and_intercept(tmp_path, slope, intercept):
    if numpy.isfinite(slope) and slope != 0 and numpy.isnan(intercept):
        path = write_nifti(tmp_path / "a.nii", samples("int16"), slope=slope, intercept=intercept)
        with pytest.raises(palpate.InputError, match="intercept"):
            palpate.load(path)
        return
    for dtype in ("uint8", "int16", "float32"):
        expect_nibabels(write_nifti(tmp_path / "a.nii", samples(dtype), slope=slope, intercept=intercept), 2)


@quiet
@pytest.mark.parametrize("dtype", ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"))
def test_nifti_of_every_type_and_byte_order_packed_or_not_and_with_frames(tmp_path, dtype):
    for big, name in itertools.product((False, True), ("a.nii", "a.nii.gz")):
        expect_nibabels(write_nifti(tmp_path / name, samples(dtype), big=big), 2)
        path = write_nifti(tmp_path / name, samples(dtype, (*SHAPE, 3)), big=big)
        for frame in range(3):
            expect_nibabels(path, 2, frame)


@quiet
def test_nifti_with_samples_that_are_not_finite(tmp_path):
    array = samples("float32") + 100
    array[0, 0, 0], array[1, 1, 1], array[2, 2, 2] = NAN, INFINITE, -INFINITE
    path = write_nifti(tmp_path / "a.nii", array)
    expect_nibabels(path, 2)
    expect_every_route(path, tmp_path)
    assert any("3 samples were not finite" in note for note in palpate.load(path).notes)


def test_a_sheared_image_takes_its_qform_as_its_file_does(tmp_path):
    sheared = AFFINE.copy()
    sheared[0, 1] += 0.3
    path = write_nifti(tmp_path / "a.nii", samples("int16"), forms=(AFFINE, sheared))
    whole = palpate.load(path)
    assert any("sheared" in note for note in whole.notes)
    with pytest.warns(UserWarning, match="sheared"):
        ours = palpate.as_volume(nibabel.load(path))
    assert numpy.allclose(ours.geometry.direction, whole.volume.geometry.direction, atol=1e-5)


# TIFF, compared with tifffile ---------------------------------------------------------------------

LENGTHS = {"PhysicalSizeX": 0.1, "PhysicalSizeY": 0.2, "PhysicalSizeZ": 0.3}


@pytest.mark.parametrize("tiled", (False, True))
@pytest.mark.parametrize("order", list(map("".join, itertools.permutations("TCZ"))))
def test_an_ome_tiff_in_every_order_in_strips_and_tiles(tmp_path, order, tiled):
    sizes = {"T": 2, "C": 2, "Z": 3}
    array = samples("uint16", (*(sizes[axis] for axis in order), 32, 48))
    path = tmp_path / "a.ome.tif"
    tifffile.imwrite(path, array, ome=True, tile=(16, 16) if tiled else None, photometric="minisblack",
                     metadata={"axes": order + "YX", **LENGTHS})
    expected = numpy.moveaxis(array, [order.index(axis) for axis in "TCZ"], (0, 1, 2))
    series = tifffile.TiffFile(path).series[0]
    assert numpy.array_equal(series.asarray(), array) and series.axes == order + "YX"
    for time in range(2):
        whole = palpate.load(path, frame=time)
        assert numpy.array_equal(whole.volume.array, expected[time, 0])
        assert numpy.allclose(whole.volume.geometry.spacing, (1e-4, 2e-4, 3e-4))
        assert whole.time_steps == 2 and any("channel 0" in note for note in whole.notes)
        boxes = by_the_box(path, time)
        assert (boxes is not None) == tiled
        if tiled:
            expect_same(boxes, whole.volume)


@pytest.mark.parametrize("dtype", ("uint8", "uint16", "float32"))
def test_a_stack_of_image_j(tmp_path, dtype):
    array = samples(dtype, (5, 7, 8))
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, array, imagej=True, resolution=(2, 4), metadata={"axes": "ZYX", "spacing": 3, "unit": "um"})
    whole = palpate.load(path).volume
    assert numpy.array_equal(whole.array, tifffile.imread(path)) and whole.type == dtype
    assert numpy.allclose(whole.geometry.spacing, (5e-4, 2.5e-4, 3e-3))


# Every route, by one file of each kind --------------------------------------------------------------

NRRD = "NRRD0004\ntype: {kind}\ndimension: 3\nsizes: 3 4 5\nendian: {order}\nencoding: {encoding}\n{place}\n"
NRRD_PLACES = ("spacings: 2 2 3\naxis mins: 0 0 10\ncenterings: node node node\nunits: \"um\" \"um\" \"mm\"\n",
               "space: RAS\nspace directions: (0,2,0) (3,0,0) (0,0,-4)\nspace origin: (5,6,7)\n"
               "space units: \"mm\" \"um\" \"cm\"\n".replace('"um"', '"mm"').replace('"cm"', '"mm"'),
               "axis mins: 0 0 10\naxis maxs: 8 10 28\ncenters: cell cell cell\n")


def nrrd(path, dtype="<i2", place=NRRD_PLACES[0], encoding="raw"):
    array = samples(dtype, (5, 4, 3))
    kind = {"i2": "int16", "u1": "uint8", "f4": "float", "i4": "int32"}[dtype[1:]]
    head = NRRD.format(kind=kind, order="big" if dtype[0] == ">" else "little", encoding=encoding, place=place)
    data = array.tobytes()
    path.write_bytes(head.encode() + (gzip.compress(data) if encoding == "gzip" else data))
    assert numpy.array_equal(palpate.load(path).volume.array, array)
    return path


def meta(path, unit="mm"):
    array = samples("<i2", (5, 4, 3))
    path.write_bytes((f"NDims = 3\nDimSize = 3 4 5\nElementType = MET_SHORT\nElementSpacing = 1 2 3\nOffset = 4 5 6\n"
                      f"TransformMatrix = 0 1 0 -1 0 0 0 0 1\nDistanceUnits = {unit}\nElementDataFile = LOCAL\n"
                      ).encode() + array.tobytes())
    return path


def tiff(path, **how):
    tifffile.imwrite(path, samples("uint16", (5, 32, 48)), photometric="minisblack", **how)
    return path


def written(path):
    palpate.write(palpate.Volume(samples("int16", (5, 4, 3)), spacing=(1, 2, 3), origin=(4, 5, 6)), path)
    return path


KINDS = {
    "nii": lambda f: write_nifti(f / "a.nii", samples("int16"), unit=3),
    "nii scaled": lambda f: write_nifti(f / "a.nii", samples("int16"), 1, FORMS["sform"], 0.5, -10, big=True),
    "nii.gz": lambda f: write_nifti(f / "a.nii.gz", samples("float32"), forms=FORMS["moved"]),
    "nii unpacked": lambda f: write_nifti(f / "a.nii", samples("uint8")).rename(f / "b.nii.gz"),
    "nii packed": lambda f: write_nifti(f / "a.nii.gz", samples("uint8")).rename(f / "b.nii"),
    "nrrd node": lambda f: nrrd(f / "a.nrrd"), "nrrd space": lambda f: nrrd(f / "a.nrrd", ">f4", NRRD_PLACES[1]),
    "nrrd ends": lambda f: nrrd(f / "a.nrrd", "<i4", NRRD_PLACES[2]),
    "nrrd gzip": lambda f: nrrd(f / "a.nrrd", "|u1", NRRD_PLACES[1], "gzip"),
    "mha": lambda f: meta(f / "a.mha"), "mha um": lambda f: meta(f / "a.mha", "um"),
    "tif": lambda f: tiff(f / "a.tif"), "tif tiled": lambda f: tiff(f / "a.tif", tile=(16, 16)),
    "tif ome": lambda f: tiff(f / "a.ome.tif", ome=True, tile=(16, 16), metadata={"axes": "ZYX", **LENGTHS}),
    "vti": lambda f: written(f / "a.vti")}


@quiet
@pytest.mark.parametrize("kind", KINDS)
def test_every_route_to_a_kind_of_file_gives_the_same(tmp_path, kind):
    made = tmp_path / "made"
    made.mkdir()
    path = KINDS[kind](made)
    expect_every_route(path, tmp_path)


def small_real_files():
    folder = Path(os.environ.get("PALPATE_DATA", Path(os.environ["PALPATE_SOURCE"]).parent / "shared" / "data"))
    return [path for path in sorted(folder.glob("*")) if path.stat().st_size < 3e5
            and path.name.endswith((".nrrd", ".mhd", ".nii", ".nii.gz"))]


@quiet
@pytest.mark.parametrize("path", small_real_files() or [None])
def test_every_route_to_a_real_file_gives_the_same(tmp_path, path):
    expect_every_route(path or palpate.sample_volume(), tmp_path)


# Arrays -----------------------------------------------------------------------------------------------


def test_masked_elements_are_refused_and_an_empty_mask_is_not():
    array = numpy.ma.masked_less(samples("int16", (5, 4, 3)), 0)
    for make in (palpate.Volume, palpate.as_volume):
        with pytest.raises(ValueError, match="masked"):
            make(array)
        with pytest.raises(ValueError, match="masked"):
            make(array.astype("float32"))
        filled = array.filled(0)
        assert numpy.array_equal(make(numpy.ma.array(filled, mask=False)).array, filled)
        assert numpy.array_equal(make(numpy.ma.array(filled)).array, filled)


def test_samples_that_are_not_finite_become_the_least_one_with_a_warning():
    array = samples("float32", (5, 4, 3))
    array[0, 0, 0], array[1, 1, 1] = NAN, INFINITE
    with pytest.warns(UserWarning, match="2 samples were not finite"):
        volume = palpate.as_volume(array)
    assert volume.array[0, 0, 0] == volume.array[1, 1, 1] == volume.minimum == numpy.nanmin(array)
    with pytest.raises(ValueError, match="finite"):
        palpate.Volume(array)


def test_a_field_has_no_value_where_a_coordinate_is_not_a_number():
    field = palpate.Field(palpate.Volume(samples("int16", (5, 4, 3))))
    points = numpy.array([[1, 1, 1], [NAN, 1, 1], [1, 1, NAN], [1e6, 0, 0]])
    assert numpy.isnan(field.value(points)).tolist() == [False, True, True, False]
    assert numpy.isnan(field.gradient(points)).any(axis=1).tolist() == [False, True, True, False]
    assert field.value(points)[3] == field.background
