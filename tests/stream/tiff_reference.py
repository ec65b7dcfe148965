#!/usr/bin/env python3
"""Independent writer of tiled TIFF for the tests: python3-tifffile, with OME-XML of its own making.

  tiff_reference.py write FOLDER    files of many kinds, each with its samples in NAME.raw
"""

import itertools
import zlib

import numcodecs
import numpy
import tifffile

from zarr_reference import expect, run, samples

TILE = (16, 32)
SHAPE = (3, 45, 70)


def lzw(data):
    """Section 13 of the TIFF specification, as it is told there."""
    bits, count, out = 0, 0, bytearray()
    table = width = None

    def put(code):
        nonlocal bits, count
        bits, count = bits << width | code, count + width
        while count >= 8:
            count -= 8
            out.append(bits >> count & 255)
        bits &= (1 << count) - 1

    def restart():
        nonlocal table, width
        table, width = {bytes([i]): i for i in range(256)}, 9

    restart()
    put(256)
    last, next_code = b"", 258
    for i in range(len(data)):
        one = data[i:i + 1]
        if last + one in table:
            last += one
            continue
        put(table[last])
        table[last + one] = next_code
        next_code += 1
        if next_code == 4095:
            put(256)
            restart()
            next_code = 258
        elif next_code == 1 << width:
            width += 1
        last = one
    if last:
        put(table[last])
        # The reader makes an entry of that code, too.
        if next_code + 1 == 1 << width and width < 12:
            width += 1
    put(257)
    if count:
        width = 8 - count
        put(0)
    return bytes(out)


# It asks for packages that pack, although it is given what is packed.
for packer in ("lzw_encode", "zstd_encode", "floatpred_encode"):
    setattr(tifffile.tifffile.imagecodecs, packer, lambda data, *_, **__: data)
PACK = {None: None, "zlib": zlib.compress, "lzw": lzw, "zstd": lambda data: bytes(numcodecs.Zstd(3).encode(data))}


def differences(part, order):
    """Along rows, in the file's byte order; of real numbers, of their bytes, the highest of all first."""
    if part.dtype.kind == "f":
        places = part.astype(part.dtype.newbyteorder(">")).view("u1").reshape(*part.shape, part.itemsize)
        part, order = places.swapaxes(1, 2).reshape(len(part), -1), "|"
    whole = part.view(f"u{part.itemsize}")
    rows = whole.copy()
    rows[:, 1:] = whole[:, 1:] - whole[:, :-1]
    return rows.astype(rows.dtype.newbyteorder(order))


def tiles(data, order, pack, predictor):
    """The packed tiles of all planes; those at the border are filled up with zeros."""
    for plane in data:
        for y, x in itertools.product(*(range(0, n, t) for n, t in zip(plane.shape, TILE))):
            part = numpy.zeros(TILE, data.dtype)
            inside = plane[y:y + TILE[0], x:x + TILE[1]]
            part[:inside.shape[0], :inside.shape[1]] = inside
            part = differences(part, order) if predictor else part.astype(part.dtype.newbyteorder(order))
            yield pack(part.tobytes())


def write_kinds(folder):
    kinds = itertools.product("<>", PACK, (False, True), ("u1", "u2", "i2", "f4"))
    for number, (order, compression, predictor, dtype) in enumerate(kinds):
        if predictor and compression is None:
            continue
        name = f"kind-{number}-{dtype}.tif"
        data = samples(dtype, SHAPE, number)
        data[:, :, 30:] = numpy.linspace(0, 100, 40).astype(dtype)
        with tifffile.TiffWriter(f"{folder}/{name}", bigtiff=number % 3 == 0, byteorder=order) as tiff:
            how = {"tile": TILE, "photometric": "minisblack", "metadata": None}
            if compression is None:
                tiff.write(data, **how)
            else:
                tiff.write(tiles(data, order, PACK[compression], predictor), shape=data.shape, dtype=data.dtype,
                           compression=compression, predictor=(3 if dtype == "f4" else 2) if predictor else None, **how)
        expect(folder, name, data)


def coarser(data, level):
    return data[..., ::2**level, ::2**level].copy()


def write_ome(folder):
    """Two channels, three times, four planes, three levels, in two orders of the planes."""
    for order in ("TCZYX", "TZCYX"):
        shape = (3, 2, 4, 50, 70)
        data = samples("u2", shape, 7)
        planes = data if order == "TCZYX" else data.swapaxes(1, 2)
        metadata = {"axes": order, "Channel": {"Name": ["nuclei", "membrane"]}, "PhysicalSizeX": 0.5,
                    "PhysicalSizeXUnit": "\u00b5m", "PhysicalSizeY": 250, "PhysicalSizeYUnit": "nm", "PhysicalSizeZ": 2,
                    "PhysicalSizeZUnit": "\u00b5m", "TimeIncrement": 100, "TimeIncrementUnit": "ms"}
        name = f"pyramid-{order}.ome.tif"
        with tifffile.TiffWriter(f"{folder}/{name}", bigtiff=True) as tiff:
            how = {"tile": TILE, "photometric": "minisblack", "compression": "zlib"}
            tiff.write(planes, subifds=2, metadata=metadata, **how)
            for level in (1, 2):
                tiff.write(coarser(planes, level), subfiletype=1, **how)
        for t, c, level in itertools.product(range(3), range(2), range(3)):
            expect(folder, f"{name}-{level}-{t}-{c}", coarser(data[t, c], level))


def write_others(folder):
    """A pyramid of pages; ImageJ's stack in tiles; sparse tiles; what is refused."""
    data = samples("u1", (1, 60, 90), 8)
    with tifffile.TiffWriter(f"{folder}/pages.tif") as tiff:
        for level in range(3):
            tiff.write(coarser(data, level)[0], tile=TILE, subfiletype=1 if level else 0, metadata=None)
            expect(folder, f"pages-{level}", coarser(data, level))
    stack = samples("u2", SHAPE, 9)
    with tifffile.TiffWriter(f"{folder}/pyramid.tif") as tiff:
        tiff.write(stack, tile=TILE, subifds=1, photometric="minisblack", metadata=None)
        tiff.write(coarser(stack, 1), tile=TILE, subfiletype=1, photometric="minisblack", metadata=None)
    expect(folder, "pyramid", stack)
    with tifffile.TiffWriter(f"{folder}/refused-colours.tif") as tiff:
        tiff.write(samples("u1", (48, 64, 3)), tile=TILE, photometric="rgb", subifds=1)
        tiff.write(samples("u1", (24, 32, 3)), tile=TILE, photometric="rgb", subfiletype=1)
    for name, change in {
            "order": (b'DimensionOrder="XY', b'DimensionOrder="YX'),
            "planes": (b'SizeT="3"', b'SizeT="4"'),
            "size": (b'SizeC="2"', b'SizeC="0"'),
            "xml": (b"</Image>", b"</Imagf>")}.items():
        with open(f"{folder}/pyramid-TCZYX.ome.tif", "rb") as file:
            good = file.read()
        with open(f"{folder}/refused-{name}.ome.tif", "wb") as file:
            file.write(good.replace(*change))
    xml = ('<OME xmlns="x"><Image><Pixels DimensionOrder="XYZCT" SizeZ="2">'
           '<TiffData IFD="0"><UUID FileName="a.tif">a</UUID></TiffData>'
           '<TiffData IFD="1" FirstZ="1"><UUID FileName="b.tif">b</UUID></TiffData></Pixels></Image></OME>')
    with tifffile.TiffWriter(f"{folder}/refused-files.ome.tif") as tiff:
        tiff.write(stack[:2], tile=TILE, subifds=1, description=xml, photometric="minisblack", metadata=None)
        tiff.write(coarser(stack[:2], 1), tile=TILE, subfiletype=1, photometric="minisblack", metadata=None)


run((write_kinds, write_ome, write_others))
