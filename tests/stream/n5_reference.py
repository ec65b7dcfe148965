#!/usr/bin/env python3
"""Independent writer of N5 for the tests, by zarr's N5Store. Features of Java programs that it lacks are
written by the specification: blocks that are cut at the array's end, lz4 of lz4-java, zstd without a size.

  n5_reference.py write FOLDER    stores of many kinds, each with its samples in NAME.raw
"""

import gzip
import itertools
import json
import struct
import warnings

import numcodecs
import numpy
import zarr

from zarr_reference import SHAPE, expect, put, put_json, run, samples

COMPRESSORS = {
    "raw": None,
    "gzip": numcodecs.GZip(5),
    "zlib": numcodecs.Zlib(5),
    "zstd": numcodecs.Zstd(3),
    "lz4": numcodecs.LZ4(),
    "blosc-lz4": numcodecs.Blosc("lz4", 5, numcodecs.Blosc.SHUFFLE),
    "blosc-zstd": numcodecs.Blosc("zstd", 5, numcodecs.Blosc.BITSHUFFLE),
}


def write_by_zarr(folder):
    dtypes = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]
    jobs = [("gzip", d) for d in dtypes] + [(c, d) for c in COMPRESSORS for d in ("u1", "i2", "f4")]
    for number, (compressor, dtype) in enumerate(jobs):
        name = f"n5-{number}-{compressor}-{dtype}.n5"
        data = samples(dtype, seed=number)
        array = zarr.open(zarr.N5Store(f"{folder}/{name}"), mode="w", shape=SHAPE, chunks=(4, 5, 6), dtype=dtype,
                          compressor=COMPRESSORS[compressor])
        array[...] = data
        expect(folder, name, data)


def xxh32(data, seed):
    """https://github.com/Cyan4973/xxHash/blob/dev/doc/xxhash_spec.md"""
    p1, p2, p3, p4, p5 = 2654435761, 2246822519, 3266489917, 668265263, 374761393
    mask = 0xFFFFFFFF

    def rotated(x, bits):
        return (x << bits | x >> (32 - bits)) & mask

    at, lanes = 0, [(seed + p1 + p2) & mask, (seed + p2) & mask, seed, (seed - p1) & mask]
    while at + 16 <= len(data):
        for i, word in enumerate(struct.unpack_from("<4I", data, at)):
            lanes[i] = rotated((lanes[i] + word * p2) & mask, 13) * p1 & mask
        at += 16
    code = sum(map(rotated, lanes, (1, 7, 12, 18))) & mask if len(data) >= 16 else (seed + p5) & mask
    code = (code + len(data)) & mask
    while at + 4 <= len(data):
        code = rotated((code + struct.unpack_from("<I", data, at)[0] * p3) & mask, 17) * p4 & mask
        at += 4
    for byte in data[at:]:
        code = rotated((code + byte * p5) & mask, 11) * p1 & mask
    code = (code ^ code >> 15) * p2 & mask
    code = (code ^ code >> 13) * p3 & mask
    return code ^ code >> 16


def lz4_blocks(data, size=64):
    """As LZ4BlockOutputStream: blocks of `size` bytes; what does not pack is stored plain."""
    out = b""
    for at in range(0, len(data), size):
        part = data[at:at + size]
        packed = bytes(numcodecs.LZ4().encode(part))[4:]
        method = 0x20 if len(packed) < len(part) else 0x10
        packed = packed if method == 0x20 else part
        out += b"LZ4Block" + struct.pack("<BIII", method | 5, len(packed), len(part),
                                         xxh32(part, 0x9747B28C) & 0x0FFFFFFF) + packed
    return out + b"LZ4Block" + struct.pack("<BIII", 0x15, 0, 0, 0)


PACKED = {
    "raw": bytes,
    "gzip": gzip.compress,
    "lz4": lz4_blocks,
    "zstd": lambda data: bytes(numcodecs.Zstd(3).encode(data)),
}


def write_dataset(path, data, blocks, compression, **attributes):
    """As n5-java: blocks at the end are cut; a block of zeros is not stored."""
    put_json(f"{path}/attributes.json", {
        "dimensions": data.shape[::-1], "blockSize": blocks[::-1], "dataType": data.dtype.name,
        "compression": {"type": compression, "level": -1}, **attributes})
    for place in itertools.product(*(range(-(-n // b)) for n, b in zip(data.shape, blocks))):
        part = data[tuple(slice(p * b, (p + 1) * b) for p, b in zip(place, blocks))]
        if not part.any():
            continue
        header = struct.pack(f">HH{part.ndim}I", 0, part.ndim, *part.shape[::-1])
        packed = PACKED[compression](part.astype(part.dtype.newbyteorder(">")).tobytes())
        put("/".join([path, *map(str, place[::-1])]), header + packed)


def write_cut(folder):
    for compression in PACKED:
        for dtype in ("u1", "i2", "f4"):
            name = f"cut-{compression}-{dtype}.n5"
            data = samples(dtype, seed=7)
            data[0:4, 5:10, 6:12] = 0  # a block that is not stored
            data[:, :, 12:] = 3  # packs well
            write_dataset(f"{folder}/{name}", data, (4, 5, 6), compression, n5="2.5.1")
            expect(folder, name, data)
            if compression == "gzip":
                # The independent reader agrees that this is N5.
                assert (zarr.open(zarr.N5Store(f"{folder}/{name}"), mode="r")[...] == data).all()


def write_levels(path, seed, **of_levels):
    """Two levels of 10 x 8 x 6 samples and half as many along x and y; returns them."""
    levels = [samples("u2", (6, 8, 10), seed), samples("u2", (6, 4, 5), seed + 1)]
    for level, data in enumerate(levels):
        attributes = {name: value[level] for name, value in of_levels.items()}
        write_dataset(f"{path}/s{level}", data, (3, 4, 4), "gzip", **attributes)
    return levels


def write_groups(folder):
    factors = [[1, 1, 1], [2, 2, 1]]
    resolution = {"unit": "um", "dimensions": [4, 5, 6]}
    groups = {
        # n5-viewer, with its metadata at the group
        "scales": ({"scales": factors, "pixelResolution": resolution}, {}),
        # n5-spark: at the levels
        "factors": ({}, {"downsamplingFactors": factors, "pixelResolution": [resolution, resolution]}),
        # Neuroglancer
        "units": ({"downsamplingFactors": factors, "resolution": [4, 5, 6], "units": ["um"] * 3}, {}),
        # Janelia: translations of their own
        "transform": ({}, {"transform": [
            {"axes": ["z", "y", "x"], "scale": [6e3, s * 5e3, s * 4e3], "translate": [30, 20, 10 + s],
             "units": ["nm"] * 3} for s in (1, 2)]}),
        "bare": ({}, {}),
    }
    for name, (of_group, of_levels) in groups.items():
        path = f"{folder}/group-{name}.n5"
        for level, data in enumerate(write_levels(path, 20, **of_levels)):
            expect(folder, f"group-{level}", data)
        put_json(f"{path}/attributes.json", {"n5": "2.5.1", **of_group})


def write_bdv(folder):
    """Two setups, three times."""
    path = f"{folder}/bdv.n5"
    put_json(f"{path}/attributes.json", {"n5": "2.0.0"})
    for setup, time in itertools.product(range(2), range(3)):
        put_json(f"{path}/setup{setup}/attributes.json",
                 {"downsamplingFactors": [[1, 1, 1], [2, 2, 1]], "dataType": "uint16"})
        group = f"{path}/setup{setup}/timepoint{time}"
        for level, data in enumerate(write_levels(group, 30 + 10 * setup + 2 * time)):
            expect(folder, f"bdv-{setup}-{time}-{level}", data)
        put_json(f"{group}/attributes.json", {"multiScale": True, "resolution": [0.5, 0.5, 2]})


def write_channels(folder):
    """N5 Viewer: groups c0, c1 without attributes."""
    path = f"{folder}/channels.n5"
    put_json(f"{path}/attributes.json",
             {"scales": [[1, 1, 1], [2, 2, 1]], "pixelResolution": {"unit": "mm", "dimensions": [1, 2, 3]}})
    for channel in range(2):
        expect(folder, f"channels-{channel}", write_levels(f"{path}/c{channel}", 60 + 10 * channel)[0])


def write_axes(folder):
    """Five axes in an order of their own; 4-D without names."""
    data = samples("u1", (3, 2, 4, 5, 6), 80)  # c, t, z, y, x, the slowest first
    write_dataset(f"{folder}/axes.n5", data, (1, 1, 2, 3, 4), "raw", axes=["X", "Y", "Z", "T", "C"])
    expect(folder, "axes", data[2, 1])
    data = samples("u1", (3, 4, 5, 6), 81)
    write_dataset(f"{folder}/four.n5", data, (1, 2, 3, 4), "raw")
    expect(folder, "four", data[1])


warnings.simplefilter("ignore")  # that other programs may not know blosc
run((write_by_zarr, write_cut, write_groups, write_bdv, write_channels, write_axes))
