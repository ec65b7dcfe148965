"""Grids lie where their headers say, also if a program has rounded them, left out their spacings or named their axes.
The cases are reports to other readers, whose issues are named."""

import itertools
import struct
import warnings

import nibabel
import numpy
import palpate
import pytest
from formats_test import nrrd
from headers_test import meta_image, nifti
from nibabel.brikhead import AFNIHeader, AFNIImage
from nibabel.minc1 import Minc1Image
from nibabel.spatialimages import SpatialImage
from readers_test import SHAPE, noted, ramp, refused

LPS = numpy.diag([-1.0, -1.0, 1.0])
CORNERS = list(itertools.product(*((0, size - 1) for size in SHAPE[::-1])))


def turn(degrees):
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    return numpy.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ numpy.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def farthest(volume, axes, origin):
    """From where a file puts a corner: `axes` has its steps in columns (LPS)."""
    return max(numpy.linalg.norm(volume.geometry.physical(corner) - (origin + axes @ corner)) for corner in CORNERS)


# Axes that are not quite at right angles ---------------------------------------------------------------


def sform(path, axes, origin, qform=None, pixdim=None):
    """axes, origin: LPS. qform: a quaternion's last three numbers."""
    def change(header):
        rows = numpy.column_stack([LPS @ axes, LPS @ origin])
        struct.pack_into("<8f", header, 76, 1, *(numpy.linalg.norm(axes, axis=0) if pixdim is None else pixdim), 0, 0, 0, 0)
        struct.pack_into("<2h", header, 252, qform is not None, 1)
        struct.pack_into("<3f", header, 256, *(qform or (0, 0, 0)))
        struct.pack_into("<3f", header, 268, *(LPS @ origin))
        struct.pack_into("<12f", header, 280, *rows.ravel())
    return nifti(path, change)


def vectors(axes):
    return " ".join("(" + ",".join(map(repr, map(float, axis))) + ")" for axis in axes.T)


def in_nrrd(path, axes, origin):
    return nrrd(path.with_suffix(".nrrd"), ramp("i2"), "space: left-posterior-superior", f"space directions: {vectors(axes)}",
                f"space origin: {vectors(numpy.array(origin, float)[:, None])}")


def in_meta_image(path, axes, origin):
    cosines = " ".join(repr(float(number)) for number in (axes / (1, 2, 3)).T.ravel())
    return meta_image(path.with_suffix(".mha"), f"TransformMatrix = {cosines}", f"Offset = {' '.join(map(str, origin))}",
                      data=ramp("i2").tobytes())


WRITERS = {"nii": lambda path, axes, origin: sform(path.with_suffix(".nii"), axes, origin), "nrrd": in_nrrd, "mha": in_meta_image}


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("degrees", (0, 33))
def test_axes_that_are_nearly_at_right_angles_are_straightened_and_the_distance_is_said(tmp_path, kind, degrees):
    """InsightSoftwareConsortium/ITK#3994, #2674 and #3333, SimpleITK/SimpleITK#1433, wasserth/TotalSegmentator#461,
    MIC-DKFZ/nnDetection#24, rordenlab/dcm2niix#945"""
    for cosine, is_read in ((0.0005, True), (0.009, True), (0.02, False)):
        shear = numpy.eye(3)
        shear[0, 1] = cosine
        shear /= numpy.linalg.norm(shear, axis=0)
        axes, origin = turn(degrees) @ shear @ numpy.diag([1, 2, 3]), (10, 20, 30)
        path = WRITERS[kind](tmp_path / "a", axes, origin)
        if not is_read:
            refused(path, "resample")
            continue
        loaded = palpate.load(path)
        moved = farthest(loaded.volume, axes, origin)
        said = next(float(note.split(" mm from")[0].split()[-1]) for note in loaded.notes if "right angles" in note)
        assert 0 < moved < 0.06 and said == pytest.approx(moved, rel=1e-3), loaded.notes
        assert numpy.allclose(loaded.volume.geometry.spacing, numpy.linalg.norm(axes, axis=0))
        assert numpy.array_equal(palpate.open_store(path).levels[0].size, loaded.volume.geometry.size)


def test_directions_with_a_few_digits_are_straightened_and_do_not_scale_the_spacing(tmp_path):
    axes = numpy.round(turn(33), 3) @ numpy.diag([1, 2, 3])
    path = in_meta_image(tmp_path / "a", axes, (1, 2, 3))
    volume = noted(path, "right angles")
    assert farthest(volume, axes, (1, 2, 3)) < 0.02
    assert numpy.array_equal(volume.geometry.spacing, (1, 2, 3))
    assert numpy.array_equal(palpate.load(path, spacing=(1, 1, 1)).volume.geometry.spacing, (1, 1, 1))
    refused(in_meta_image(tmp_path / "b", 1.02 * axes, (1, 2, 3)), "orthonormal")


@pytest.mark.parametrize("directions", (0.998 * numpy.eye(3), [[0.71, -0.71, 0], [0.71, 0.71, 0], [0, 0, 1]]))
def test_vectors_of_axes_that_only_have_other_lengths_give_directions(tmp_path, directions):
    path = in_meta_image(tmp_path / "a", numpy.array(directions) @ numpy.diag([1, 2, 3]), (1, 2, 3))
    geometry = noted(path, "length 1: they were taken as directions only").geometry
    assert numpy.array_equal(geometry.spacing, (1, 2, 3)) and not any("right angles" in note for note in palpate.load(path).notes)
    assert numpy.allclose(geometry.direction, directions / numpy.linalg.norm(directions, axis=0), atol=1e-12)
    assert numpy.array_equal(palpate.load(path, spacing=(1, 1, 1)).volume.geometry.spacing, (1, 1, 1))


def test_the_spacing_across_a_single_slice_does_not_limit_straightening(tmp_path):
    data = numpy.arange(100, dtype="i2").reshape(1, 10, 10)
    path = nrrd(tmp_path / "a.nrrd", data, "space: left-posterior-superior", "space directions: (1,0,0) (0.004,1,0) (0,0,1e-7)", "space origin: (0,0,0)")
    assert numpy.array_equal(noted(path, "right angles").array, data)
    affine = numpy.array([[1, 0.004, 0, 0], [0, 1, 0, 0], [0, 0, 1e-7, 0], [0, 0, 0, 1]])
    with pytest.warns(UserWarning, match="right angles"):
        assert numpy.array_equal(palpate.as_volume(SpatialImage(data.T, affine)).array, data)


def test_a_long_grid_is_not_straightened_if_its_end_would_move_by_a_sample(tmp_path):
    data = numpy.arange(4000, dtype="i2").reshape(1, 1, 4000)
    for cosine, is_read in ((0.0002, True), (0.001, False)):
        path = nrrd(tmp_path / "a.nrrd", data, "space: left-posterior-superior",
                    f"space directions: (1,0,0) ({cosine},1,0) (0,0,1)", "space origin: (0,0,0)")
        if is_read:
            assert numpy.array_equal(noted(path, "right angles").array, data)
        else:
            refused(path, "orthonormal")


def test_a_nearly_straight_sform_goes_before_the_qform(tmp_path):
    shear = numpy.diag([1.0, 2, 3])
    shear[0, 1] = 0.002
    volume = noted(sform(tmp_path / "a.nii", shear, (10, 20, 30), qform=(0, 0, 0)), "the sform was taken")
    assert farthest(volume, shear, (10, 20, 30)) < 0.01


@pytest.mark.parametrize("cosine", (0, 0.0005, 0.009, 0.02))
def test_a_nibabel_image_is_straightened_as_its_file(tmp_path, cosine):
    shear = turn(20) @ numpy.diag([1.0, 2, 3])
    shear[:, 1] += 2 * cosine * turn(20)[:, 0]
    path = sform(tmp_path / "a.nii", shear, (10, 20, 30))
    image = nibabel.load(path)
    if cosine > 0.01:
        refused(path, "sheared")
        with pytest.raises(ValueError, match="orthonormal"):
            palpate.as_volume(image)
        return
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ours = palpate.as_volume(image).geometry
    assert any("right angles" in str(one.message) for one in caught) == (cosine > 0)
    theirs = palpate.load(path).volume.geometry
    for name in ("size", "spacing", "origin", "direction"):
        assert numpy.allclose(getattr(ours, name), getattr(theirs, name), atol=1e-6), name


# Transforms without spacings ----------------------------------------------------------------------------


@pytest.mark.parametrize("qform", (True, False))
def test_an_sform_of_directions_without_spacings_gives_way_to_the_qform(tmp_path, qform):
    """InsightSoftwareConsortium/ITK#3514 and Deep-MI/FastSurfer#36: VINCI writes directions where steps belong."""
    path = sform(tmp_path / "a.nii", LPS @ numpy.eye(3), (10, 20, 30), qform=(0, 0, 0) if qform else None, pixdim=(0.5, 0.5, 0.75))
    note = "axes of length 1" if qform else "two spacings"
    volume = noted(path, note)
    spacing = (0.5, 0.5, 0.75) if qform else (1, 1, 1)
    assert farthest(volume, LPS @ numpy.diag(spacing), (10, 20, 30)) < 1e-6
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ours = palpate.as_volume(nibabel.load(path))
    assert any(note in str(one.message) for one in caught) == qform
    assert numpy.allclose(ours.geometry.spacing, spacing) and numpy.allclose(ours.geometry.origin, (10, 20, 30))


def test_the_origin_of_an_analyze_header_of_spm_is_noted(tmp_path):
    nibabel.Spm99AnalyzeImage(ramp("i2").T, numpy.diag([-2, -3, 4, 1])).to_filename(tmp_path / "a.img")
    (tmp_path / "a.mat").unlink()
    header = bytearray((tmp_path / "a.hdr").read_bytes())
    struct.pack_into("<3h", header, 253, 3, 2, 3)
    (tmp_path / "a.hdr").write_bytes(header)
    assert numpy.array_equal(noted(tmp_path / "a.hdr", "an origin (of SPM)").geometry.origin, (0, 0, 0))


# Images of nibabel and arrays with names ------------------------------------------------------------------


AFFINE = numpy.array([[0, 2.0, 0, 5], [-1, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1]])


def afni(data, affine):
    header = {"DATASET_DIMENSIONS": [*data.shape[:3], 0, 0], "DATASET_RANK": [3, 1], "BRICK_TYPES": [1], "DELTA": [1, 2, 3],
              "ORIGIN": [0, 0, 0], "IJK_TO_DICOM_REAL": [1] * 12, "ORIENT_SPECIFIC": [0, 3, 4], "TYPESTRING": "3DIM_HEAD_ANAT",
              "BYTEORDER_STRING": "LSB_FIRST", "BRICK_FLOAT_FACS": None}
    return AFNIImage(data, affine, AFNIHeader(header))


@pytest.mark.parametrize("kind", (SpatialImage, nibabel.MGHImage, Minc1Image, afni, nibabel.Nifti1Image, nibabel.Nifti2Image))
def test_a_nibabel_image_of_any_format_lies_where_its_affine_says(kind):
    data = ramp("i2").T.astype("i4" if kind is nibabel.MGHImage else "i2")
    volume = palpate.as_volume(kind(data, AFFINE))
    assert numpy.array_equal(volume.array, data.T) and volume.geometry.oriented
    assert farthest(volume, LPS @ AFFINE[:3, :3], LPS @ AFFINE[:3, 3]) < 1e-6


@pytest.mark.parametrize("kind", (SpatialImage, Minc1Image))
def test_a_nibabel_image_without_an_affine_has_no_orientation(kind):
    with pytest.warns(UserWarning, match="nothing of its orientation"):
        volume = palpate.as_volume(kind(ramp("i2").T, None))
    assert not volume.geometry.oriented and numpy.array_equal(volume.array, ramp("i2"))


def test_an_mgh_file_read_by_nibabel_and_by_palpate_is_the_same(tmp_path):
    nibabel.MGHImage(ramp("i4").T, AFFINE).to_filename(tmp_path / "a.mgz")
    ours, theirs = palpate.load(tmp_path / "a.mgz").volume, palpate.as_volume(nibabel.load(tmp_path / "a.mgz"))
    assert numpy.array_equal(ours.array, theirs.array)
    assert all(numpy.allclose(ours.geometry.physical(corner), theirs.geometry.physical(corner), atol=1e-5) for corner in CORNERS)


def test_frames_of_minc_come_first():
    data = numpy.stack([ramp("i2").T, ramp("i2").T + 1])  # t, and the axes of the affine
    for frame in (0, 1):
        volume = palpate.as_volume(Minc1Image(data, AFFINE), frame=frame)
        assert numpy.array_equal(volume.array, data[frame].T)


class Named:
    """Has names of its dimensions, as xarray's arrays do."""

    def __init__(self, values, dims):
        self.values, self.dims = values, dims

    shape = property(lambda self: self.values.shape)

    def __array__(self, dtype=None, copy=None):
        return self.values if dtype is None else self.values.astype(dtype)

    def __getitem__(self, where):
        return self.values[where]


@pytest.mark.parametrize("names", [*map("".join, itertools.permutations("xyz")), "XYZ"])
def test_dimensions_with_names_may_have_any_order(names):
    """InsightSoftwareConsortium/ITK#1632, imagej/pyimagej#151"""
    array = ramp("u2").transpose(["zyx".index(name) for name in names.lower()])
    assert numpy.array_equal(palpate.as_volume(Named(array, tuple(names))).array, ramp("u2"))
    timed = numpy.stack([array, array + 1], axis=1)
    volume = palpate.as_volume(Named(timed, (names[0], "t", *names[1:])), frame=1)
    assert numpy.array_equal(volume.array, ramp("u2") + 1)


@pytest.mark.parametrize("names", (("a", "b", "c"), ("dim_0", "dim_1", "dim_2"), ("z", "z", "x"), "zyx", None, (0, 1, 2)))
def test_other_names_of_dimensions_change_nothing(names):
    assert numpy.array_equal(palpate.as_volume(Named(ramp("u2"), names)).array, ramp("u2"))


# Files of slices, and axes of time -------------------------------------------------------------------------


@pytest.mark.parametrize("name, first, step", (("p%03d.raw", 1, 1), ("p%03d.raw 7", 7, 1), ("p%03d.raw 2 10 2", 2, 2),
                                               ("a scan %d of mine.raw 0 4 1", 0, 1), ("a scan %2d.raw 3", 3, 1)))
def test_numbered_files_of_meta_image_need_no_numbers_and_may_have_blanks(tmp_path, name, first, step):
    """MetaIO counts from 1 as many files as the last axis is long. InsightSoftwareConsortium/ITK, metaImage.cxx"""
    for number, plane in enumerate(ramp("<i2")):
        words = name.split(".raw")[0] + ".raw"
        (tmp_path / (words % (first + step * number))).write_bytes(plane.tobytes())
    volume = palpate.load(meta_image(tmp_path / "a.mhd", file=name)).volume
    assert numpy.array_equal(volume.array, ramp("i2"))
    (tmp_path / (words % (first + step * 4))).unlink()
    refused(tmp_path / "a.mhd", "cannot be read")


def test_a_file_of_a_name_like_a_pattern_goes_before_numbered_ones(tmp_path):
    (tmp_path / "p%d.raw").write_bytes(ramp("<i2").tobytes())
    assert numpy.array_equal(palpate.load(meta_image(tmp_path / "a.mhd", file="p%d.raw")).volume.array, ramp("i2"))


@pytest.mark.parametrize("folder", ("", "/scans/", "C:\\scan\\", "scans/"))
def test_a_file_of_a_name_like_a_pattern_may_have_been_moved_beside_its_header(tmp_path, folder):
    (tmp_path / "50%data.raw").write_bytes(ramp("<i2").tobytes())
    path = meta_image(tmp_path / "a.mhd", file=folder + "50%data.raw")
    loaded = palpate.load(path)
    assert numpy.array_equal(loaded.volume.array, ramp("i2"))
    assert any("beside it" in note for note in loaded.notes) == (folder != "")


@pytest.mark.parametrize("fields", (("kinds: domain domain time", "spacings: 2 3 0.5"),
                                    ("kinds: space space time", "space: left-posterior-superior", "space directions: (2,0,0) (0,3,0) none"),
                                    ("kinds: space space time", "space dimension: 2", "space directions: (2,0) (0,3) none")))
def test_slices_that_follow_one_another_in_time_are_frames(tmp_path, fields):
    path = nrrd(tmp_path / "a.nrrd", ramp("i2"), *fields)
    for frame, plane in enumerate(ramp("i2")):
        volume = palpate.load(path, frame=frame).volume
        assert numpy.array_equal(volume.array, plane[None]) and numpy.array_equal(volume.geometry.spacing[:2], (2, 3))
    refused(nrrd(path, ramp("i2"), "kinds: time domain domain"), "put it last")


def test_directions_of_nrrd_without_a_space_are_refused_with_what_to_do(tmp_path):
    refused(nrrd(tmp_path / "a.nrrd", ramp("i2"), "space directions: (1,0,0) (0,1,0) (0,0,1)"), "space dimension: 3")


# VTK's older format -----------------------------------------------------------------------------------------


def numbers(data, text):
    return " ".join(map(str, data.ravel())).encode() + b"\n" if text else data.astype(data.dtype.newbyteorder(">")).tobytes() + b"\n"


def vtk_file(path, text, *arrays):
    size = "DATASET STRUCTURED_POINTS\nDIMENSIONS 6 4 5\nSPACING 1 2 3\nORIGIN 10 20 30\n"
    path.write_bytes(f"# vtk DataFile Version 5.1\nof ParaView\n{'ASCII' if text else 'BINARY'}\n{size}".encode() + b"".join(
        (head + "\n").encode() + (b"" if data is None else numbers(data, text)) for head, data in arrays))
    return path


POINTS = (("POINT_DATA 120", None), ("SCALARS density short\nLOOKUP_TABLE default", ramp("i2")))
CELLS = (("CELL_DATA 60", None), ("SCALARS other float\nLOOKUP_TABLE default", numpy.arange(60, dtype="f4")))
META = ("METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 249\n", None)
OTHERS = (("VECTORS velocity float", numpy.arange(360, dtype="f4")), ("NORMALS n double", numpy.ones(360)), ("TENSORS t float", numpy.ones(1080, "f4")),
          ("TEXTURE_COORDINATES uv 2 float", numpy.ones(240, "f4")), ("SCALARS pair short 2\nLOOKUP_TABLE default", numpy.ones(240, "i2")),
          ("FIELD FieldData 2\nvector 3 120 float", numpy.ones(360, "f4")), ("weight 2 120 double", numpy.ones(240)))


@pytest.mark.parametrize("text", (False, True))
def test_samples_of_points_are_found_behind_other_arrays_of_vtk(tmp_path, text):
    """elrnv/vtkio#3 (ParaView writes cells first), nschloe/meshio#1205"""
    rest = ("FIELD FieldData 2\nvector 3 120 float", OTHERS[0][1]), ("density 1 120 short", ramp("i2"))
    for arrays in ((*CELLS, *POINTS), (*CELLS, META, *POINTS, META), (POINTS[0], *OTHERS, META, POINTS[1]), (POINTS[0], *rest),
                   (*CELLS, POINTS[0], *OTHERS[:1], *rest)):
        path = vtk_file(tmp_path / "a.vtk", text, *arrays)
        volume = noted(path, "several arrays")
        assert numpy.array_equal(volume.array, ramp("i2")) and numpy.array_equal(volume.geometry.origin, (10, 20, 30))
        if not text:
            store = palpate.open_store(path)
            assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, ramp("i2"))


@pytest.mark.parametrize("text", (False, True))
def test_without_samples_of_points_those_of_cells_are_taken(tmp_path, text):
    vectors = ("VECTORS velocity float", numpy.ones(180, "f4"))
    for arrays in ((*CELLS, POINTS[0], *OTHERS), (CELLS[0], vectors, CELLS[1], META, POINTS[0], *OTHERS), (POINTS[0], *OTHERS, *CELLS)):
        volume = noted(vtk_file(tmp_path / "a.vtk", text, *arrays), "centres")
        assert numpy.array_equal(volume.array.ravel(), numpy.arange(60)) and numpy.array_equal(volume.geometry.origin, (10.5, 21, 31.5))
    refused(vtk_file(tmp_path / "a.vtk", text, POINTS[0], *OTHERS), "3 values a sample")
    refused(vtk_file(tmp_path / "a.vtk", text, POINTS[0]), "no samples")
    refused(vtk_file(tmp_path / "a.vtk", text, POINTS[0], ("SCALARS d short 99999\nLOOKUP_TABLE default", None)), "99999 values")


@pytest.mark.parametrize("text", (False, True))
def test_arrays_of_vtk_with_another_length_than_the_grid_are_passed_over(tmp_path, text):
    """ParaView may keep a time or a cycle among the samples."""
    fields = ("FIELD FieldData 2\nTimeValue 1 1 double", numpy.array([1.5])), ("density 1 120 short", ramp("i2"))
    assert numpy.array_equal(noted(vtk_file(tmp_path / "a.vtk", text, POINTS[0], *fields), "several arrays").array, ramp("i2"))
    refused(vtk_file(tmp_path / "a.vtk", text, POINTS[0], *fields[:1]), "1 samples, its grid is 6x4x5")


@pytest.mark.parametrize("text", (False, True))
def test_samples_of_cells_that_are_taken_as_others_cannot_be_read_are_noted(tmp_path, text):
    ids = ("SCALARS ids vtkIdType\nLOOKUP_TABLE default", numpy.arange(120, dtype="i4"))
    volume = noted(vtk_file(tmp_path / "a.vtk", text, *CELLS, POINTS[0], ids), "only samples of its cells were found")
    assert numpy.array_equal(volume.array.ravel(), numpy.arange(60))
    whole = palpate.load(vtk_file(tmp_path / "a.vtk", text, *CELLS))
    assert not any("only samples" in note for note in whole.notes)


# Meshes -----------------------------------------------------------------------------------------------------


def obj(path, text):
    path.write_bytes(text.encode())
    mesh = palpate.read_mesh(path)
    return numpy.asarray(mesh.vertices), numpy.asarray(mesh.triangles)


def area(vertices, triangles):
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2


@pytest.mark.parametrize("comment, unit", (("# File units = meters", 1000), ("# Units\n# File units = inches", 25.4), ("# File units = mm", 1),
                                           ("# vertex coordinates are measured in units, where 1 unit = 1000.000000 mm", 1000),
                                           ("# where 1 unit = 2 cm", 20), ("# 1 unit = 7 mm", 1), ("# (where 1 unit = 1000.0 mm)", 1000),
                                           ("# where 1 unit = 1000.0mm", 1000), ("# File units = meters, Y up", 1000),
                                           ("# where 1 unit = 10 (mm)", 10), ("# (File units = cm)", 10),
                                           ("# profile units = in", 1), ("# nowhere 1 unit = 2 m", 1), ("# where 1 unit = inf mm", 1),
                                           ("# where 1 unit = nan mm", 1), ("# File units = unknown", 1), ("# File units =", 1),
                                           ("# where 1 unit = -1 mm", 1), ("# where 1 unit = 2", 1), ("# meters", 1)))
def test_a_comment_of_obj_may_give_its_unit(tmp_path, comment, unit):
    """Slicer/Slicer#9360 (Mimics), vkoskiv/c-ray#112 (Onshape)"""
    vertices, _ = obj(tmp_path / "a.obj", f"{comment}\nv 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
    expected = unit * numpy.array([(0, 0, 0), (1, 0, 0), (0, 2, 0)])
    assert numpy.allclose(vertices, expected)
    behind, _ = obj(tmp_path / "a.obj", f"v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n{comment}\n")
    assert numpy.allclose(behind, expected)


@pytest.mark.parametrize("comment", ("# File units = cubits", "# where 1 unit = 3 cubits"))
def test_a_unit_of_obj_that_is_not_known_is_refused(tmp_path, comment):
    with pytest.raises(palpate.InputError, match="unit of length 'cubits'"):
        obj(tmp_path / "a.obj", f"{comment}\nv 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")


def test_each_unit_of_obj_holds_up_to_the_next_one(tmp_path):
    vertices, _ = obj(tmp_path / "a.obj", "v 1 0 0\n# File units = cm\nv 0 1 0\n# File units = m\nv 0 0 1\nf 1 2 3\n")
    assert numpy.allclose(vertices, numpy.diag([10, 10, 1000]))


@pytest.mark.parametrize("end", ("\\\n", "\\ \n", "\\\t \r\n", " \\\r\n"))
def test_a_line_of_obj_goes_on_behind_a_backslash(tmp_path, end):
    """mikedh/trimesh#1103"""
    _, triangles = obj(tmp_path / "a.obj", f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {end} 3\n")
    assert triangles.tolist() == [[0, 1, 2]]


def test_a_path_of_windows_with_a_blank_at_its_end_hides_no_face_of_obj(tmp_path):
    _, triangles = obj(tmp_path / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng C:\\parts\\ \nf 1 2 3\n")
    assert triangles.tolist() == [[0, 1, 2]]


OUTLINE = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"


def outlined(corners):
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in corners]
    return "\n".join(lines) + "\nf " + " ".join(str(i + 1) for i in range(len(corners))) + "\n"


STAR = [(numpy.cos(0.8 * numpy.pi * i), numpy.sin(0.8 * numpy.pi * i), 0) for i in range(5)]


@pytest.mark.parametrize("corners", (STAR, [(0, 0, 0), (2, 2, 0), (2, 1, 0), (2, 0, 0), (0, 2, 0)]))
def test_a_face_that_crosses_itself_is_refused_and_not_left_out(tmp_path, corners):
    """mikedh/trimesh#2519"""
    with pytest.raises(palpate.InputError, match="face of 5 corners cannot be divided"):
        obj(tmp_path / "a.obj", outlined(corners) + "f 1 2 3\n")


def turned(corners, random):
    return numpy.array(corners) @ numpy.linalg.qr(random.normal(size=(3, 3)))[0] + random.normal(size=3) * 300


def test_outlines_that_are_not_convex_keep_their_area(tmp_path):
    """VTK alone loses 13 % of these faces."""
    random = numpy.random.default_rng(0)
    faces = 0
    while faces < 200:
        count = random.integers(4, 40)
        angles, radii = numpy.sort(random.uniform(0, 2 * numpy.pi, count)), random.uniform(2, 20, count)
        if max(numpy.diff(numpy.append(angles, angles[0] + 2 * numpy.pi))) > 3:
            continue  # the middle is outside
        faces += 1
        corners = numpy.round(turned(numpy.column_stack([radii * numpy.cos(angles), radii * numpy.sin(angles), 0 * angles]), random), 4)
        whole = sum(numpy.cross(a - corners[0], b - corners[0]) for a, b in itertools.pairwise(corners[1:]))
        assert area(*obj(tmp_path / "a.obj", outlined(corners))) == pytest.approx(numpy.linalg.norm(whole) / 2, rel=1e-4)


def test_a_face_around_a_hole_keeps_the_hole(tmp_path):
    """tinyobjloader/tinyobjloader#295"""
    vertices, triangles = obj(tmp_path / "a.obj", OUTLINE + "f 1 2 3 4 1 5 6 7 8 5\n")
    assert area(vertices, triangles) == pytest.approx(12)
    middles = vertices[triangles].mean(axis=1)
    assert not numpy.any(numpy.all((middles[:, :2] > 1) & (middles[:, :2] < 3), axis=1))


def test_faces_without_area_are_no_reason_to_refuse_a_mesh(tmp_path):
    random = numpy.random.default_rng(1)
    for count in (*[4] * 20, *[5] * 20, *[9] * 20):
        line = numpy.outer(numpy.sort(random.uniform(0, 1, count)), random.normal(size=3)) + random.normal(size=3) * 50
        vertices, triangles = obj(tmp_path / "a.obj", outlined(line) + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n")
        assert area(vertices, triangles) == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("shares", (False, True))
def test_a_sphere_of_quads_has_a_triangle_for_each_of_those_at_its_poles(tmp_path, shares):
    """Two corners of a quad at a pole are at one place, with two numbers."""
    def place(i, j):
        polar, around = numpy.pi * i / 8, 2 * numpy.pi * j / 12
        return 10 * numpy.sin(polar) * numpy.cos(around), 10 * numpy.sin(polar) * numpy.sin(around), 10 * numpy.cos(polar)
    quads = [((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)) for i in range(8) for j in range(12)]
    used = list(itertools.product(range(9), range(13))) if shares else [corner for quad in quads for corner in quad]
    numbered = [[used.index(corner) for corner in quad] if shares else range(4 * q, 4 * q + 4) for q, quad in enumerate(quads)]
    text = "".join("v {:.6f} {:.6f} {:.6f}\n".format(*place(*corner)) for corner in used)
    vertices, triangles = obj(tmp_path / "a.obj", text + "".join(f"f {' '.join(str(n + 1) for n in quad)}\n" for quad in numbered))
    assert len(triangles) == 168 and area(vertices, triangles) == pytest.approx(400 * numpy.pi, rel=0.08)


@pytest.mark.parametrize("corners, triangles", (("1 1 1  1 1 1  2 1 1  2 2 1", 1), ("1 1 1  1 1 1  2 1 1  2 1 1", 0),
                                                (".1 .1 .1  .1 .1 .1  .3 .2 .1  .3 .2 .1  .7 .9 .2", 1)))
def test_neighbouring_corners_at_one_place_are_one(tmp_path, corners, triangles):
    face = outlined(numpy.array(corners.split(), float).reshape(-1, 3))
    assert len(obj(tmp_path / "a.obj", face + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n")[1]) == triangles + 1


@pytest.mark.parametrize("face, whole", (("1 2 3 4", 16), ("1 2 3 4 1", 16), ("1 2 7 4", 12), ("4 1 2 7", 12), ("1 1 2 3", 8), ("1 2 2 1", None)))
def test_faces_with_many_corners_keep_their_area(tmp_path, face, whole):
    """f3d-app/f3d#473"""
    vertices, triangles = obj(tmp_path / "a.obj", OUTLINE + f"f {face}\nf 6 7 8\n")
    assert area(vertices, triangles) - 2 == pytest.approx(whole or 0)
