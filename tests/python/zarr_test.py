"""Zarr whose metadata contradict themselves or the chunks beside them: each is read as the reference reads it, noted, or
refused by name."""

import json

import numpy
import palpate
import pytest
import zarr

SHAPE = (6, 10, 16)  # z, y, x
LITTLE = {"name": "bytes", "configuration": {"endian": "little"}}
LAYOUTS = {"0.0.0": ("", "."), "0/0/0": ("", "/"), "c/0/0/0": ("c/", "/"), "c.0.0.0": ("c.", "."), "c/0.0.0": ("c/", ".")}


def ramp(step=1):
    return numpy.arange(1, numpy.prod(SHAPE) + 1, dtype="<u2").reshape(SHAPE)[::step, ::step, ::step]


def put(path, data):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data if isinstance(data, bytes) else json.dumps(data).encode())


def put_chunks(folder, array, layout):
    """Chunks of (3, 5, 8) samples; those beyond the border are filled with 0."""
    prefix, separator = LAYOUTS[layout]
    counts = [-(-n // c) for n, c in zip(array.shape, (3, 5, 8))]
    for z, y, x in numpy.ndindex(*counts):
        chunk = numpy.zeros((3, 5, 8), array.dtype)
        part = array[3 * z:3 * z + 3, 5 * y:5 * y + 5, 8 * x:8 * x + 8]
        chunk[tuple(map(slice, part.shape))] = part
        put(folder / (prefix + separator.join(map(str, (z, y, x)))), chunk.tobytes())


def metadata2(array, **more):
    return dict(zarr_format=2, shape=array.shape, chunks=(3, 5, 8), dtype=array.dtype.str, compressor=None,
                fill_value=0, order="C", filters=None) | more


def metadata3(array, **more):
    return dict(zarr_format=3, node_type="array", shape=array.shape, data_type=array.dtype.name, fill_value=0,
                chunk_grid={"name": "regular", "configuration": {"chunk_shape": (3, 5, 8)}}, codecs=[LITTLE],
                chunk_key_encoding={"name": "default", "configuration": {"separator": "/"}}, attributes={}) | more


def scaled(*scale):
    return {"type": "scale", "scale": scale}


def moved(*translation):
    return {"type": "translation", "translation": translation}


def image(folder, arrays, transformations, version="0.4", more=(), order=(0, 1)):
    """An OME-Zarr 0.4 with these levels."""
    axes = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
    datasets = [{"path": str(i)} | ({"coordinateTransformations": one} if one else {})
                for i, one in enumerate(transformations)]
    one = {"version": version, "axes": axes, "datasets": [datasets[i] for i in order[:len(arrays)]]}
    put(folder / ".zgroup", {"zarr_format": 2})
    put(folder / ".zattrs", {"multiscales": [one, *more]})
    for i, array in enumerate(arrays):
        put(folder / str(i) / ".zarray", metadata2(array))
        put_chunks(folder / str(i), array, "0.0.0")
    return folder


def opened(path):
    store = palpate.open_store(str(path))
    return store, store.read((0, 0, 0), store.levels[0].size).array


def refused(path, *words):
    with pytest.raises(palpate.InputError) as caught:
        palpate.open_store(str(path))
    message = str(caught.value)
    assert "\n" not in message and all(word in message for word in words), message


# Where the chunks lie --------------------------------------------------------------------------------


@pytest.mark.parametrize("declared", (None, ".", "/"))
@pytest.mark.parametrize("layout", ("0.0.0", "0/0/0"))
def test_chunks_of_zarr_2_are_read_where_they_lie(tmp_path, layout, declared):
    put(tmp_path / ".zarray", metadata2(ramp(), **({"dimension_separator": declared} if declared else {})))
    put_chunks(tmp_path, ramp(), layout)
    store, values = opened(tmp_path)
    assert numpy.array_equal(values, ramp())
    agree = LAYOUTS[layout][1] == (declared or ".")
    assert any(f"named {layout}" in note for note in store.notes) != agree


@pytest.mark.parametrize("declared", ("0.0.0", "0/0/0", "c/0/0/0", "c.0.0.0"))
@pytest.mark.parametrize("layout", LAYOUTS)
def test_chunks_of_zarr_3_are_read_where_they_lie(tmp_path, layout, declared):
    prefix, separator = LAYOUTS[declared]
    encoding = {"name": "default" if prefix else "v2", "configuration": {"separator": separator}}
    put(tmp_path / "zarr.json", metadata3(ramp(), chunk_key_encoding=encoding))
    put_chunks(tmp_path, ramp(), layout)
    store, values = opened(tmp_path)
    assert numpy.array_equal(values, ramp())
    assert any(f"named {layout}" in note for note in store.notes) == (layout != declared)


def test_chunks_in_two_layouts_and_none_as_declared_are_refused(tmp_path):
    put(tmp_path / "zarr.json", metadata3(ramp()))
    put_chunks(tmp_path, ramp(), "0/0/0")
    put_chunks(tmp_path, ramp(), "c.0.0.0")
    refused(tmp_path, "0/0/0 and c.0.0.0", "none named c/0/0/0")
    put_chunks(tmp_path, ramp(2), "c/0/0/0")  # then the others are not looked at
    assert not any("named" in note for note in opened(tmp_path)[0].notes)


def test_files_beside_the_chunks_and_empty_folders_are_no_chunks(tmp_path):
    put(tmp_path / ".zarray", metadata2(ramp()))
    put_chunks(tmp_path, ramp(), "0/0/0")
    for name in ("0.0", "0.0.0.0", "0..0", "0.0.x", ".0.0.0"):
        put(tmp_path / name, b"x")
    (tmp_path / "c/0/0").mkdir(parents=True)
    assert numpy.array_equal(opened(tmp_path)[1], ramp())


def test_a_file_in_place_of_the_folder_of_chunks_holds_none(tmp_path):
    put(tmp_path / "zarr.json", metadata3(ramp()))
    put(tmp_path / "c", b"x")
    put_chunks(tmp_path, ramp(), "c.0.0.0")
    assert numpy.array_equal(opened(tmp_path)[1], ramp())


def test_a_level_without_any_chunk_is_noted(tmp_path):
    path = image(tmp_path, [ramp(), ramp(2)], [[scaled(1, 1, 1)], [scaled(2, 2, 2)]])
    assert not any("no chunk" in note for note in opened(path)[0].notes)
    for chunk in (tmp_path / "1").glob("0*"):
        chunk.unlink()
    store, values = opened(path)
    assert [note for note in store.notes if "no chunk" in note] == [
        "its level '1' has no chunk at all: all of it is the fill value"]
    assert numpy.array_equal(values, ramp()) and len(store.levels) == 2


# Levels ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale, translation, kept", (
    ((2, 2, 2), (0, 0, 0), True), ((2, 2, 2), (0.5, 0.5, 0.5), True), ((2.01, 1.99, 2), (1, -1, 1), True),
    ((1, 1, 1), (0, 0, 0), False), ((2, 2, 4), (0, 0, 0), False), ((2, 2, 2), (0, 0, 9), False)))
def test_a_level_that_does_not_cover_the_finest_is_left_out(tmp_path, scale, translation, kept):
    path = image(tmp_path, [ramp(), ramp(2)], [[scaled(1, 1, 1)], [scaled(*scale), moved(*translation)]])
    store, values = opened(path)
    assert numpy.array_equal(values, ramp())
    assert len(store.levels) == 1 + kept
    assert any("level 1 was left out" in note for note in store.notes) != kept


@pytest.mark.parametrize("sizes", ((5, 11, 17), (6, 10, 16), (5, 10, 31)))
@pytest.mark.parametrize("rounded", (numpy.floor, numpy.ceil, numpy.round))
def test_levels_whose_sizes_are_rounded_are_kept(tmp_path, sizes, rounded):
    arrays, steps = [], []
    for level in range(3):
        arrays.append(numpy.ones(sizes, "<u2"))
        steps.append([scaled(2.0**level, 1, 2.0**level)])  # y is not coarser
        sizes = [int(max(1, rounded(n / factor))) for n, factor in zip(sizes, (2, 1, 2))]
    store, _ = opened(image(tmp_path, arrays, steps, order=(0, 1, 2)))
    assert len(store.levels) == 3 and not any("left out" in note for note in store.notes)


def test_levels_that_are_listed_coarse_first_are_sorted(tmp_path):
    steps = [[scaled(3, 2, 1)], [scaled(6, 4, 2), moved(1.5, 1, 0.5)]]
    store, values = opened(image(tmp_path, [ramp(), ramp(2)], steps, order=(1, 0)))
    assert numpy.array_equal(values, ramp())
    assert [list(level.spacing) for level in store.levels] == [[1, 2, 3], [2, 4, 6]]
    assert any("sorted" in note for note in store.notes)


def test_levels_without_scales_are_compared_by_their_sizes(tmp_path):
    store, _ = opened(image(tmp_path, [ramp(), ramp(2)], [None, None], version="0.2"))
    assert [list(level.spacing) for level in store.levels] == [[1, 1, 1], [2, 2, 2]]
    assert list(store.levels[1].origin) == [0.5, 0.5, 0.5]
    assert any("sizes were compared" in note for note in store.notes)


# Transformations, versions, images -------------------------------------------------------------------


@pytest.mark.parametrize("steps, taken", (
    ([scaled(3, 2, 1), moved(1, 1, 1)], True), ([scaled(3, 2, 1)], True), ([moved(1, 1, 1)], True),
    ([moved(1, 1, 1), scaled(3, 2, 1)], False), ([scaled(3, 2, 1), scaled(3, 2, 1)], False),
    ([scaled(3, 2, 1), moved(1, 1, 1), moved(1, 1, 1)], False)))
def test_a_translation_comes_after_the_scale(tmp_path, steps, taken):
    path = image(tmp_path, [ramp()], [steps])
    if not taken:
        return refused(path, "one scale and then one translation")
    assert list(opened(path)[0].levels[0].origin) == ([1, 1, 1] if moved(1, 1, 1) in steps else [0, 0, 0])


@pytest.mark.parametrize("version, known", (("0.4", True), ("0.6", True), ("0.7", False), ("0.10", False), ("1.0", False)))
def test_versions_after_0_6_are_noted(tmp_path, version, known):
    notes = opened(image(tmp_path, [ramp()], [[scaled(1, 1, 1)]], version=version))[0].notes
    assert any(f"is {version}" in note for note in notes) != known


@pytest.mark.parametrize("named", (True, False))
def test_axes_of_version_0_6_are_those_of_the_coordinate_system_of_the_levels(tmp_path, named):
    steps = [scaled(3, 2, 1), moved(10, 20, 30)]
    path = image(tmp_path, [ramp()], [[{"type": "sequence", "input": {"path": "0"}, "transformations": steps,
                                        "output": {"name": "physical"} if named else "physical"}]])
    attributes = json.loads((path / ".zattrs").read_text())
    one = attributes["multiscales"][0]
    systems = [{"name": "other", "axes": [{"name": name, "type": "space", "unit": "meter"} for name in "xyz"]},
               {"name": "physical", "axes": one.pop("axes")}]
    one["coordinateSystems"] = systems
    put(path / ".zattrs", {"ome": attributes | {"version": "0.6"}})
    store, array = opened(path)
    assert numpy.array_equal(array, ramp()) and list(store.levels[0].origin) == [30, 20, 10]
    assert list(store.levels[0].spacing) == [1, 2, 3] and not any("further" in note for note in store.notes)
    one["coordinateTransformations"] = [{"type": "affine", "affine": [], "input": "physical", "output": "other"}]
    put(path / ".zattrs", {"ome": attributes | {"version": "0.6"}})
    store, array = opened(path)
    assert list(store.levels[0].spacing) == [1, 2, 3] and any("further transformations" in note for note in store.notes)


def test_a_second_image_is_noted(tmp_path):
    other = {"axes": [], "datasets": []}
    notes = opened(image(tmp_path, [ramp()], [[scaled(1, 1, 1)]], more=[other]))[0].notes
    assert any("2 images" in note for note in notes)


@pytest.mark.parametrize("told, folder", (
    ({"plate": {"wells": [{"path": "B/03", "rowIndex": 1, "columnIndex": 2}]}}, "B/03"), ({"labels": ["cells", "nuclei"]}, "cells"),
    ({"plate": {"wells": []}}, "")))
@pytest.mark.parametrize("version", (2, 3))
def test_plates_and_lists_of_labels_name_a_folder_with_an_image(tmp_path, told, folder, version):
    if version == 2:
        (tmp_path / ".zgroup").write_text('{"zarr_format": 2}')
        (tmp_path / ".zattrs").write_text(json.dumps(told))
    else:
        (tmp_path / "zarr.json").write_text(json.dumps({"zarr_format": 3, "node_type": "group", "attributes": {"ome": told}}))
    with pytest.raises(palpate.InputError) as caught:
        palpate.open_store(tmp_path)
    assert str(caught.value).endswith("give one in a folder below it" + (f", such as {folder}" if folder else ""))


# Fill values -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("dtype, fill", (
    ("<u2", "NaN"), ("<u2", 70000), ("<u2", 1.5), ("<u2", -32769), ("|i1", 128), ("<i2", -32769), ("<u8", 2.0**64),
    ("<f4", "0x3fc0"), ("<f4", "0x3ff8000000000000"), ("<f8", "0x3fc00000"), ("<u2", "0x0007"), ("<f4", "0"), ("<u2", [1])))
def test_a_fill_value_that_its_type_does_not_have_is_refused(tmp_path, dtype, fill):
    array = ramp().astype(dtype)
    put(tmp_path / "two/.zarray", metadata2(array, fill_value=fill))
    refused(tmp_path / "two", "fill_value", json.dumps(fill)[:40], array.dtype.name)
    put(tmp_path / "three/zarr.json", metadata3(array, fill_value=fill))
    refused(tmp_path / "three", "fill_value", json.dumps(fill)[:40], array.dtype.name)


@pytest.mark.filterwarnings("ignore:NumPy will stop")
@pytest.mark.parametrize("dtype, fill", (
    ("<u2", 65535), ("<u2", -1), ("|u1", -128), ("<i2", -32768), ("<u2", 7.0), ("<f4", 1.5), ("|b1", True), ("<u2", None)))
def test_fill_values_of_zarr_2_are_those_of_zarr_python(tmp_path, dtype, fill):
    array = ramp().astype(dtype)
    put(tmp_path / ".zarray", metadata2(array, fill_value=fill))
    put(tmp_path / "0.0.0", array[:3, :5, :8].tobytes())
    expected = zarr.open(str(tmp_path), mode="r")[:]
    values = opened(tmp_path)[1]
    if fill is None:  # zarr leaves it open
        assert values[-1, -1, -1] == 0
    else:
        assert numpy.array_equal(values, expected)


def test_a_negative_fill_value_of_an_unsigned_type_is_refused_in_zarr_3(tmp_path):
    put(tmp_path / "zarr.json", metadata3(ramp(), fill_value=-1))
    refused(tmp_path, "fill_value -1", "uint16")


# Zarr 3 ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("member, ignored", (
    ({"must_understand": False}, True), ({"must_understand": True}, False), ({"name": "x"}, False), ("x", False), (None, False)))
def test_members_that_have_to_be_understood_are_refused(tmp_path, member, ignored):
    put(tmp_path / "array/zarr.json", metadata3(ramp(), extension=member))
    put_chunks(tmp_path / "array", ramp(), "c/0/0/0")
    multiscale = {"axes": [{"name": name} for name in "zyx"],
                  "datasets": [{"path": "0", "coordinateTransformations": [scaled(1, 1, 1)]}]}
    put(tmp_path / "group/zarr.json", {"zarr_format": 3, "node_type": "group", "consolidated_metadata": None,
                                       "attributes": {"ome": {"version": "0.5", "multiscales": [multiscale]}},
                                       "extension": member})
    put(tmp_path / "group/0/zarr.json", metadata3(ramp()))
    put_chunks(tmp_path / "group/0", ramp(), "c/0/0/0")
    for path in (tmp_path / "array", tmp_path / "group"):
        if ignored:
            assert numpy.array_equal(opened(path)[1], ramp())
        else:
            refused(path, "'extension'", "understood")


@pytest.mark.parametrize("codecs, words", (
    ([{"name": "bytes"}], "byte order"), ([{"name": "bytes", "configuration": {}}], "byte order"), ([], "bytes"),
    ([{"name": "sharding_indexed", "configuration": {"chunk_shape": (3, 5, 8), "codecs": [LITTLE],
                                                     "index_codecs": [{"name": "bytes"}]}}], "byte order"),
    ([{"name": "sharding_indexed", "configuration": {"chunk_shape": (3, 5, 8), "codecs": [LITTLE], "index_codecs": [LITTLE]}},
      {"name": "gzip", "configuration": {"level": 5}}], "once more as a whole (codec 'gzip')")))
def test_codecs_that_are_not_read_are_refused_with_the_reason(tmp_path, codecs, words):
    put(tmp_path / "zarr.json", metadata3(ramp(), codecs=codecs))
    refused(tmp_path, words)


# ome-ngff 0.4 names the types of axes, not the axes of space; xarray writes time and channel in full.
@pytest.mark.parametrize("names, taken", (
    ("time depth height width", "depth as z, height as y, width as x"), ("channel z lat lon", "lat as y, lon as x"),
    ("time z y x", "")))
def test_axes_of_zarr_may_have_other_names(tmp_path, names, taken):
    names, data = names.split(), numpy.stack([ramp(), ramp() + 1000])
    second = {names[0]: 1}
    zarr.save_array(str(tmp_path / "a"), data)
    zarr.open(str(tmp_path / "a")).attrs["_ARRAY_DIMENSIONS"] = names
    group = zarr.open_group(str(tmp_path / "b"), mode="w")
    group.create_dataset("0", data=data)
    axes = [{"name": name, "type": "space"} for name in names]
    axes[0]["type"] = names[0]
    scale = {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 4, 3, 2]}]}
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": [scale]}]
    for folder, spacing in (("a", (1, 1, 1)), ("b", (2, 3, 4))):
        store = palpate.open_store(str(tmp_path / folder), **second)
        assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, ramp() + 1000)
        assert numpy.array_equal(store.levels[0].spacing, spacing)
        assert any(taken and taken in note for note in store.notes) == (taken != "")


# vizarr 297: a negative scale turns an axis round.
def test_a_negative_scale_of_ome_zarr_turns_an_axis_round(tmp_path):
    levels = [[scaled(2, -3, 4), moved(1, 30, 0)], [scaled(4, -6, 8), moved(1, 30, 0)]]
    store, array = opened(image(tmp_path, [ramp(), ramp(2)], levels))
    assert numpy.array_equal(array, ramp()) and len(store.levels) == 2
    for level, step in zip(store.levels, (1, 2)):
        assert numpy.array_equal(level.spacing, (4 * step, 3 * step, 2 * step)) and numpy.array_equal(level.origin, (0, 30, 1))
        assert numpy.array_equal(level.direction, numpy.diag((1, -1, 1)))
