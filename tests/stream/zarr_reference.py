#!/usr/bin/env python3
"""Independent reader and writer of Zarr for the tests: python3-zarr for version 2, and numcodecs with
the specification for version 3.

  zarr_reference.py write FOLDER        stores of many kinds, each with its samples in NAME.raw
  zarr_reference.py dump STORE ARRAY    the samples of a Zarr 2 array to standard output
"""

import itertools
import json
import os
import struct
import sys

import numcodecs
import numpy
import zarr

SHAPE = (11, 13, 17)


def samples(dtype, shape=SHAPE, seed=1):
    random = numpy.random.default_rng(seed)
    dtype = numpy.dtype(dtype)
    if dtype.kind == "f":
        return random.normal(0, 1000, shape).astype(dtype)
    limits = numpy.iinfo(dtype)
    return random.integers(limits.min, limits.max, shape, dtype.newbyteorder("="), True).astype(dtype)


def put(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)


def put_json(path, what):
    put(path, json.dumps(what).encode())


def expect(folder, name, data):
    """The samples in the machine's order, z slowest."""
    put(f"{folder}/{name}.raw", numpy.ascontiguousarray(data.astype(data.dtype.newbyteorder("="))).tobytes())


COMPRESSORS = {
    "raw": None,
    "gzip": numcodecs.GZip(5),
    "zlib": numcodecs.Zlib(5),
    "zstd": numcodecs.Zstd(3),
    "lz4": numcodecs.LZ4(),
    "blosc-lz4": numcodecs.Blosc("lz4", 5, numcodecs.Blosc.SHUFFLE),
    "blosc-lz4hc": numcodecs.Blosc("lz4hc", 5, numcodecs.Blosc.NOSHUFFLE),
    "blosc-zstd": numcodecs.Blosc("zstd", 5, numcodecs.Blosc.BITSHUFFLE),
    "blosc-zlib": numcodecs.Blosc("zlib", 5, numcodecs.Blosc.SHUFFLE),
    "blosc-blosclz": numcodecs.Blosc("blosclz", 5, numcodecs.Blosc.SHUFFLE),
}


def write_v2(folder):
    dtypes = ["|u1", "<u2", ">u2", "<i2", ">i2", "<f4", ">f4", "|i1", "<i4", "<u8", ">f8", "|b1"]
    kinds = itertools.cycle(itertools.product("CF", "./"))
    jobs = [(c, d) for c in COMPRESSORS for d in ("|u1", ">u2", "<f4")]
    jobs += [("blosc-zstd", d) for d in dtypes]
    for number, (compressor, dtype) in enumerate(jobs):
        order, separator = next(kinds)
        name = f"v2-{number}-{compressor}.zarr"
        data = samples("u1" if dtype == "|b1" else dtype)
        if dtype == "|b1":
            data = data > 127
        store = zarr.NestedDirectoryStore(f"{folder}/{name}") if separator == "/" else zarr.DirectoryStore(
            f"{folder}/{name}")
        array = zarr.open(store, mode="w", shape=SHAPE, chunks=(4, 5, 6), dtype=dtype, order=order,
                          compressor=COMPRESSORS[compressor], dimension_separator=separator)
        array[...] = data
        expect(folder, name, data.astype("u1") if dtype == "|b1" else data)


def write_missing(folder):
    """Some chunks are not stored: they have the fill value."""
    name = "v2-missing.zarr"
    array = zarr.open(f"{folder}/{name}", mode="w", shape=SHAPE, chunks=(4, 5, 6), dtype="<i2",
                      fill_value=-7)
    array[0:4, 5:10, 0:17] = samples("<i2", (4, 5, 17))
    expect(folder, name, array[...])


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return struct.pack("<I", crc ^ 0xFFFFFFFF)


def encode(data, codecs):
    """A chunk by the codecs of version 3, which are given as their metadata."""
    for codec in codecs:
        name, how = codec["name"], codec.get("configuration", {})
        if name == "transpose":
            data = data.transpose(how["order"])
        elif name == "bytes":
            order = ">" if how.get("endian") == "big" else "<"
            data = numpy.ascontiguousarray(data).astype(data.dtype.newbyteorder(order)).tobytes()
        elif name == "sharding_indexed":
            data = encode_shard(data, how)
        elif name == "gzip":
            data = numcodecs.GZip(how["level"]).encode(data)
        elif name == "zstd":
            data = numcodecs.Zstd(how["level"]).encode(data)
        elif name == "blosc":
            data = numcodecs.Blosc(how["cname"], how["clevel"], 1).encode(
                numpy.frombuffer(data, f"u{how['typesize']}"))
        elif name == "crc32c":
            data += crc32c(data)
        data = bytes(data) if isinstance(data, (bytearray, memoryview)) else data
    return data


def encode_shard(data, how):
    at_start = how.get("index_location") == "start"
    inner = how["chunk_shape"]
    counts = [n // c for n, c in zip(data.shape, inner)]
    checked = any(c["name"] == "crc32c" for c in how["index_codecs"])
    index_bytes = 16 * int(numpy.prod(counts)) + 4 * checked
    body, index = b"", b""
    for number, place in enumerate(itertools.product(*map(range, counts))):
        if number % 5 == 3:  # some are not stored
            index += struct.pack("<QQ", 2**64 - 1, 2**64 - 1)
            continue
        part = data[tuple(slice(p * c, (p + 1) * c) for p, c in zip(place, inner))]
        packed = encode(part, how["codecs"])
        index += struct.pack("<QQ", len(body) + (index_bytes if at_start else 0), len(packed))
        body += packed
    index += crc32c(index) if checked else b""
    return index + body if at_start else body + index


def missing_in_shards(data, shard, inner, fill):
    """What the samples are when every fifth chunk of a shard is left out."""
    data = data.copy()
    counts = [s // i for s, i in zip(shard, inner)]
    for outer in itertools.product(*(range(-(-n // s)) for n, s in zip(data.shape, shard))):
        for number, place in enumerate(itertools.product(*map(range, counts))):
            if number % 5 == 3:
                low = [o * s + p * i for o, s, p, i in zip(outer, shard, place, inner)]
                data[tuple(slice(l, l + i) for l, i in zip(low, inner))] = fill
    return data


def write_v3_array(path, data, chunk, codecs, fill=0, encoding=None, attributes=None):
    encoding = encoding or {"name": "default", "configuration": {"separator": "/"}}
    put_json(f"{path}/zarr.json", {
        "zarr_format": 3, "node_type": "array", "shape": data.shape, "data_type": data.dtype.newbyteorder("=").name,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunk}},
        "chunk_key_encoding": encoding, "fill_value": fill, "codecs": codecs, "attributes": attributes or {}})
    separator = encoding["configuration"]["separator"]
    for place in itertools.product(*(range(-(-n // c)) for n, c in zip(data.shape, chunk))):
        part = numpy.full(chunk, fill, data.dtype)
        inside = data[tuple(slice(p * c, (p + 1) * c) for p, c in zip(place, chunk))]
        part[tuple(slice(0, n) for n in inside.shape)] = inside
        start = ["c"] if encoding["name"] == "default" else []
        put(f"{path}/{separator.join(start + [str(p) for p in place])}", encode(part, codecs))


def write_v3(folder):
    little = {"name": "bytes", "configuration": {"endian": "little"}}
    big = {"name": "bytes", "configuration": {"endian": "big"}}
    gzip = {"name": "gzip", "configuration": {"level": 5}}
    zstd = {"name": "zstd", "configuration": {"level": 3, "checksum": False}}
    turned = {"name": "transpose", "configuration": {"order": [2, 0, 1]}}
    crc = {"name": "crc32c"}

    def blosc(size):
        return {"name": "blosc", "configuration": {"cname": "zstd", "clevel": 5, "shuffle": "shuffle",
                                                   "typesize": size, "blocksize": 0}}

    def shards(codecs, **more):
        return {"name": "sharding_indexed",
                "configuration": {"chunk_shape": [4, 5, 6], "codecs": codecs,
                                  "index_codecs": [little, crc], **more}}

    plain = [("u1", [{"name": "bytes"}]), ("u2", [big, gzip]), ("i2", [turned, little, zstd, crc]),
             ("f4", [little, blosc(4), gzip]), ("f8", [turned, big, blosc(8)]), ("i4", [little, crc, gzip, crc])]
    for number, (dtype, codecs) in enumerate(plain):
        name = f"v3-{number}.zarr"
        data = samples(dtype, seed=number)
        encoding = [None, {"name": "v2", "configuration": {"separator": "."}},
                    {"name": "default", "configuration": {"separator": "."}}][number % 3]
        write_v3_array(f"{folder}/{name}", data, [4, 5, 6], codecs, 0, encoding)
        expect(folder, name, data)
    sharded = [shards([little, zstd]), shards([turned, big, gzip, crc], index_location="start"),
               shards([little], index_codecs=[little])]
    for number, codec in enumerate(sharded):
        name = f"v3-shards-{number}.zarr"
        data = samples("i2", seed=number)
        write_v3_array(f"{folder}/{name}", data, [8, 10, 12], [codec], -3)
        expect(folder, name, missing_in_shards(data, [8, 10, 12], [4, 5, 6], -3))
    name = "v3-shards-turned.zarr"
    codec = shards([turned, big, gzip], chunk_shape=[6, 4, 5])
    write_v3_array(f"{folder}/{name}", data, [8, 10, 12], [turned, codec], -3)
    expect(folder, name, missing_in_shards(data.transpose(2, 0, 1), [12, 8, 10], [6, 4, 5], -3).transpose(1, 2, 0))


def write_ome(folder):
    """Five axes, micrometres, translations, a transformation of the whole, names of channels."""
    name = "ome.zarr"
    group = zarr.open_group(f"{folder}/{name}", mode="w")
    for level, shape in enumerate([(2, 3, 6, 8, 10), (2, 3, 3, 4, 5)]):
        data = samples("<u2", shape, level)
        group.create_dataset(str(level), data=data, chunks=(1, 1, 3, 4, 4), dimension_separator="/")
        for t, c in itertools.product(range(2), range(3)):
            expect(folder, f"ome-{level}-{t}-{c}", data[t, c])
    axes = [{"name": "t", "type": "time", "unit": "millisecond"}, {"name": "c", "type": "channel"}]
    axes += [{"name": n, "type": "space", "unit": "micrometer"} for n in "zyx"]
    group.attrs["multiscales"] = [{
        "version": "0.4", "axes": axes,
        "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 2, 2, 2]},
                                      {"type": "translation", "translation": [0, 0, 10, 20, 30]}],
        "datasets": [{"path": str(level), "coordinateTransformations": [
            {"type": "scale", "scale": [40, 1] + [s * 2**level for s in (3, 2, 1)]},
            {"type": "translation", "translation": [0, 0, 1.5 * level, level, 0.5 * level]}]}
            for level in range(2)]}]
    group.attrs["omero"] = {"channels": [{"label": "nuclei"}, {"label": "membrane"}, {}]}


def run(writers, dump=None):
    """The command line of this script and its siblings."""
    command, *arguments = sys.argv[1:]
    if command == "write":
        os.makedirs(arguments[0], exist_ok=True)
        for write in writers:
            write(arguments[0])
    elif command == "dump":
        sys.stdout.buffer.write(numpy.ascontiguousarray(dump(*arguments)).tobytes())


if __name__ == "__main__":
    run((write_v2, write_missing, write_v3, write_ome), lambda store, array: zarr.open(store, mode="r")[array][...])
