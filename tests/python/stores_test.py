"""Stores give the samples of the volume, a box at a time, in their place."""

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
