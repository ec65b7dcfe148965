"""Volumes and fields of the Python module: shared memory, other kinds of arrays, files, bad input."""

import copy
import pickle
import warnings

import nibabel
import numpy
import pytest
import zarr

import palpate

TYPES = ("uint8", "int16", "uint16", "float32")


def samples(dtype, seed=1):
    return numpy.random.default_rng(seed).integers(0, 200, (5, 6, 7)).astype(dtype)


def address(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("dtype", TYPES)
def test_an_array_is_taken_over_and_given_back_without_a_copy(dtype):
    array = samples(dtype)
    volume = palpate.Volume(array, spacing=(1, 2, 3))
    assert address(volume.array) == address(array)
    assert address(numpy.asarray(volume)) == address(array)
    assert volume.array.shape == (5, 6, 7) and volume.type == dtype
    assert list(volume.geometry.size) == [7, 6, 5]
    assert volume.minimum == array.min() and volume.maximum == array.max()
    assert not volume.array.flags.writeable


def test_a_volume_of_an_array_says_what_of_its_place_is_assumed():
    array = samples("uint8")
    for given, known in (({}, (False, False)), ({"spacing": (1, 1, 1)}, (False, True)),
                         ({"direction": numpy.eye(3)}, (True, False)),
                         ({"spacing": (1, 2, 3), "direction": numpy.eye(3)}, (True, True))):
        for volume in (palpate.Volume(array, **given), palpate.as_volume(array, **given)):
            place = volume.geometry
            assert (place.oriented, place.measured) == known
            again = pickle.loads(pickle.dumps(volume)).geometry
            assert (again.oriented, again.measured) == known
    placed = palpate.as_volume(nibabel.Nifti1Image(array.T, numpy.diag([2, 2, 2, 1])))
    assert placed.geometry.oriented and placed.geometry.measured
    image = nibabel.Nifti1Image(array.T, None)
    with pytest.warns(UserWarning, match="says nothing of its orientation"):
        assert not palpate.as_volume(image).geometry.oriented


def test_a_copy_is_one_and_is_made_unasked_only_where_samples_cannot_be_shared():
    array = samples("uint8")
    for given, shared in (({}, True), ({"copy": True}, False), ({"copy": None}, True)):
        assert (address(palpate.Volume(array, **given).array) == address(array)) == shared
    strided = array[:, ::2]
    assert numpy.array_equal(palpate.Volume(strided, copy=None).array, strided)
    assert address(palpate.as_volume(array).array) == address(array)


def test_what_is_given_goes_before_what_a_volume_says():
    volume = palpate.Volume(samples("uint8"), origin=(1, 2, 3))
    assert palpate.as_volume(volume) is volume
    moved = palpate.as_volume(volume, origin=(4, 5, 6))
    assert list(moved.geometry.origin) == [4, 5, 6] and not moved.geometry.measured
    wider = palpate.as_volume(volume, spacing=(1, 2, 3), direction=numpy.diag([-1, -1, 1]))
    assert list(wider.geometry.spacing) == [1, 2, 3] and list(wider.geometry.origin) == [1, 2, 3]
    assert wider.geometry.measured and wider.geometry.oriented
    assert address(wider.array) == address(volume.array) and (wider.minimum, wider.maximum) == (
        volume.minimum, volume.maximum)
    with pytest.raises(ValueError, match="no frames"):
        palpate.as_volume(volume, frame=0)


@pytest.mark.parametrize("as_given", [numpy.asarray, numpy.ndarray.tolist])
def test_a_frame_is_chosen_by_its_number(as_given):
    array = numpy.stack([samples("uint8", seed) for seed in (1, 2)])
    data = as_given(array)
    assert numpy.array_equal(palpate.as_volume(data, frame=1).array, array[1])
    for frame in (-1, 2):
        with pytest.raises(ValueError, match="there are 2, from 0"):
            palpate.as_volume(data, frame=frame)
    with pytest.raises(TypeError):
        palpate.as_volume(data, frame=0.5)


def test_samples_live_as_long_as_somebody_holds_them():
    array = samples("float32")
    expected = array.copy()
    view = palpate.Volume(array).array
    del array
    assert numpy.array_equal(view, expected)


@pytest.mark.parametrize("other", [
    lambda a: a.T, lambda a: a[:, ::2], lambda a: numpy.asfortranarray(a)])
def test_other_strides_are_refused_by_name_or_copied_when_asked(other):
    array = other(samples("int16"))
    with pytest.raises(ValueError, match="not C-contiguous.*copy=True"):
        palpate.Volume(array)
    assert numpy.array_equal(palpate.Volume(array, copy=True).array, array)


@pytest.mark.parametrize("copy", (True, None))
@pytest.mark.parametrize("dtype", ("int16", "uint16", "float32"))
def test_samples_of_the_other_byte_order_are_copied_when_asked(dtype, copy):
    array = samples(dtype)
    volume = palpate.Volume(array.astype(array.dtype.newbyteorder()), copy=copy)
    assert numpy.array_equal(volume.array, array) and volume.type == dtype


@pytest.mark.parametrize("array, words", [
    (numpy.zeros((3, 3)), "three axes"),
    (numpy.zeros((3, 3, 3)), "float64.*as_volume"),
    (numpy.zeros((3, 3, 3), ">i2"), "byte order"),
    (numpy.full((3, 3, 3), numpy.nan, "float32"), "finite"),
    (numpy.zeros((0, 3, 3), "uint8"), "size")])
def test_arrays_that_are_no_volume_are_a_value_error_that_says_why(array, words):
    with pytest.raises(ValueError, match=words):
        palpate.Volume(array)


def test_a_nibabel_image_keeps_its_place_and_its_samples():
    array = samples("int16").T  # nibabel: x, y, z
    affine = numpy.array([[-2.0, 0, 0, 10], [0, -3, 0, 20], [0, 0, 4, 30], [0, 0, 0, 1]])
    volume = palpate.as_volume(nibabel.Nifti1Image(array, affine))
    assert numpy.array_equal(volume.array, array.T)
    assert address(volume.array) == address(array)
    place = volume.geometry
    for index in ((0, 0, 0), (1, 2, 3)):
        ras = affine @ (*index, 1)
        assert numpy.allclose(place.physical(index), ras[:3] * (-1, -1, 1))


@pytest.mark.parametrize("ones", (1, 2, 3))
def test_axes_of_length_one_need_no_frame(ones, tmp_path):
    array = samples("int16")
    image = nibabel.Nifti1Image(array.T.reshape(*array.T.shape, *(1,) * ones), numpy.diag([-2, -3, 4, 1]))
    nibabel.save(image, tmp_path / "a.nii")
    whole = palpate.load(tmp_path / "a.nii").volume
    for data in (image, nibabel.load(tmp_path / "a.nii")):
        for frame in (None, 0):
            assert numpy.array_equal(palpate.as_volume(data, frame=frame).array, whole.array)
    assert numpy.array_equal(palpate.as_volume(array.reshape(*(1,) * ones, *array.shape)).array, array)
    with pytest.raises(ValueError, match="axes"):
        palpate.as_volume(numpy.stack([array, array])[None, :])


@pytest.mark.parametrize("kind", (nibabel.AnalyzeImage, nibabel.Spm99AnalyzeImage, nibabel.Spm2AnalyzeImage))
def test_analyze_is_oriented_only_by_a_file_mat(kind, tmp_path):
    array, affine = samples("int16"), numpy.diag([-2.0, -3.0, 4.0, 1.0])
    affine[:3, 3] = (5, 6, 7)
    has_mat = kind is not nibabel.AnalyzeImage
    kind(array.T, affine).to_filename(tmp_path / "a.img")
    for image in (kind(array.T, affine), kind.from_filename(tmp_path / "a.img")):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            volume = palpate.as_volume(image)
        assert numpy.array_equal(volume.array, array) and numpy.allclose(volume.geometry.spacing, (2, 3, 4))
        assert volume.geometry.oriented == has_mat
        assert any("nothing of its orientation" in str(one.message) for one in caught) != has_mat
        if has_mat:
            assert numpy.allclose(volume.geometry.origin, (-5, -6, 7))
        else:
            assert numpy.array_equal(volume.geometry.direction, numpy.eye(3))


def test_a_nifti_file_read_by_nibabel_and_by_palpate_is_the_same(tmp_path):
    affine = numpy.diag([1.5, 2.5, 3.5, 1])
    affine[:3, 3] = (-5, 6, 7)
    path = tmp_path / "small.nii.gz"
    nibabel.save(nibabel.Nifti1Image(samples("int16").T, affine), path)
    ours, theirs = palpate.load(path).volume, palpate.as_volume(nibabel.load(path))
    assert numpy.array_equal(ours.array, theirs.array) and ours.type == theirs.type
    for index in ((0, 0, 0), (3, 2, 1)):
        assert numpy.allclose(ours.geometry.physical(index), theirs.geometry.physical(index))


def test_zarr_arrays_and_other_types_are_converted():
    array = samples("uint16")
    volume = palpate.as_volume(zarr.array(array, chunks=(2, 3, 4)), spacing=(1, 1, 2))
    assert numpy.array_equal(volume.array, array) and volume.type == "uint16"
    assert palpate.as_volume(array.astype("float64")).type == "float32"
    assert palpate.as_volume(array.astype(">u2")).type == "uint16"
    assert palpate.as_volume(array > 100).type == "uint8"
    frames = numpy.stack([array, array + 1])
    assert numpy.array_equal(palpate.as_volume(frames, frame=1).array, array + 1)
    with pytest.raises(ValueError, match="choose a frame"):
        palpate.as_volume(frames)


@pytest.mark.parametrize("extension", sorted({".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz",
                                              ".vti", ".tif", ".raw"}
                                             & set(palpate.written_extensions())))
def test_every_written_format_reads_back_the_same_samples(tmp_path, extension):
    volume = palpate.Volume(samples("uint8"), spacing=(1, 2, 3))
    path = tmp_path / f"volume{extension}"
    palpate.write(volume, path)
    raw = None
    if extension == ".raw":
        raw = palpate.RawLayout(size=(7, 6, 5), type="uint8", spacing=(1, 2, 3))
    again = palpate.load(path, raw=raw).volume
    assert numpy.array_equal(again.array, volume.array)
    assert numpy.allclose(again.geometry.spacing, (1, 2, 3))


def test_what_cannot_be_read_or_written_raises_errors_by_kind(tmp_path):
    with pytest.raises(palpate.InputError, match="does not exist") as caught:
        palpate.load(tmp_path / "nothing.nrrd")
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, palpate.Error)
    (tmp_path / "text.nrrd").write_text("no volume")
    with pytest.raises(palpate.InputError, match="text.nrrd"):
        palpate.load(tmp_path / "text.nrrd")
    with pytest.raises(palpate.OutputError) as caught:
        palpate.write(palpate.Volume(samples("uint8")), tmp_path / "no" / "folder.nrrd")
    assert isinstance(caught.value, OSError)
    assert list(tmp_path.iterdir()) == [tmp_path / "text.nrrd"]
    with pytest.raises(ValueError, match="cylinder"):
        palpate.load("synthetic:nothing")


@pytest.mark.parametrize("work", [palpate.dequantized, palpate.smoothed, palpate.sharpened])
def test_what_progress_raises_ends_the_work(work):
    class Enough(Exception):
        pass

    def progress(_):
        raise Enough

    with pytest.raises(Enough):
        work(palpate.scene("torus:48x48x48", "uint8").volume, progress=progress)


def test_a_pickled_volume_is_the_same():
    volume = palpate.Volume(samples("float32"), spacing=(1, 2, 3), origin=(4, 5, 6))
    again = pickle.loads(pickle.dumps(volume))
    assert numpy.array_equal(again.array, volume.array) and again.geometry == volume.geometry


def test_a_field_is_its_samples_at_samples_and_its_gradient_that_of_its_values():
    scene = palpate.scene("torus:24x24x24", "float32")
    points = numpy.random.default_rng(2).uniform(-8, 8, (50, 3))
    linear = palpate.Field(scene.volume, interpolation="linear")
    at = numpy.array([scene.volume.geometry.physical((3, 4, 5))])
    assert linear.value(at)[0] == pytest.approx(scene.volume.array[5, 4, 3], abs=1e-12)
    field = palpate.Field(scene.volume)
    step = 1e-5
    for axis in range(3):
        aside = numpy.zeros(3)
        aside[axis] = step
        slope = (field.value(points + aside) - field.value(points - aside)) / (2 * step)
        assert numpy.allclose(slope, field.gradient(points)[:, axis], atol=1e-6)
    hit = field.cast_ray(scene.isovalue, (-20, 0, 0), (20, 0, 0))
    assert hit and field.value(hit[0][None])[0] == pytest.approx(scene.isovalue, abs=1e-9)
    assert field.cast_ray(scene.isovalue, (0, 0, 50), (1, 0, 50)) is None


def test_a_surface_is_closed_and_its_vertices_lie_on_the_level(tmp_path):
    scene = palpate.scene("sphere:24x24x24", "float32")
    field = palpate.Field(scene.volume)
    mesh = palpate.extract(field, scene.isovalue)
    edges = numpy.concatenate([mesh.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    forward = set(map(tuple, edges))
    assert len(forward) == len(edges) and all((b, a) in forward for a, b in forward)
    # Only vertices that surface_margin moved are off the level.
    on_level = numpy.abs(field.value(mesh.vertices) - scene.isovalue) < 1e-9
    assert on_level.mean() > 0.9
    assert mesh.enclosed_volume > 0
    mesh.write(tmp_path / "sphere.ply")
    assert len(palpate.read_mesh(tmp_path / "sphere.ply").triangles) == len(mesh.triangles)
    with pytest.raises(ValueError, match="vertex that there is not"):
        palpate.Mesh(numpy.zeros((2, 3)), [[0, 1, 2]])


def same(one, other):
    """The public, plain members of two objects."""
    names = [name for name, value in vars(type(one)).items() if isinstance(value, property)]
    assert names
    for name in names:
        a, b = getattr(one, name), getattr(other, name)
        assert a.array.tobytes() == b.array.tobytes() if isinstance(a, palpate.Volume) else (
            numpy.array_equal(a, b) if isinstance(a, numpy.ndarray) else a == b), name


def test_fields_meshes_samples_and_loaded_volumes_can_be_pickled_and_copied(tmp_path):
    scene = palpate.scene("torus:16x16x16")
    path = tmp_path / "torus.nrrd"
    palpate.write(scene.volume, path)
    field = palpate.Field(scene.volume, solid="below", background=300, interpolation="linear")
    editor = palpate.Editor(scene.volume)
    editor.apply(palpate.Fill((2, 2, 2), (5, 5, 5), 250))
    pushed = palpate.Samples([(0.0, scene.volume), (0.5, scene.volume)], period=1)
    for one in (field, palpate.Field(pushed), pushed,
                palpate.extract(palpate.Field(scene.volume), 90, normals=True), palpate.load(path),
                palpate.load("synthetic:torus:16x16x16"), palpate.load("synthetic:beating:8x8x8"),
                palpate.LoadedVolume(scene.volume, "mine", 40)):
        again = pickle.loads(pickle.dumps(one))
        assert type(again) is type(one)
        same(one, again)
        same(one, copy.copy(one))
        same(one, copy.deepcopy(one))
    points = numpy.random.default_rng(1).uniform(-9, 9, (500, 3))
    assert numpy.array_equal(palpate.Field(editor.samples).value(points),
                             pickle.loads(pickle.dumps(palpate.Field(editor.samples))).value(points))


def test_a_sweep_carves_with_the_shape_of_a_tool_and_turns_it():
    volume = palpate.Volume(numpy.full((24, 24, 24), 200, "uint8"), spacing=(1, 1, 1))
    brush = palpate.Brush(kind="carve", radius=1.5, level=100, value=0)
    body = palpate.body_for(brush, volume.geometry, palpate.Tool.named("rod:10", 0.5))
    half = numpy.sqrt(0.5)

    def carved(*poses):
        editor = palpate.Editor(volume)
        editor.apply(palpate.Sweep(brush, body, *poses))
        return editor.samples.volume().array < 100

    upright = carved((6, 12, 6), (16, 12, 6))  # the rod is along z
    assert upright[8:15, 12, 6:17].all() and not upright[:, 17].any()
    lying = carved((6, 12, 6), (16, 12, 6), (-half, 0, 0, half), (-half, 0, 0, half))  # along y
    assert lying[6, 14:20, 6:17].all() and not lying[10].any()
    with pytest.raises(ValueError, match="make it with body_for"):
        palpate.Editor(volume).apply(palpate.Sweep(palpate.Brush(radius=9, level=100), body, (0, 0, 0), (1, 1, 1)))


def test_default_settings_are_equal():
    for kind in vars(palpate).values():
        if isinstance(kind, type) and hasattr(kind, "_fields"):
            assert kind() == kind() and not kind() != kind(), kind


def test_an_orientation_has_its_order_in_its_name_and_is_the_same_everywhere():
    half = numpy.sqrt(0.5)
    reading = palpate.DeviceReading(orientation_xyzw=[half, 0, 0, half])
    assert numpy.allclose(reading.orientation_xyzw, [half, 0, 0, half])
    with pytest.raises(ValueError, match="length 1"):
        reading.orientation_xyzw = [2, 0, 0, 0]
    scene = palpate.scene("sphere:16x16x16")
    field = palpate.Field(scene.volume)
    turn = [0.5, -0.5, 0.5, 0.5]
    renderer = palpate.Renderer(field, scene.isovalue, palpate.RenderSetup(tool="rod:3"))
    tick = renderer.render(0.001, [20, 0, 0], orientation_xyzw=turn)
    assert numpy.allclose(tick.hand_orientation_xyzw, turn)
    trace = palpate.replay(field, scene.isovalue, [0.0, 0.001], [[20, 0, 0], [19, 0, 0]],
                           orientation_xyzw=[turn, turn], tool="rod:3")
    assert numpy.allclose(trace.hand_orientation_xyzw, [turn, turn])


def test_labels_lie_beside_a_volume_whose_orientation_is_given(tmp_path):
    bare, oriented = tmp_path / "a.nrrd", tmp_path / "b.nrrd"
    header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
    bare.write_bytes((header + "spacings: 1 1 1\n\n").encode() + bytes(32) + b"\3" * 32)
    oriented.write_bytes((header + "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n\n").encode() + bytes(64))
    labels = palpate.load(bare)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        palpate.layers_by_label(labels, beside=palpate.load(bare, orientation="RAS"))
        palpate.layers_by_label(labels, beside=palpate.load(bare))
    with pytest.warns(UserWarning, match="a.nrrd does not give its orientation"):
        palpate.layers_by_label(labels, beside=palpate.load(oriented))
