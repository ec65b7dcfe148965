"""Random files of chunks in which another program finds the places: HDF5 of Imaris and BigDataViewer with every layout and
kind of index, and stores behind servers of many habits. The samples are those that h5py and the writers give."""

import functools
import gzip
import http.server
import itertools
import re
import threading
import urllib.parse

import h5py
import numcodecs
import numpy
import palpate
import pytest
import tifffile
import zarr
from random_headers_test import try_seeds
from random_stores_test import expect_level, grid_of, zarr3

# HDF5 -------------------------------------------------------------------------------------------------


def samples_of(dice, dtype, shape):
    return dice.randn(*shape).astype(dtype) if dtype[-2] == "f" else dice.samples(dtype[-2:], shape).astype(dtype)


def dataset(dice, file, path, data):
    """Returns the samples that h5py reads, some of them fill values."""
    if dice.often(0.2):
        file.create_dataset(path, data=data)
        return data
    chunk = tuple(int(dice.randint(1, size + 1)) for size in data.shape)
    most = tuple(dice.one((None, size, size + 9)) for size in data.shape)
    stored = file.create_dataset(path, data.shape, data.dtype, chunks=chunk, maxshape=dice.one((None, most)), shuffle=dice.often(0.4),
                                 compression=dice.one((None, "gzip")), fletcher32=dice.often(0.3), fillvalue=dice.one((None, 3)))
    for _, place in grid_of(data.shape, chunk):
        if dice.often(0.85):
            stored[place] = data[place]
    return stored[...]


def refused_for_its_index(file, error):
    """Whether an array grows along one axis alone that is not the first, which no library tells rightly."""
    grown = []
    file.visititems(lambda _, one: grown.append(one.maxshape) if isinstance(one, h5py.Dataset) and one.chunks else None)
    assert "along an axis other than the first" in str(error)
    return any(most.count(None) == 1 and most[0] for most in grown)


def expect_hdf5(path, expected, dtype, **choice):
    try:
        store = palpate.open_store(path, **choice)
    except palpate.InputError as error:
        with h5py.File(path) as file:
            assert refused_for_its_index(file, error)
        return None
    assert len(store.levels) == len(expected)
    for level, samples in enumerate(expected):
        expect_level(store, level, numpy.ascontiguousarray(samples), dtype[-2:])
    return store.levels[0]


def imaris(dice, folder):
    """Attributes are texts of several kinds. Arrays may be longer than the image."""
    path, dtype = folder / dice.one(("a.ims", "a.h5", "a.hdf5")), dice.one(("u1", "u2", "u4", "f4", ">u2", ">f4", "f8"))
    times, channels, levels = (int(dice.randint(1, 3)) for _ in range(3))
    shape, low, spacing = [int(dice.randint(3, 12)) for _ in range(3)], dice.randint(-9, 9, 3) / 2, [dice.length() for _ in range(3)]
    as_text = dice.one((str, lambda text: numpy.frombuffer(text.encode(), "S1"), lambda text: numpy.bytes_(text.encode())))
    unit, millimetres = dice.one((("um", 1e-3), ("mm", 1), ("nm", 1e-6)))
    with h5py.File(path, "w", libver=dice.one(("earliest", "latest", "v108"))) as file:
        for level, time, channel in itertools.product(range(levels), range(times), range(channels)):
            size = [max(1, one >> level) for one in shape]
            longer = [one + dice.one((0, 3)) for one in size]
            name = f"DataSet/ResolutionLevel {level}/TimePoint {time}/Channel {channel}"
            stored = dataset(dice, file, name + "/Data", samples_of(dice, dtype, longer))
            if (time, channel) == (times - 1, channels - 1):
                expected = [] if level == 0 else expected
                expected.append(stored[:size[0], :size[1], :size[2]])
            for axis, one in zip("ZYX", size):
                file[name].attrs[f"ImageSize{axis}"] = as_text(str(one))
        image = file.create_group("DataSetInfo/Image")
        image.attrs["Unit"] = as_text(unit)
        for axis in range(3):
            image.attrs[f"ExtMin{axis}"] = as_text(repr(low[axis].item()))
            image.attrs[f"ExtMax{axis}"] = as_text(repr(low[axis].item() + spacing[axis] * shape[2 - axis]))
    grid = expect_hdf5(path, expected, dtype, time=times - 1, channel=channels - 1)
    if grid:
        assert numpy.allclose(grid.spacing, numpy.multiply(millimetres, spacing), rtol=1e-9, atol=0)
        assert numpy.allclose(grid.origin, millimetres * (low + numpy.divide(spacing, 2)), rtol=1e-9, atol=1e-12)


def big_data_viewer(dice, folder):
    path, dtype = folder / "a.h5", dice.one(("u1", "u2", "u4", "f4", ">u2"))
    setups, times = ([int(number) for number in sorted(dice.choice(30, dice.randint(1, 3), False))] for _ in range(2))
    setup, time, shape, factors = dice.one(setups), dice.one(times), [int(dice.randint(4, 12)) for _ in range(3)], [[1, 1, 1]]
    if dice.often(0.5):
        factors.append([dice.one((1, 2)) for _ in range(3)])
    with h5py.File(path, "w", libver=dice.one(("earliest", "latest", "v108"))) as file:
        for one in setups:
            file[f"s{one:02}/resolutions"] = numpy.array(factors, "f8")
        for one, moment, level in itertools.product(setups, times, range(len(factors))):
            size = [length // factor for length, factor in zip(shape, factors[level][::-1])]
            stored = dataset(dice, file, f"t{moment:05}/s{one:02}/{level}/cells", samples_of(dice, dtype, size))
            if (one, moment) == (setup, time):
                expected = [] if level == 0 else expected
                expected.append(stored)
    try:
        expect_hdf5(path, expected, dtype, channel=setups.index(setup), time=times.index(time))
    except AssertionError:  # rounded sizes may make a level cover another space, which is then left out
        store = palpate.open_store(path, channel=setups.index(setup), time=times.index(time))
        assert len(store.levels) == 1 and any("level" in note for note in store.notes)
        expect_level(store, 0, numpy.ascontiguousarray(expected[0]), dtype[-2:])


# Servers ----------------------------------------------------------------------------------------------


class Habits(http.server.BaseHTTPRequestHandler):
    """Answers from the folder of the server, by its habits."""

    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def answer(self, status, body=b"", **headers):
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        in_pieces = "pieces" in self.server.habits and status in (200, 206)
        self.send_header(*(("Transfer-Encoding", "chunked") if in_pieces else ("Content-Length", str(len(body)))))
        self.end_headers()
        pieces = [body[at:at + 1000] for at in range(0, len(body), 1000)] if in_pieces else []
        self.wfile.write(b"".join(b"%x\r\n%s\r\n" % (len(piece), piece) for piece in pieces) + b"0\r\n\r\n" if in_pieces else body)

    def do_GET(self):
        habits, address = self.server.habits, urllib.parse.urlsplit(self.path)
        path = urllib.parse.unquote(address.path)
        if address.query != self.server.query:
            return self.answer(403)
        if "moved" in habits and not path.startswith("/moved"):
            return self.answer(habits["moved"], Location="/moved" + self.path)
        file = self.server.folder / path.removeprefix("/moved").lstrip("/")
        if not file.is_file():
            return self.answer(habits.get("missing", 404), b"<Error>NoSuchKey</Error>")
        body, part = file.read_bytes(), re.match(r"bytes=(\d*)-(\d*)", self.headers.get("Range", ""))
        if part and (part[1] or "whole for suffixes" not in habits):
            first = int(part[1]) if part[1] else max(0, len(body) - int(part[2]))
            last = min(int(part[2]), len(body) - 1) if part[1] and part[2] else len(body) - 1
            return self.answer(206, body[first:last + 1], Content_Range=f"bytes {first}-{last}/{len(body)}")
        if "packed" in habits and not part and "gzip" in self.headers.get("Accept-Encoding", ""):
            return self.answer(200, gzip.compress(body), Content_Encoding="gzip")
        return self.answer(200, body)


@functools.cache
def server():
    one = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Habits)
    one.daemon_threads = True
    threading.Thread(target=one.serve_forever, daemon=True).start()
    return one


def behind_a_server(dice, folder):
    kind, dtype = dice.one((".zarr", ".n5", "", ".h5", ".tif")), dice.one(("u1", "u2"))
    name = dice.one(("a", "a b", "ä", "x+y%", "a#b", "a?b", "50%25", "a@b", "deep/er/a")) + kind
    path, data, chunk = folder / name, dice.samples(dtype, (5, 6, 7)), (2, 3, 4)
    path.parent.mkdir(parents=True, exist_ok=True)
    if kind == "":
        path.mkdir()
        data = zarr3(dice, path, data, dice.one("<>"), list(chunk), "zyx")
    elif kind == ".h5":
        with h5py.File(path, "w", libver=dice.one(("earliest", "latest"))) as file:
            file["s00/resolutions"] = numpy.ones((1, 3))
            file.create_dataset("t00000/s00/0/cells", data=data, chunks=chunk, compression="gzip")
    elif kind == ".tif":
        tifffile.imwrite(path, data, tile=(16, 16), compression="zlib", metadata={"axes": "ZYX"}, photometric="minisblack")
    else:
        packed = dice.one((None, numcodecs.GZip(1), numcodecs.Blosc()))
        store = (zarr.N5Store if kind == ".n5" else zarr.DirectoryStore)(str(path))
        zarr.open(store, mode="w", shape=data.shape, chunks=chunk, dtype=dtype, compressor=packed, fill_value=0)[...] = data
    habits = {"moved": dice.one((301, 302, 303, 307, 308)), "missing": dice.one((403, 404, 410)), "pieces": True, "packed": True,
              "whole for suffixes": True}
    server().habits = {name: value for name, value in habits.items() if dice.often(0.3)}
    server().folder, server().query = folder, dice.one(("", "", "token=abc", "sig=a%2Fb%3D&x=1", "a=b%20c"))
    address = f"http://127.0.0.1:{server().server_port}/{urllib.parse.quote(name)}"
    if kind in (".zarr", ".n5", "") and dice.often(0.3):
        address += "/"
    if server().query:
        address += "?" + server().query
    address += dice.one(("", "#top"))
    forbidden = server().habits.get("missing") == 403
    for _ in range(2):  # the second time, from the disk
        expect_level(palpate.open_store(address, cache=folder / "cache", forbidden_is_missing=forbidden), 0, data, dtype)


@pytest.mark.parametrize("generate", (imaris, big_data_viewer, behind_a_server))
def test_random_chunks(tmp_path, generate):
    try_seeds(tmp_path, generate, 30)
