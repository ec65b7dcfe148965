"""Stores, TIFF and HDF5 of kinds that people report to other programs: unusual addresses, and the advice of refusals."""

import functools
import http.server
import json
import pathlib
import struct
import threading

import h5py
import numpy
import palpate
import pytest
import tifffile
import zarr
from numcodecs import BitRound, Delta, FixedScaleOffset
from readers_test import ramp, refused


def refused_store(address, *words):
    with pytest.raises(palpate.InputError) as caught:
        palpate.open_store(address)
    message = str(caught.value)
    assert "\n" not in message and all(word in message for word in words), message


# Addresses --------------------------------------------------------------------------------------------


@pytest.fixture
def served(tmp_path):
    """The address of a server, and the requests that it got."""
    requests = []

    class Handler(http.server.SimpleHTTPRequestHandler):
        def do_GET(self):
            requests.append(self.path)
            super().do_GET()

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=tmp_path))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}", requests
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("query", ("", "?name=a b", "?name=a%20b&version= 1"))
@pytest.mark.parametrize("name", ("a.zarr", "a b.zarr", "ä 脳.zarr"))
def test_blanks_anywhere_in_an_address_are_escaped(tmp_path, served, name, query):
    address, requests = served
    zarr.save_array(str(tmp_path / name), ramp("u2"), chunks=(2, 4, 6))
    store = palpate.open_store(f"{address}/{name}{query}")
    assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, ramp("u2"))
    assert all(request.endswith(query.replace(" ", "%20")) for request in requests)


@pytest.mark.parametrize("address, words", (
    ("file:///data/a.zarr", "give the path alone"), ("gs://bucket/a.zarr", "https://storage.googleapis.com/BUCKET/NAME"),
    ("ftp://host/a.zarr", "begins with none of http://"), (pathlib.Path("http://host/a.zarr"), "give it as text"),
    (pathlib.Path("s3://bucket/a.zarr"), "give it as text")))
def test_an_address_of_another_kind_is_refused_with_the_way_to_write_it(address, words):
    refused_store(address, words)


# Zarr -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name, codec", (("delta", Delta("f4")), ("bitround", BitRound(8)),
                                         ("fixedscaleoffset", FixedScaleOffset(0, 10, "f4", "i2"))))
def test_a_filter_is_refused_by_its_name(tmp_path, name, codec):
    array = zarr.open(str(tmp_path / "a.zarr"), mode="w", shape=(5, 4, 6), dtype="f4", chunks=(2, 4, 6), filters=[codec])
    array[:] = ramp("f4")
    refused_store(tmp_path / "a.zarr", f"filter '{name}'", "store it without filters")


def test_a_scale_of_zero_is_refused_with_what_to_correct(tmp_path):
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w")
    group.create_dataset("0", data=ramp("u2"), chunks=(2, 4, 6))
    axes = [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    transform = [{"type": "scale", "scale": [0, 1, 1]}]
    (tmp_path / "a.zarr/.zattrs").write_text(json.dumps(
        {"multiscales": [{"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": transform}]}]}))
    refused_store(tmp_path / "a.zarr", "spacing", "correct its metadata")


LPS = ("inferior-to-superior", "anterior-to-posterior", "right-to-left")


@pytest.mark.parametrize("sides, scale, origin, direction", (
    (LPS, (2, 1, 1), (30, 20, 10), (1, 1, 1)),
    (("inferior-to-superior", "posterior-to-anterior", "left-to-right"), (2, 1, 1), (-30, -20, 10), (-1, -1, 1)),
    (("superior-to-inferior", *LPS[1:]), (-2, 1, 1), (30, 20, -10), (1, 1, 1)),
    (("inferior-to-superior", "dorsal-to-ventral", "right-to-left"), (2, 1, 1), None, None),
    ((*LPS[:2], None), (2, 1, 1), None, None), (("right-to-left", *LPS[1:]), (2, 1, 1), None, None)))
def test_axes_say_to_which_side_of_the_body_they_run(tmp_path, sides, scale, origin, direction):
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w")
    group.create_dataset("0", data=ramp("u2"), chunks=(2, 4, 6))
    axes = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
    for axis, side in zip(axes, sides, strict=True):
        if side:
            axis["orientation"] = {"type": "anatomical", "value": side}
    transform = [{"type": "scale", "scale": scale}, {"type": "translation", "translation": [10, 20, 30]}]
    (tmp_path / "a.zarr/.zattrs").write_text(json.dumps(
        {"multiscales": [{"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": transform}]}]}))
    store = palpate.open_store(tmp_path / "a.zarr")
    geometry = store.levels[0]
    assert geometry.oriented == (origin is not None)
    assert any("orientation of its axes was not used" in note for note in store.notes) == (origin is None)
    assert numpy.array_equal(geometry.origin, origin or (30, 20, 10))
    assert numpy.array_equal(geometry.direction, numpy.diag(direction or (1, 1, 1)))


# HDF5 and TIFF ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ("a.nxs", "a.nc", "a.he5", "a"))
def test_hdf5_is_known_by_its_bytes(tmp_path, name):
    with h5py.File(tmp_path / name, "w") as file:
        file["entry/data/data"] = ramp("u2")
    refused(tmp_path / name, "is an HDF5 file", "save the volume as")


def big_data_viewer(path, data, told):
    with h5py.File(path, "w") as file:
        file["s00/resolutions"] = numpy.ones((1, 3))
        file["s00/subdivisions"] = numpy.array([[6, 4, 2]], "i4")
        file.create_dataset("t00000/s00/0/cells", data=data, chunks=(2, 4, 6))
        if told:
            file["s00"].attrs["dataType"] = told


@pytest.mark.parametrize("stored, told, meant", (
    ("i2", None, "u2"), ("i2", "int16", "i2"), ("i2", "uint16", "u2"), ("u2", "uint16", "u2"), ("u2", None, "u2"), ("i1", "uint8", "u1"),
    ("i1", None, "i1"), ("f4", "float32", "f4")))
def test_big_data_viewers_own_type_tells_the_sign(tmp_path, stored, told, meant):
    data = (ramp("i4") - 100).astype(stored)
    big_data_viewer(tmp_path / "a.h5", data, told)
    store = palpate.open_store(tmp_path / "a.h5")
    assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, data.view(meant).astype("f4"))


@pytest.mark.parametrize("planes", ("contig", "separate"))
def test_several_values_in_each_pixel_are_not_called_colours(tmp_path, planes):
    data = numpy.moveaxis(ramp("u2"), 0, -1).copy() if planes == "contig" else ramp("u2")
    tifffile.imwrite(tmp_path / "a.tif", data, photometric="minisblack", planarconfig=planes, metadata=None)
    refused(tmp_path / "a.tif", "5 values in each pixel", "as a page")


# In HDF5's newer format, each kind of index of chunks. libhdf5 1.10 tells the places of other chunks for arrays that
# grow along one axis, unless it is the first.
@pytest.mark.parametrize("most, read", (
    ((None, 4, 6), True), ((5, 4, 6), True), ((9, 4, 12), True), ((None, 4, None), True), ((None, None, None), True), ((None, 4, 12), True),
    ((5, None, 6), False), ((5, 4, None), False), ((9, 4, None), False)))
@pytest.mark.parametrize("packed", (None, "gzip"))
def test_chunks_of_hdf5_that_may_grow_are_read_in_their_places_or_refused(tmp_path, most, read, packed):
    data = numpy.random.RandomState(1).randint(0, 65536, (5, 4, 6)).astype("u2")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w", libver="latest") as file:
        file["s00/resolutions"] = numpy.ones((1, 3))
        file.create_dataset("t00000/s00/0/cells", data=data, chunks=(2, 3, 2), maxshape=most, compression=packed)
    if not read:
        refused_store(path, "t00000/s00/0/cells", "along an axis other than the first", "h5repack")
        with h5py.File(path) as file, h5py.File(tmp_path / "b.h5", "w") as other:
            other["s00/resolutions"] = file["s00/resolutions"][...]
            file.copy("t00000", other)
            other.create_dataset("t00001/s00/0/cells", data=data, chunks=(2, 3, 2), maxshape=most, compression=packed)
        path = tmp_path / "b.h5"
    store = palpate.open_store(path, time=0 if read else 1)
    assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, data)


@pytest.mark.parametrize("name", ("a.ome.tf2", "a.ome.tf8", "a.ome.btf", "a.TIFF"))
def test_large_files_of_ome_have_names_of_their_own(tmp_path, name):
    tifffile.imwrite(tmp_path / name, ramp("u2"), bigtiff=True, ome=True, tile=(16, 16), photometric="minisblack", metadata={"axes": "ZYX"})
    store = palpate.open_store(tmp_path / name)
    assert numpy.array_equal(store.read((0, 0, 0), store.levels[0].size).array, ramp("u2"))


@pytest.mark.parametrize("tile", (None, (16, 16)))
def test_deflated_tiff_may_have_its_bits_in_reverse_order(tmp_path, tile):
    path, reverse = tmp_path / "a.tif", bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
    tifffile.imwrite(path, ramp("u2"), compression="zlib", tile=tile, photometric="minisblack", metadata=None, extratags=[(263, 3, 1, 2, False)])
    data = bytearray(path.read_bytes())
    with tifffile.TiffFile(path) as file:
        for page in file.pages:
            struct.pack_into("<H", data, page.tags[263].offset, 266)  # FillOrder, which tifffile does not write
            for at, count in zip(page.dataoffsets, page.databytecounts):
                data[at:at + count] = data[at:at + count].translate(reverse)
    path.write_bytes(data)
    assert numpy.array_equal(palpate.load(path).volume.array, ramp("u2"))
