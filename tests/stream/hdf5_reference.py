#!/usr/bin/env python3
"""Independent writer and reader of HDF5 for the tests: h5py, in the layouts of Imaris and BigDataViewer.

  hdf5_reference.py write FOLDER         files of many kinds, each with its samples in NAME.raw
  hdf5_reference.py dump FILE DATASET    the samples of a dataset to standard output
"""

import itertools
import struct

import h5py
import numcodecs
import numpy

from zarr_reference import SHAPE, expect, put, run, samples


def letters(text):
    """As Imaris stores texts: a list of characters."""
    return numpy.array([c.encode() for c in text], dtype="S1")


def lz4_filter(data, size=100):
    out = struct.pack(">QI", len(data), size)
    for at in range(0, len(data), size):
        part = data[at:at + size]
        packed = bytes(numcodecs.LZ4().encode(part))[4:]
        packed = packed if len(packed) < len(part) else part
        out += struct.pack(">I", len(packed)) + packed
    return out


# Filters that h5py does not have: chunks are packed here.
FOREIGN = {
    "lz4": (32004, lambda data, each: lz4_filter(data)),
    "blosc": (32001, lambda data, each: bytes(
        numcodecs.Blosc("lz4", 5, numcodecs.Blosc.SHUFFLE).encode(numpy.frombuffer(data, f"u{each}")))),
    "zstd": (32015, lambda data, each: bytes(numcodecs.Zstd(3).encode(data))),
}
OWN = {
    "plain": {},
    "gzip": {"compression": "gzip", "compression_opts": 2},
    "shuffled": {"compression": "gzip", "shuffle": True},
    "checked": {"compression": "gzip", "shuffle": True, "fletcher32": True},
    "contiguous": None,
}


def put_dataset(group, name, data, chunk, kind, fill=0):
    """All of `data`; with one of FOREIGN, chunk by chunk."""
    if kind not in FOREIGN:
        how = OWN[kind]
        how = {} if how is None else {"chunks": chunk, "fillvalue": fill, **how}
        return group.create_dataset(name, data=data, **how)
    number, pack = FOREIGN[kind]
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_chunk(chunk)
    properties.set_filter(number, h5py.h5z.FLAG_OPTIONAL)
    made = h5py.h5d.create(group.id, name.encode(), h5py.h5t.py_create(data.dtype),
                           h5py.h5s.create_simple(data.shape), properties)
    for place in itertools.product(*(range(0, n, c) for n, c in zip(data.shape, chunk))):
        part = numpy.zeros(chunk, data.dtype)
        inside = data[tuple(slice(p, p + c) for p, c in zip(place, chunk))]
        part[tuple(slice(0, n) for n in inside.shape)] = inside
        made.write_direct_chunk(place, pack(part.tobytes(), data.dtype.itemsize))
    return made


def put_channel(file, level, time, channel, data, chunk=(4, 5, 6), kind="gzip", fill=0):
    """A channel of Imaris, whose dataset is longer than the image, up to whole chunks."""
    group = file.require_group(f"DataSet/ResolutionLevel {level}/TimePoint {time}/Channel {channel}")
    for axis, size in zip("ZYX", data.shape):
        group.attrs[f"ImageSize{axis}"] = letters(str(size))
    counts, _ = numpy.histogram(data, bins=256, range=(data.min(), data.max()))
    group.attrs["HistogramMin"] = letters(f"{data.min():.3f}")
    group.attrs["HistogramMax"] = letters(f"{data.max():.3f}")
    group.create_dataset("Histogram", data=counts.astype("u8"))
    whole = numpy.full([-(-n // c) * c for n, c in zip(data.shape, chunk)], 99, data.dtype)
    whole[tuple(slice(0, n) for n in data.shape)] = data
    put_dataset(group, "Data", whole, chunk, kind, fill)


def put_extent(file, low=(10, 20, 30), high=(44, 46, 63), unit="um"):
    info = file.require_group("DataSetInfo/Image")
    for axis in range(3):
        info.attrs[f"ExtMin{axis}"] = letters(str(low[axis]))
        info.attrs[f"ExtMax{axis}"] = letters(str(high[axis]))
    if unit:
        info.attrs["Unit"] = letters(unit)


def write_kinds(folder):
    jobs = [(k, d) for k in [*OWN, *FOREIGN] for d in ("u1", "u2", "f4")]
    jobs += [("shuffled", d) for d in ("i1", "i2", "i4", "u4", "i8", "u8", "f8", ">u2", ">f4")]
    for number, (kind, dtype) in enumerate(jobs):
        name = f"ims-{number}-{kind}-{dtype.replace('>', '')}.ims"
        # Half of it packs well; chunks of noise are stored without the filters that do not help.
        data = samples(dtype, seed=number)
        data[:6] = 3
        with h5py.File(f"{folder}/{name}", "w") as file:
            put_channel(file, 0, 0, 0, data, kind=kind)
            put_extent(file)
        expect(folder, name, data)


def write_image(folder):
    """Three levels, two channels, three times."""
    with h5py.File(f"{folder}/image.ims", "w") as file:
        for time, channel in itertools.product(range(3), range(2)):
            for level, shape in enumerate([(6, 9, 40), (6, 4, 20), (3, 2, 10)]):
                data = samples("u2", shape, 100 * time + 10 * channel + level)
                put_channel(file, level, time, channel, data, (1, 3, 2))
                expect(folder, f"image-{level}-{time}-{channel}", data)
        put_extent(file, (0, 10, 20), (20, 19, 32))
        for channel, name in enumerate(("nuclei", "membrane")):
            file.require_group(f"DataSetInfo/Channel {channel}").attrs["Name"] = letters(name)
        times = file.require_group("DataSetInfo/TimeInfo")
        for time in range(3):
            times.attrs[f"TimePoint{time + 1}"] = letters(f"2008-02-29 23:59:{58 + time / 2:06.3f}")


def write_missing(folder):
    """Some chunks are not stored: they have the fill value."""
    with h5py.File(f"{folder}/missing.ims", "w") as file:
        group = file.require_group("DataSet/ResolutionLevel 0/TimePoint 0/Channel 0")
        made = group.create_dataset("Data", SHAPE, "i2", chunks=(4, 5, 6), compression="gzip", fillvalue=-7)
        made[0:4, 5:10, 0:17] = samples("i2", (4, 5, 17))
        put_extent(file, unit="")
        expect(folder, "missing", made[...])


BDV_XML = """<?xml version="1.0" encoding="UTF-8"?>
<SpimData version="0.2"><BasePath type="relative">.</BasePath><SequenceDescription>
<ImageLoader format="bdv.hdf5"><hdf5 type="relative">bdv.h5</hdf5></ImageLoader>
<ViewSetups>
<ViewSetup><id>0</id><name>left</name><size>10 8 6</size>
<voxelSize><unit>\u00b5m</unit><size>0.5 0.25 2.0</size></voxelSize></ViewSetup>
<ViewSetup><id>1</id><size>10 8 6</size><voxelSize><unit>mm</unit><size>1 2 3</size></voxelSize></ViewSetup>
</ViewSetups></SequenceDescription></SpimData>
"""


def write_bdv(folder):
    for name in ("bdv", "lonely"):
        with h5py.File(f"{folder}/{name}.h5", "w") as file:
            for setup in range(2):
                file[f"s{setup:02}/resolutions"] = numpy.array([[1, 1, 1], [2, 2, 1]], "f8")
                file[f"s{setup:02}/subdivisions"] = numpy.array([[4, 4, 3], [4, 4, 3]], "i4")
            for time, setup, level in itertools.product(range(2), range(2), range(2)):
                data = samples("u2", [(6, 8, 10), (6, 4, 5)][level], 100 + 10 * time + 5 * setup + level)
                file.create_dataset(f"t{time:05}/s{setup:02}/{level}/cells", data=data.view("i2"), chunks=(3, 4, 4),
                                    compression="gzip", compression_opts=4)
                expect(folder, f"bdv-{level}-{time}-{setup}", data)
    put(f"{folder}/bdv.xml", BDV_XML.encode())


def write_bdv_missing(folder):
    """Chunks of BigDataViewer that are not stored, whose fill value HDF5 keeps with a sign."""
    kinds = {
        "plain": {"chunks": (4, 5, 6)},
        "gzip": {"chunks": (4, 5, 6), "compression": "gzip"},
        "latest": {"chunks": (4, 5, 6)},
        "typed": {"chunks": (4, 5, 6)},
        "contiguous": {},
    }
    for name, how in kinds.items():
        with h5py.File(f"{folder}/missing-{name}.h5", "w", libver="latest" if name == "latest" else None) as file:
            file["s00/resolutions"] = numpy.array([[1, 1, 1]], "f8")
            if name == "typed":
                file["s00"].attrs["dataType"] = "uint16"
            made = file.create_dataset("t00000/s00/0/cells", SHAPE, "i2", fillvalue=-536, **how)
            if "chunks" in how:
                made[0:4, 5:10, 0:17] = samples("u2", (4, 5, 17)).view("i2")
            expect(folder, f"missing-{name}", made[...].view("u2"))


def write_refused(folder):
    def imaris(name, **options):
        return h5py.File(f"{folder}/refused-{name}.ims", "w", **options)

    data = samples("u1")
    with imaris("userblock", userblock_size=512) as file:
        put_channel(file, 0, 0, 0, data)
        put_extent(file)
    with imaris("other") as file:
        file["image"] = data
    with imaris("filter") as file:
        OWN["lzf"] = {"compression": "lzf"}
        put_channel(file, 0, 0, 0, data, kind="lzf")
        put_extent(file)
    with imaris("bfloat16") as file:
        put_channel(file, 0, 0, 0, data)
        put_extent(file)
        group = file["DataSet/ResolutionLevel 0/TimePoint 0/Channel 0"]
        del group["Data"]
        kind, how = h5py.h5t.IEEE_F16LE.copy(), h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        kind.set_fields(15, 7, 8, 0, 7)
        how.set_chunk((4, 5, 6))
        h5py.h5d.create(group.id, b"Data", kind, h5py.h5s.create_simple(data.shape), how)
    with imaris("extent") as file:
        put_channel(file, 0, 0, 0, data)
    with imaris("backwards") as file:
        put_channel(file, 0, 0, 0, data)
        put_extent(file, high=(5, 5, 5))
    with imaris("long") as file:
        put_channel(file, 0, 0, 0, data)
        put_extent(file)
        file["DataSet/ResolutionLevel 0/TimePoint 0/Channel 0"].attrs["ImageSizeX"] = letters("1000000")
    with imaris("link") as file:
        group = file.require_group("DataSet/ResolutionLevel 0/TimePoint 0/Channel 0")
        group["Data"] = h5py.ExternalLink(f"{folder}/image.ims", "DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data")
        put_extent(file)


run((write_kinds, write_image, write_missing, write_bdv, write_bdv_missing, write_refused), lambda file, dataset: h5py.File(file, "r")[dataset][...])
