"""Random arrays of Zarr 2 and 3, OME-Zarr, N5 and TIFF, in the types, orders of bytes and axes, chunks, shards and compressions
that these allow. Samples and places are compared with those that were written."""

import gzip
import itertools
import json
import struct
import zlib

import numcodecs
import numpy
import palpate
import pytest
import tifffile
import zarr
from random_headers_test import KEPT, TYPES, expect, try_seeds

LENGTHS = {"nanometer": 1e-6, "micrometer": 1e-3, "millimeter": 1, "meter": 1000, "angstrom": 1e-7}


def kept(array, dtype):
    with numpy.errstate(all="ignore"):
        values = array.astype(KEPT.get(dtype, "f4"))
    finite = numpy.isfinite(values)
    return numpy.where(finite, values, values[finite].min())


def expect_level(store, level, expected, dtype):
    """All of it, and a part."""
    size = numpy.array(store.levels[level].size)
    for low in (0 * size, size // 2):
        volume = store.read(low, size, level)
        x, y, z = low
        assert numpy.array_equal(volume.array, kept(expected, dtype)[z:, y:, x:]), (volume.array, expected)
    return store.read(0 * size, size, level).geometry


def grid_of(shape, chunk):
    """The number of each chunk, and its place in the array."""
    for number in itertools.product(*(range(-(-size // length)) for size, length in zip(shape, chunk))):
        yield number, tuple(slice(i * length, min((i + 1) * length, size)) for i, length, size in zip(number, chunk, shape))


def space_of(array, names, time=0, channel=0):
    """The samples [z, y, x] of a time and a channel."""
    names = list(names)
    for name, number in (("t", time), ("c", channel)):
        if name in names:
            array = array.take(number, axis=names.index(name))
            names.remove(name)
    if "z" not in names:
        array, names = array[None], ["z", *names]
    return array.transpose([names.index(name) for name in "zyx"])


# Zarr -----------------------------------------------------------------------------------------------

CRC = [0] * 256
for byte in range(256):
    CRC[byte] = byte
    for _ in range(8):
        CRC[byte] = CRC[byte] >> 1 ^ (0x82F63B78 if CRC[byte] & 1 else 0)


def with_crc32c(data):
    total = 0xFFFFFFFF
    for value in data:
        total = CRC[(total ^ value) & 255] ^ total >> 8
    return data + struct.pack("<I", total ^ 0xFFFFFFFF)


def zarr2(dice, path, array, order, chunk, fill):
    """Returns the array that zarr-python reads, which need not have all chunks."""
    codecs = (None, numcodecs.GZip(3), numcodecs.Zlib(2), numcodecs.Zstd(2), numcodecs.LZ4(), numcodecs.Blosc("lz4", 5, 1),
              numcodecs.Blosc("zstd", 5, 2), numcodecs.Blosc("blosclz", 3, 0))
    stored = zarr.open(str(path), mode="w", shape=array.shape, chunks=chunk, dtype=array.dtype.newbyteorder(order), fill_value=fill,
                       order=dice.one("CF"), compressor=dice.one(codecs), dimension_separator=dice.one("./"))
    stored[...] = array
    for file in sorted(file for file in path.rglob("*") if file.is_file() and not file.name.startswith("."))[1:]:
        if dice.often(0.2):
            file.unlink()
    return stored[...]


PACKERS = {"gzip": ({"level": 3}, gzip.compress), "crc32c": ({}, with_crc32c),
           "zstd": ({"level": 1, "checksum": False}, lambda data: bytes(numcodecs.Zstd(1).encode(data))),
           "blosc": ({"cname": "lz4", "clevel": 3, "shuffle": "noshuffle", "typesize": 1, "blocksize": 0},
                     lambda data: bytes(numcodecs.Blosc("lz4", 3, 0).encode(numpy.frombuffer(data, "u1"))))}


def codecs_of(dice, dtype, order, axes):
    """In the words of Zarr 3, and a function that packs a chunk."""
    turned = [int(axis) for axis in dice.permutation(axes)] if dice.often(0.5) else list(range(axes))
    names = [dice.one(PACKERS) for _ in range(dice.randint(0, 3))]
    endian = {"configuration": {"endian": "little" if order == "<" else "big"}} if dtype[1:] != "1" else {}
    codecs = [{"name": "transpose", "configuration": {"order": turned}}, {"name": "bytes", **endian},
              *({"name": name, "configuration": PACKERS[name][0]} for name in names)]

    def pack(chunk):
        data = numpy.ascontiguousarray(chunk.transpose(turned)).astype(order + dtype).tobytes()
        for name in names:
            data = PACKERS[name][1](data)
        return data
    return codecs, pack


def shard_of(dice, block, inner, pack, at_start, checked):
    """Chunks in any order, some of them missing, of the last of which `block` then has the fill value."""
    counts = [size // length for size, length in zip(block.shape, inner)]
    room = 16 * int(numpy.prod(counts)) + 4 * checked
    entries, data = {number: (2 ** 64 - 1, 2 ** 64 - 1) for number in itertools.product(*map(range, counts))}, b""
    places = list(grid_of(block.shape, inner))
    dice.shuffle(places)
    for number, place in places:
        if data and dice.often(0.2):
            block[place] = 0
            continue
        packed = pack(block[place])
        entries[tuple(number)] = (room * at_start + len(data), len(packed))
        data += packed
    index = b"".join(struct.pack("<2Q", *entry) for entry in entries.values())
    index = with_crc32c(index) if checked else index
    return index + data if at_start else data + index


def zarr3(dice, path, array, order, chunk, names):
    dtype, axes = array.dtype.str[1:], array.ndim
    codecs, pack = codecs_of(dice, dtype, order, axes)
    sharded, at_start, checked = dice.often(0.5), dice.often(0.4), dice.often(0.7)
    whole = [length * int(dice.randint(1, 3)) for length in chunk] if sharded else chunk
    if sharded:
        index = [{"name": "bytes", "configuration": {"endian": "little"}}, *([{"name": "crc32c"}] if checked else [])]
        codecs = [{"name": "sharding_indexed", "configuration": {"chunk_shape": chunk, "codecs": codecs, "index_codecs": index,
                                                                 "index_location": "start" if at_start else "end"}}]
    keys, separator = dice.one(("default", "v2")), dice.one("./")
    expected = numpy.zeros_like(array)
    for number, place in grid_of(array.shape, whole):
        if any(number) and dice.often(0.2):
            continue
        block = numpy.zeros(whole, array.dtype)
        part = tuple(slice(0, one.stop - one.start) for one in place)
        block[part] = array[place]
        data = shard_of(dice, block, chunk, pack, at_start, checked) if sharded else pack(block)
        expected[place] = block[part]
        file = path / separator.join((["c"] if keys == "default" else []) + [str(i) for i in number])
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
    kind = {"i": "int", "u": "uint", "f": "float"}[dtype[0]] + str(8 * int(dtype[1:]))
    (path / "zarr.json").write_text(json.dumps({
        "zarr_format": 3, "node_type": "array", "shape": array.shape, "data_type": kind, "fill_value": 0, "codecs": codecs, "attributes": {},
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": whole}}, "dimension_names": list(names),
        "chunk_key_encoding": {"name": keys, "configuration": {"separator": separator}}}))
    return expected


def chosen_array(dice, names, halved=1):
    sizes = {"t": 2, "c": 3} | {name: max(1, dice.randint(2, 9) // halved) for name in "zyx"}
    return dice.samples(dice.one(TYPES), [int(sizes[name]) for name in names])


def zarr_array(dice, folder):
    names = dice.one(("zyx", "tzyx", "czyx", "tczyx", "yx", "xyz"))
    array, order = chosen_array(dice, names), dice.one("<>")
    dtype, chunk = array.dtype.str[1:], [int(dice.randint(1, size + 1)) for size in array.shape]
    if dice.often(0.5):
        stored = zarr2(dice, folder / "a.zarr", array, order, chunk, dice.one((0, 1, 7)))
        (folder / "a.zarr/.zattrs").write_text(json.dumps({"_ARRAY_DIMENSIONS": list(names)}))
    else:
        stored = zarr3(dice, folder / "a.zarr", array, order, chunk, names)
    time, channel = dice.randint(2) * ("t" in names), dice.randint(3) * ("c" in names)
    expect_level(palpate.open_store(folder / "a.zarr", time=int(time), channel=int(channel)), 0, space_of(stored, names, time, channel), dtype)


def ome_zarr(dice, folder):
    """Two levels, with a scale and a translation of each level and of the whole image."""
    names, unit, order, path = dice.one(("zyx", "tczyx", "czyx")), dice.one(LENGTHS), dice.one("<>"), folder / "a.zarr"
    version, dtype = dice.one((2, 3)), dice.one(("u1", "i2", "u2", "i4", "i8"))
    shape, levels, datasets, grids = [int(dice.randint(2, 9)) if name in "zyx" else 2 for name in names], [], [], []
    scale, shift = [dice.length() for _ in names], [float(dice.one((0, 1, -3, 10.5))) * (name in "zyx") for name in names]
    outer, moved = [dice.length() if name in "zyx" else 1.0 for name in names], [float(dice.one((0, 5))) * (name in "zyx") for name in names]
    for level in range(2):
        shape = [max(1, size // 2) if level and name in "zyx" else size for size, name in zip(shape, names)]
        array = dice.samples(dtype, shape)
        chunk = [int(dice.randint(1, size + 1)) for size in shape]
        levels.append(zarr2(dice, path / str(level), array, order, chunk, 0) if version == 2 else
                      zarr3(dice, path / str(level), array, order, chunk, names))
        of_level = [length * (2 if level and name in "zyx" else 1) for length, name in zip(scale, names)]
        at_level = [first + (length / 2 if level and name in "zyx" else 0) for first, length, name in zip(shift, scale, names)]
        datasets.append({"path": str(level), "coordinateTransformations": [{"type": "scale", "scale": of_level},
                                                                           {"type": "translation", "translation": at_level}]})
        grids.append((numpy.multiply(of_level, outer), numpy.multiply(at_level, outer) + moved))
    kinds = {"t": "time", "c": "channel"}
    image = {"axes": [{"name": name, "type": kinds.get(name, "space")} | ({"unit": unit} if name in "zyx" else {}) for name in names],
             "datasets": datasets, "coordinateTransformations": [{"type": "scale", "scale": outer}, {"type": "translation", "translation": moved}]}
    if version == 2:
        (path / ".zgroup").write_text('{"zarr_format": 2}')
        (path / ".zattrs").write_text(json.dumps({"multiscales": [image | {"version": "0.4"}]}))
    else:
        (path / "zarr.json").write_text(json.dumps({"zarr_format": 3, "node_type": "group",
                                                    "attributes": {"ome": {"version": "0.5", "multiscales": [image]}}}))
    if max(LENGTHS[unit] * spacing[-3:].max() for spacing, _ in grids) > 1e9:
        with pytest.raises(palpate.InputError, match="outside 1e-9 to 1e9 mm"):
            palpate.open_store(path)
        return
    store = palpate.open_store(path)
    assert len(store.levels) == 2
    for level, (spacing, first) in enumerate(grids):
        geometry = expect_level(store, level, space_of(levels[level], names), dtype)
        assert numpy.allclose(geometry.spacing, LENGTHS[unit] * spacing[::-1][:3], rtol=1e-9, atol=0)
        assert numpy.allclose(geometry.origin, LENGTHS[unit] * first[::-1][:3], rtol=1e-9, atol=0)


# N5 and TIFF --------------------------------------------------------------------------------------------


def n5(dice, folder):
    """Axes are x, y, z, channels and times."""
    axes, unit = dice.one((2, 3, 4, 5)), dice.one(("nm", "um", "mm"))
    shape = [int(dice.randint(1, 9)) for _ in range(min(axes, 3))] + [2] * max(0, axes - 3)
    array = dice.samples(dice.one(TYPES), shape[::-1])
    dtype, block, path = array.dtype.str[1:], [int(dice.randint(1, size + 1)) for size in shape], folder / "a.n5"
    codecs = {"raw": ({}, bytes), "gzip": ({}, gzip.compress), "zlib": ({"type": "gzip", "useZlib": True}, zlib.compress),
              "zstd": ({}, lambda data: bytes(numcodecs.Zstd(1).encode(data)))}
    name = dice.one(codecs)
    stored = numpy.zeros_like(array)
    for number, place in grid_of(shape, block):
        if any(number) and dice.often(0.2):
            continue
        part = array[place[::-1]]
        stored[place[::-1]] = part
        head = struct.pack(f">2H{axes}I", 0, axes, *part.shape[::-1])
        (file := path.joinpath("0", *map(str, number))).parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(head + codecs[name][1](part.astype(">" + dtype).tobytes()))
    kind = {"i": "int", "u": "uint", "f": "float"}[dtype[0]] + str(8 * int(dtype[1:]))
    lengths = [dice.length() for _ in range(axes)]
    place = {"resolution": lengths, "units": [unit] * axes} if dice.often(0.5) else {"pixelResolution": {"dimensions": lengths, "unit": unit}}
    (path / "0/attributes.json").write_text(json.dumps({"dimensions": shape, "blockSize": block, "dataType": kind,
                                                        "compression": {"type": name} | codecs[name][0]} | (place if axes == 3 else {})))
    (path / "attributes.json").write_text('{"n5": "2.0.0"}')
    geometry = expect_level(palpate.open_store(path / "0"), 0, space_of(stored, "tczyx"[-axes:]), dtype)
    if axes == 3:
        assert numpy.allclose(geometry.spacing, numpy.multiply(lengths, {"nm": 1e-6, "um": 1e-3, "mm": 1}[unit]), rtol=1e-9, atol=0)


def tiff(dice, folder):
    """Of OME, ImageJ or tifffile, in strips or tiles. The first channel is read."""
    kind = dice.one(("ome", "imagej", "shaped"))
    dtype = dice.one(("u1", "u2", "f4") if kind == "imagej" else [one for one in TYPES if kind == "shaped" or one[1] != "8"])
    sizes = {"T": dice.one((1, 1, 3)), "Z": dice.randint(2, 5), "C": dice.one((1, 1, 2))}
    data = dice.samples(dtype, (*map(int, sizes.values()), int(dice.randint(1, 50)), int(dice.randint(5, 50))))
    axes = list(dice.permutation(3)) if kind != "imagej" else [0, 1, 2]
    tiled, packed = dice.often(0.4) and kind != "imagej", dice.often(0.5)
    lengths, unit = [dice.length() for _ in range(3)], dice.one({"nm": 1e-6, "mm": 1, "cm": 10} | {"um" if kind == "imagej" else "µm": 1e-3})
    scale = {"nm": 1e-6, "um": 1e-3, "µm": 1e-3, "mm": 1, "cm": 10}[unit] if kind != "shaped" else 1
    metadata = {"axes": "".join("TZC"[axis] for axis in axes) + "YX"}
    if kind == "imagej":
        metadata |= {"spacing": lengths[2], "unit": unit}
    elif kind == "ome":
        metadata |= {f"PhysicalSize{axis}": length for axis, length in zip("XYZ", lengths)} | {f"PhysicalSize{axis}Unit": unit for axis in "XYZ"}
    path = folder / ("a.ome.tif" if kind == "ome" else "a.tif")
    tifffile.imwrite(path, data.transpose(*axes, 3, 4), metadata=metadata, byteorder=dice.one("<>"), photometric="minisblack",
                     bigtiff=dice.often(0.3) and kind != "imagej", compression="zlib" if packed else None,
                     predictor=packed and dice.often(0.5) and dtype[0] != "f" and dtype[1] != "8",
                     **{"imagej": {"imagej": True, "resolution": (1 / lengths[0], 1 / lengths[1])}, "ome": {"ome": True}}.get(kind, {}),
                     **({"tile": (16 * dice.randint(1, 3), 16 * dice.randint(1, 3))} if tiled else {"rowsperstrip": int(dice.randint(1, 50))}))
    if kind == "shaped":
        lengths = [1, 1, 1]
    expect(path, list(data[:, :, 0]), lambda index: scale * numpy.multiply(lengths, index), dtype, False, by_the_box=tiled)


@pytest.mark.parametrize("generate", (zarr_array, ome_zarr, n5, tiff))
def test_random_stores(tmp_path, generate):
    try_seeds(tmp_path, generate, 30)
