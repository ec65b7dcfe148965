"""Stores give the samples of the volume, a box at a time, in their place."""

import os
import subprocess
import time

import numpy
import palpate
import pytest


@pytest.fixture
def volume(tmp_path):
    samples = numpy.random.default_rng(3).integers(0, 4000, (17, 23, 31)).astype("uint16")
    made = palpate.Volume(samples, spacing=(0.5, 1, 2), origin=(3, -4, 5))
    palpate.write(made, tmp_path / "v.nrrd")
    return made


def test_boxes_have_the_samples_and_the_place_of_the_whole(volume, tmp_path):
    store = palpate.open_store(str(tmp_path / "v.nrrd"))
    assert store.type == "uint16" and len(store.levels) == 1 and "31x23x17" in repr(store)
    assert store.levels[0] == volume.geometry or (store.levels[0].size == (31, 23, 17)).all()
    random = numpy.random.default_rng(4)
    for _ in range(20):
        low = random.integers(0, (31, 23, 17))
        high = random.integers(low + 1, (32, 24, 18))
        box = store.read(low, high)
        x, y, z = (slice(a, b) for a, b in zip(low, high))
        assert (box.array == volume.array[z, y, x]).all()
        assert numpy.allclose(box.geometry.origin, volume.geometry.physical(low))


def test_a_store_is_felt_while_it_is_read(volume, tmp_path):
    store = palpate.open_store(tmp_path / "v.nrrd")
    loaded = palpate.LoadedVolume(store, memory_bytes=1 << 26)
    assert loaded.format == store.format and loaded.volume.type == "uint16"
    with pytest.raises(palpate.InputError):
        palpate.LoadedVolume(store, memory_bytes=1)
    with pytest.raises(ValueError, match="no level 3"):
        palpate.LoadedVolume(store, level=3)
    for what in (store, loaded):
        with palpate.Run(what, palpate.Setup(isovalue=2000, real_time=False)) as run:
            run.record(tmp_path / f"{type(what).__name__}.csv")
            begun = run.snapshot().number if run.snapshot() else 0
            end = time.monotonic() + 120
            while not run.snapshot() or run.snapshot().number < begun + 60:
                assert time.monotonic() < end
                time.sleep(0.005)
        run.stop_recording()
        assert palpate.validate(tmp_path / f"{type(what).__name__}.csv")["ticks"] >= 50


@pytest.mark.parametrize("name", ["brain.zarr", "http://127.0.0.1:1/brain", "a/b.n5"])
def test_load_points_to_the_function_for_stores(name):
    with pytest.raises(palpate.InputError, match=r"read by the box: open it with open_store\(\)"):
        palpate.load(name)


@pytest.mark.parametrize("name", ("plain", "a.h5", "a.ims"))
def test_load_points_there_whatever_the_name_of_a_store(volume, tmp_path, name):
    if name == "plain":
        subprocess.run([os.environ["PALPATE"], "convert", "--quiet", tmp_path / "v.nrrd", tmp_path / "v.zarr"], check=True)
        (tmp_path / "v.zarr").rename(tmp_path / name)
        assert palpate.open_store(tmp_path / name).type == "uint16"
    else:
        (tmp_path / name).write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises(palpate.InputError, match=r"read by the box: open it with open_store\(\)"):
        palpate.load(tmp_path / name)


def test_wrong_boxes_levels_and_addresses_are_refused(volume, tmp_path):
    store = palpate.open_store(str(tmp_path / "v.nrrd"))
    for low, high in (((0, 0, 0), (32, 23, 17)), ((-1, 0, 0), (1, 1, 1)), ((3, 3, 3), (3, 4, 4))):
        with pytest.raises(ValueError, match="lies in the grid"):
            store.read(low, high)
    with pytest.raises(ValueError, match="there is no level 1"):
        store.read((0, 0, 0), (1, 1, 1), level=1)
    with pytest.raises(palpate.InputError, match="does not exist"):
        palpate.open_store(str(tmp_path / "gone.zarr"))


def test_a_raw_file_needs_its_layout(volume, tmp_path):
    (tmp_path / "v.raw").write_bytes(volume.array.tobytes())
    layout = palpate.RawLayout(size=(31, 23, 17), type="uint16", spacing=(1, 1, 1))
    store = palpate.open_store(str(tmp_path / "v.raw"), raw=layout)
    assert (store.read((0, 0, 0), (31, 23, 17)).array == volume.array).all()
    with pytest.raises(palpate.InputError):
        palpate.open_store(str(tmp_path / "v.raw"))


def test_a_path_is_taken_wherever_a_name_is(volume, tmp_path):
    layers, points = tmp_path / "set.json", tmp_path / "tool.csv"
    palpate.layers_named("ct-needle").write(layers)
    points.write_text("x,y,z\n0,0,0\n1,0,0\n")
    assert palpate.open_store(tmp_path / "v.nrrd").type == "uint16"
    assert palpate.layers_named(layers).text == palpate.layers_named(str(layers)).text
    assert len(palpate.Tool.named(points, 1).points) == len(palpate.Tool.named(str(points), 1).points) > 0
    setup = palpate.RenderSetup(layers=layers)
    setup.tool = points
    assert setup.tool == str(points) and setup.layers.name == palpate.layers_named(layers).name
    loaded = palpate.LoadedVolume(volume, tmp_path / "v.nrrd")
    assert loaded.name == str(tmp_path / "v.nrrd")
    with pytest.raises(palpate.InputError):
        palpate.validate(tmp_path / "none.csv", tmp_path / "v.nrrd")
