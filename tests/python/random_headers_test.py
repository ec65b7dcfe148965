"""Files with random headers: NRRD, MetaImage, NIfTI, MGH, MRC, VTK and VTI. Each generator combines all that its format allows,
and computes the samples and their places from the specification. NIfTI and MGH are also compared with nibabel, VTI with
VTK."""

import gzip
import os
import struct
import zlib

import nibabel
import numpy
import palpate
import pytest
import vtk
from vtk.util import numpy_support

TYPES = ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8")
KEPT = {"i1": "i2", "u1": "u1", "i2": "i2", "u2": "u2"}  # all others become float32


class Dice(numpy.random.RandomState):
    """A source of random choices."""

    def one(self, options):
        options = list(options)
        return options[self.randint(len(options))]

    def often(self, part):
        return self.rand() < part

    def length(self):
        return float(self.one((1, 2, 0.5, 0.25, 3.75, 0.0625, 12, 1000)))

    def sizes(self, count):
        return [int(self.randint(1, 6)) for _ in range(count)]

    def samples(self, dtype, shape):
        """Of the whole range of the type, with what is not finite."""
        kind = numpy.dtype(dtype)
        if kind.kind == "f":
            data = (self.randn(*shape) * 10.0 ** self.randint(-3, 6)).astype(kind)
            if self.often(0.3):
                data.ravel()[self.randint(data.size, size=max(1, data.size // 8))] = self.one((numpy.nan, numpy.inf, -numpy.inf))
                data[..., 0] = 1
            return data
        raw = self.bytes(int(numpy.prod(shape)) * kind.itemsize)
        return numpy.frombuffer(raw, kind).reshape(shape).copy()

    def directions(self):
        """Columns are the axes: along the patient's, or oblique, in any order and handedness."""
        axes = numpy.eye(3)[:, self.permutation(3)] * self.choice([-1, 1], 3)
        if self.often(0.5):
            return axes
        turn = numpy.linalg.qr(self.randn(3, 3))[0]
        return turn @ axes

    def origin(self):
        return numpy.zeros(3) if self.often(0.2) else self.randint(-400, 400, 3) / 4


def try_seeds(folder, generate, count):
    """Writes and reads `count` files, or as many as PALPATE_SEEDS says, from number PALPATE_FIRST_SEED on."""
    first, count = (int(os.environ.get(name, usual)) for name, usual in (("PALPATE_FIRST_SEED", 0), ("PALPATE_SEEDS", count)))
    for seed in range(first, first + count):
        (below := folder / str(seed)).mkdir()
        try:
            generate(Dice(seed), below)
        except (AssertionError, palpate.Error) as error:
            raise AssertionError(f"seed {seed}: {sorted(path.name for path in below.iterdir())}: {error}") from error


def text(numbers):
    return " ".join(repr(float(number)) for number in numbers)


def expect(path, frames, place, dtype, oriented=None, slope=1.0, intercept=0.0, rtol=1e-6, by_the_box=True):
    """`frames`: of samples [z, y, x] as they are stored. `place(index)` is the position in LPS [mm]."""
    for number, stored in enumerate(frames):
        with numpy.errstate(all="ignore"):
            plain = slope == 1 and intercept == 0
            values = stored if plain else stored.astype("f8") * slope + intercept
            values = values.astype(KEPT.get(dtype, "f4") if plain else "f4")
        if values.dtype.kind == "f" and not numpy.isfinite(values).all():
            finite = numpy.isfinite(values)
            values = numpy.where(finite, values, values[finite].min())
        loaded = palpate.load(path, frame=number)
        assert loaded.time_steps == len(frames)
        volumes = [loaded.volume]
        if by_the_box:
            store = palpate.open_store(path, time=number)
            volumes.append(store.read((0, 0, 0), store.levels[0].size))
        for volume in volumes:
            array, geometry = volume.array, volume.geometry
            assert array.shape == values.shape
            assert array.dtype == values.dtype or not plain, (array.dtype, values.dtype)
            assert numpy.allclose(array.astype("f8"), values.astype("f8"), rtol=3e-7, atol=0), (array, values)
            for index in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), [size - 1 for size in geometry.size]):
                index = numpy.minimum(index, numpy.array(geometry.size) - 1)  # no distance is known along an axis of one sample
                found, expected = geometry.physical(index), numpy.array(place(index))
                assert numpy.allclose(found, expected, rtol=rtol, atol=rtol * (1e-12 + abs(expected).max() + max(geometry.spacing)))
            assert oriented is None or geometry.oriented == oriented


def header_lines(dice, lines):
    end = dice.one(("\n", "\r\n"))
    return "".join(line + end for line in lines).encode() + end.encode()


# NRRD -----------------------------------------------------------------------------------------------

NRRD_TYPES = {
    "i1": ("signed char", "int8", "int8_t"), "u1": ("uchar", "unsigned char", "uint8", "uint8_t"),
    "i2": ("short", "short int", "signed short", "signed short int", "int16", "int16_t"),
    "u2": ("ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"),
    "i4": ("int", "signed int", "int32", "int32_t"), "u4": ("uint", "unsigned int", "uint32", "uint32_t"),
    "i8": ("longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"),
    "u8": ("ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"), "f4": ("float",), "f8": ("double",)}
SPACES = {"right-anterior-superior": (-1, -1, 1), "RAS": (-1, -1, 1), "left-anterior-superior": (1, -1, 1), "LAS": (1, -1, 1),
          "left-posterior-superior": (1, 1, 1), "LPS": (1, 1, 1), "right-anterior-superior-time": (-1, -1, 1), "LPST": (1, 1, 1),
          "scanner-xyz": None, "3D-right-handed": None}
LENGTHS = {"": 1, "mm": 1, "um": 1e-3, "m": 1000, "cm": 10}


def nrrd_place(dice, frames, fields):
    """Adds the fields of the grid. Returns the place of an index, and whether it is the patient's. With frames, they are the
    last axis, or a list first."""
    axes = 3 + (frames > 1)
    listed = frames > 1 and dice.often(0.5)  # the first axis
    spacing, origin = [dice.length() for _ in range(3)], dice.origin()

    def all_axes(words, other):
        return words if axes == 3 else [other, *words] if listed else [*words, other]
    if axes == 4:
        fields.append("kinds: " + " ".join(all_axes([dice.one(("domain", "space", "???"))] * 3, "list" if listed else "time")))
    elif dice.often(0.5):
        fields.append("kinds: domain domain domain")
    unit = dice.one(LENGTHS)
    if dice.often(0.6):
        space = dice.one(SPACES)
        four = space.lower().endswith(("time", "t"))
        directions = dice.directions() * spacing
        vectors = ["(" + ",".join([repr(float(n)) for n in column] + ["0"] * four) + ")" for column in directions.T]
        if four and axes == 4 and not listed:
            other = "(0,0,0,2)"
        else:
            other = dice.one(("none", "(nan,nan,nan" + ",nan" * four + ")"))
        fields.append(f"space: {space}")
        fields.append("space directions: " + dice.one((" ", "  ")).join(all_axes(vectors, other)))
        fields.append("space origin: (" + ", ".join([repr(float(n)) for n in origin] + ["0"] * four) + ")")
        if unit:
            fields.append("space units: " + " ".join([f'"{unit}"'] * 3 + ['"s"'] * four))
        to_lps = LENGTHS[unit] * numpy.array(SPACES[space] or (1, 1, 1))
        return listed, lambda index: to_lps * (origin + directions @ index), SPACES[space] is not None
    node, first = dice.one((True, False)), origin
    fields.append("spacings: " + " ".join(all_axes([repr(s) for s in spacing], "nan")))
    if dice.often(0.5):
        fields.append(dice.one(("centers: ", "centerings: ")) + " ".join(all_axes(["node" if node else "cell"] * 3, "???")))
        fields.append(dice.one(("axis mins: ", "axismins: ")) + " ".join(all_axes([repr(float(n)) for n in origin], "NaN")))
        if not node:
            first = origin + numpy.divide(spacing, 2)
    else:
        first = numpy.zeros(3)
    if unit:
        fields.append("units: " + " ".join(all_axes([f'"{unit}"'] * 3, '"s"' if not listed else '""')))
    return listed, lambda index: LENGTHS[unit] * (first + numpy.multiply(spacing, index)), False


def nrrd(dice, folder):
    dtype, sizes = dice.one(TYPES), dice.sizes(3)
    frames = dice.one((1, 1, 2, 3))
    fields = []
    listed, place, oriented = nrrd_place(dice, frames, fields)
    data = dice.samples(dtype, (frames, *sizes[::-1]))
    stored = data if not listed else numpy.moveaxis(data, 0, -1)
    shape = list(stored.shape) if frames > 1 else sizes[::-1]
    order, encoding = dice.one("<>"), dice.one(("raw", "gzip", "gz", "text", "ascii"))
    payload = numpy.ascontiguousarray(stored).astype(order + dtype).tobytes()
    detached = dice.one(("no", "no", "file", "list", "pattern"))
    number = shape[0] if detached in ("list", "pattern") and len(shape) == 3 else 1
    parts = [payload[i * len(payload) // number:(i + 1) * len(payload) // number] for i in range(number)]
    if encoding in ("text", "ascii"):
        separator = dice.one((" ", "\n", ", ", "\r\n", "  \t"))
        numbers = numpy.ascontiguousarray(stored).reshape(number, -1)
        parts = [separator.join(repr(value.item()) for value in part).encode() for part in numbers]
    elif dice.often(0.4):
        skip = dice.one((0, 1, 7, -1)) if encoding == "raw" else dice.one((1, 7))
        fields.append(dice.one(("byte skip", "byteskip")) + f": {skip}")
        parts = [b"\n" * (skip if skip >= 0 else dice.one((0, 3))) + part for part in parts]
    if encoding in ("gzip", "gz"):
        parts = [gzip.compress(part) for part in parts]
    if detached != "no" and dice.often(0.3):
        fields.append("line skip: 2")
        parts = [b"one\r\ntwo\n" + part for part in parts]
    if dice.often(0.3):
        fields.append('content: a "word": and (more)')
    fields += ["# a comment: with a colon", "key:=value: of a key"][:dice.randint(3)]
    dice.shuffle(fields)
    lines = [f"NRRD000{dice.randint(1, 6)}", f"type: {dice.one(NRRD_TYPES[dtype])}", f"dimension: {len(shape)}",
             "sizes: " + " ".join(str(size) for size in shape[::-1]), *fields, f"encoding: {encoding}"]
    if numpy.dtype(dtype).itemsize > 1:
        lines.append("endian: " + ("little" if order == "<" else "big"))
    name = folder / ("a.nrrd" if detached == "no" else "a.nhdr")
    files = [f"part{i + 1:02}.bin" for i in range(number)]
    for file, part in zip(files, parts):
        (folder / file).write_bytes(part)
    word = dice.one(("data file", "datafile"))
    if detached == "no":
        name.write_bytes(header_lines(dice, lines) + b"".join(parts))
    elif detached == "list":
        name.write_bytes(header_lines(dice, [*lines, f"{word}: LIST", *files]))
    else:
        told = files[0] if number == 1 else f"part%02d.bin 1 {number} 1"
        name.write_bytes(header_lines(dice, [*lines, f"{word}: {told}"]))
    expect(name, data, place, dtype, oriented, by_the_box=encoding == "raw" and number == 1 and not listed)


# MetaImage -------------------------------------------------------------------------------------------

META_TYPES = {"i1": ("CHAR",), "u1": ("UCHAR",), "i2": ("SHORT",), "u2": ("USHORT",), "i4": ("INT", "LONG"), "u4": ("UINT", "ULONG"),
              "i8": ("LONG_LONG",), "u8": ("ULONG_LONG",), "f4": ("FLOAT",), "f8": ("DOUBLE",)}


def meta_image(dice, folder):
    dtype, sizes, frames = dice.one(TYPES), dice.sizes(3), dice.one((1, 1, 2, 3))
    axes = 3 + (frames > 1)
    spacing, origin, directions = [dice.length() for _ in range(3)], dice.origin(), dice.directions()
    data = dice.samples(dtype, (frames, *sizes[::-1]))
    order, encoding = dice.one("<>"), dice.one(("raw", "packed", "text"))
    payload = data.astype(order + dtype).tobytes()
    matrix = numpy.eye(axes)
    matrix[:3, :3] = directions.T  # a row for each axis
    four = frames > 1
    unit = dice.one(("", "mm", "um", "m"))
    fields = [dice.one(("ElementSpacing", "ElementSize")) + " = " + text([*spacing, *[1] * four]),
              dice.one(("Offset", "Origin", "Position")) + " = " + text([*origin, *[0] * four]),
              dice.one(("TransformMatrix", "Rotation", "Orientation")) + " = " + text(matrix.ravel()),
              f"CenterOfRotation = {text([5] * axes)}", "Comment = a = b: c", "ElementNumberOfChannels = 1", "ElementMin = 3"]
    fields = fields[:3] + [field for field in fields[3:] if dice.often(0.3)]
    sides = dice.one(("", "???", "RAI", "LPS"))
    if sides:
        fields.append(f"AnatomicalOrientation = {sides}")
    if unit:
        fields.append(f"DistanceUnits = {unit}")
    if order == ">" or dice.often(0.5):
        fields.append(dice.one(("ElementByteOrderMSB", "BinaryDataByteOrderMSB")) + f" = {order == '>'}")
    local, number = dice.often(0.5), 1
    told = dice.one(("a.bin", "LIST", "part%02d.bin 1 {} 1")) if not local else "LOCAL"
    if told[0] in "Lp" and not local and frames == 1:
        number = sizes[2]
    elif not local:
        told = "a.bin"
    parts = [payload[i * len(payload) // number:(i + 1) * len(payload) // number] for i in range(number)]
    if encoding == "text":
        fields.append("BinaryData = False")
        parts = [dice.one((" ", "\n")).join(repr(value.item()) for value in part).encode() for part in data.reshape(number, -1)]
    else:
        fields.append("BinaryData = True")
    if encoding == "packed":
        parts = [zlib.compress(part) for part in parts]
        fields.append("CompressedData = True")
        if number == 1 and dice.often(0.7):
            fields.append(f"CompressedDataSize = {len(parts[0])}")
    elif encoding == "raw" and dice.often(0.3):
        skip = dice.one((-1, 12)) if not local else -1
        fields.append(f"HeaderSize = {skip}")
        parts = [b"h" * (12 if not local else 0) + part for part in parts]
    dice.shuffle(fields)
    lines = ["ObjectType = Image", f"NDims = {axes}", "DimSize = " + " ".join(str(size) for size in [*sizes, *[frames] * four]), *fields,
             f"ElementType = MET_{dice.one(META_TYPES[dtype])}", "ElementDataFile = " + told.format(number)]
    end = dice.one(("\n", "\r\n"))
    if dice.often(0.3):
        lines = [line.replace(" = ", dice.one((" =", "=", "  =  "))) for line in lines]
    files = ["a.bin"] if number == 1 and told == "a.bin" else [f"part{i + 1:02}.bin" for i in range(number)]
    head = "".join(line + end for line in lines).encode()
    if told == "LIST":
        head += "".join(file + end for file in files).encode()
    path = folder / ("a.mha" if local else "a.mhd")
    path.write_bytes(head + (parts[0] if local else b""))
    if not local:
        for file, part in zip(files, parts):
            (folder / file).write_bytes(part)
    scale = LENGTHS[unit]
    turned = not numpy.array_equal(directions, numpy.eye(3))
    expect(path, data, lambda index: scale * (origin + directions @ (numpy.multiply(spacing, index))), dtype,
           turned if not sides else sides != "???", by_the_box=encoding == "raw" and number == 1)


# NIfTI ----------------------------------------------------------------------------------------------

NIFTI_TYPES = {"u1": 2, "i2": 4, "i4": 8, "f4": 16, "f8": 64, "i1": 256, "u2": 512, "u4": 768, "i8": 1024, "u8": 1280}


def quaternion_of(turn):
    """Of a rotation, with its first part at least 0."""
    quaternion = nibabel.quaternions.mat2quat(turn)
    return quaternion if quaternion[0] >= 0 else -quaternion


def nifti(dice, folder):
    second, order = dice.often(0.4), dice.one("<>")
    dtype, sizes, frames = dice.one(NIFTI_TYPES), dice.sizes(3), dice.one((1, 1, 2, 3))
    spacing, origin, directions = [dice.length() for _ in range(3)], dice.origin(), dice.directions()
    data = dice.samples(dtype, (frames, *sizes[::-1]))
    unit = dice.one((0, 1, 2, 3))
    scale = {0: 1, 1: 1000, 2: 1, 3: 1e-3}[unit]
    way = dice.one(("sform", "qform", "both", "none"))
    handed = -1 if numpy.linalg.det(directions) < 0 else 1
    quaternion = quaternion_of(directions * (1, 1, handed))
    sform = numpy.hstack([directions * spacing, origin[:, None]])
    slope, intercept = dice.one(((1, 0), (0, 0), (2, -1000), (0.5, 3.25), (-1, 4), (numpy.nan, numpy.nan), (0, 7), (1, 0)))
    pair, packed = dice.often(0.3), dice.often(0.4)
    head = bytearray(544 if second else 352)
    extra = dice.one((0, 16, 32)) if not pair else 0
    offset = (len(head) + extra) if not pair else dice.one((0, 16))
    dim = [3, *sizes, 1, 1, 1, 1] if frames == 1 else [4, *sizes, frames, 1, 1, 1]
    if frames == 1 and dice.often(0.2):
        dim[0] = dice.one((4, 5, 7))
    elif frames > 1 and dice.often(0.2):
        dim[0] = 5
    pixdim = [handed if dice.often(0.9) or handed < 0 else 0, *spacing, 2, 0, 0, 0]
    if way == "sform" and dice.often(0.3):
        pixdim[0] = -handed  # only the qform has a hand
    forms = (int(way in ("qform", "both")), int(way in ("sform", "both")) * dice.one((1, 2, 4)))
    magic = ("ni" if pair else "n+").encode()
    quaterns = quaternion[1:] if forms[0] else (0, 0, 0)
    places = origin if forms[0] else (0, 0, 0)
    rows = sform.ravel() if forms[1] else numpy.zeros(12)
    bits = 8 * numpy.dtype(dtype).itemsize
    if second:
        struct.pack_into(order + "i8s2h8q", head, 0, 540, magic + b"2\0\r\n\x1a\n", NIFTI_TYPES[dtype], bits, *dim)
        struct.pack_into(order + "8d", head, 104, *pixdim)
        struct.pack_into(order + "q2d", head, 168, offset, slope, intercept)
        struct.pack_into(order + "2i6d12d", head, 344, *forms, *quaterns, *places, *rows)
        struct.pack_into(order + "i", head, 500, unit | 8)
    else:
        struct.pack_into(order + "i", head, 0, 348)
        struct.pack_into(order + "8h", head, 40, *dim)
        struct.pack_into(order + "2h", head, 70, NIFTI_TYPES[dtype], bits)
        struct.pack_into(order + "8f", head, 76, *pixdim)
        struct.pack_into(order + "3f", head, 108, offset, slope, intercept)
        head[123] = unit | 8
        struct.pack_into(order + "2h6f12f", head, 252, *forms, *quaterns, *places, *rows)
        head[344:348] = magic + b"1\0"
    body = data.astype(order + dtype).tobytes()
    extension = b""
    if extra:
        head[-4] = 1
        extension = struct.pack(order + "2i", extra, 6) + b"c" * (extra - 8)
    pack = gzip.compress if packed else bytes
    if pair:
        path = folder / ("a.hdr.gz" if packed else "a.hdr")
        path.write_bytes(pack(bytes(head)))
        (folder / path.name.replace("hdr", "img")).write_bytes(pack(bytes(offset) + body))
        path = dice.one((path, folder / path.name.replace("hdr", "img")))
    else:
        path = folder / ("a.nii.gz" if packed else "a.nii")
        path.write_bytes(pack(bytes(head) + extension + body))
    if way == "none":
        place = lambda index: scale * numpy.multiply(spacing, index)
    else:
        place = lambda index: scale * numpy.array((-1, -1, 1)) * (origin + directions @ numpy.multiply(spacing, index))
        image = nibabel.load(path)
        index = numpy.array(sizes) - 1
        assert numpy.allclose(scale * (image.affine @ (*index, 1))[:3] * (-1, -1, 1), place(index), rtol=3e-3, atol=scale * 10)
        values = numpy.asanyarray(image.dataobj).reshape(data.T.shape)
        effective = (slope, intercept) if slope and slope == slope else (1, 0)
        assert numpy.allclose(values.T.astype("f8"), data.astype("f8") * effective[0] + effective[1], rtol=1e-6, equal_nan=True)
    if not slope or slope != slope:
        slope, intercept = 1, 0
    # A quaternion without its first number is exact to the square root of a float's rounding.
    rtol = 3e-3 if way == "qform" and not second else 1e-5
    expect(path, data, place, dtype, way != "none", slope, intercept, rtol=rtol, by_the_box=not packed)


# MGH and MRC -------------------------------------------------------------------------------------------


def mgh(dice, folder):
    dtype = dice.one(("u1", "i4", "f4", "i2"))
    sizes, frames = dice.sizes(3), dice.one((1, 2))
    data = dice.samples(dtype, (frames, *sizes[::-1]))
    affine = numpy.eye(4)
    affine[:3, :3], affine[:3, 3] = dice.directions() * [dice.length() for _ in range(3)], dice.origin()
    path = folder / dice.one(("a.mgh", "a.mgz"))
    image = nibabel.MGHImage(data.T if frames > 1 else data[0].T, affine)
    image.to_filename(path)
    place = lambda index: numpy.array((-1, -1, 1)) * (image.affine @ (*index, 1))[:3]
    expect(path, data, place, dtype, True, rtol=1e-4, by_the_box=path.suffix == ".mgh")


def mrc(dice, folder):
    dtype, mode = dice.one((("i1", 0), ("i2", 1), ("f4", 2), ("u2", 6)))
    sizes, frames, order = dice.sizes(3), dice.one((1, 2)), dice.one("<>")
    data = dice.samples(dtype, (frames, *sizes[::-1]))
    axes = dice.permutation(3)  # of columns, rows, sections
    spacing = numpy.array([dice.length() for _ in range(3)])
    samples = numpy.empty(3, int)
    samples[axes] = sizes
    if dice.often(0.3) and frames == 1:
        samples *= 2
    origin = dice.one((numpy.zeros(3), dice.randint(-100, 100, 3).astype(float)))
    start = dice.randint(-9, 9, 3)
    if frames > 1:
        axes, samples = numpy.arange(3), numpy.array(sizes)
    head = bytearray(1024)
    extended = dice.one((0, 80, 1024))
    struct.pack_into(order + "10i3f3f3i3f2i", head, 0, *sizes[:2], sizes[2] * frames, mode, *start, *samples, *(samples * spacing),
                     *dice.one(((90, 90, 90), (0, 0, 0))), *(axes + 1), 0, 100, 0, 401 if frames > 1 else dice.one((0, 1)), extended)
    struct.pack_into(order + "3f", head, 196, *origin)
    head[208:212] = b"MAP "
    head[212:214] = b"\x44\x44" if order == "<" else b"\x11\x11"
    pack = dice.one((bytes, gzip.compress))
    path = folder / (dice.one(("a.mrc", "a.map", "a.rec", "a.ccp4")) + (".gz" if pack is not bytes else ""))
    path.write_bytes(pack(bytes(head) + bytes(extended) + data.astype(order + dtype).tobytes()))

    def place(index):
        at = numpy.zeros(3)
        at[axes] = numpy.array(index) * spacing[axes] + (0 if origin.any() else start * spacing[axes])
        return 1e-7 * (at + origin)
    expect(path, data, place, dtype, False, rtol=1e-5, by_the_box=pack is bytes)


# VTK and VTI --------------------------------------------------------------------------------------------


def vtk_file(dice, folder, xml):
    dtype, sizes, cells = dice.one(("i1", "i2", "u2", "i4", "u4", "i8", "f4", "f8")), dice.sizes(3), dice.often(0.3)
    data = dice.samples(dtype, sizes[::-1])
    as_text = dice.often(0.4)
    if as_text and data.dtype.kind == "f":
        data = dice.randint(-1000, 1000, data.shape).astype(dtype) / 4
    elif as_text:
        data %= 1000  # VTK writes six digits of floats
    spacing, origin = [dice.length() for _ in range(3)], dice.origin()
    directions = dice.directions() if xml else numpy.eye(3)
    extent = [int(dice.randint(-3, 4)) for _ in range(3)] if xml else [0, 0, 0]
    image = vtk.vtkImageData()
    image.SetExtent(*(number for first, size in zip(extent, sizes) for number in (first, first + size - 1 + cells)))
    image.SetSpacing(spacing)
    image.SetOrigin(origin)
    image.SetDirectionMatrix(directions.ravel())
    holder = image.GetCellData() if cells else image.GetPointData()
    arrays = {"first": data}
    if dice.often(0.4):
        arrays["second"] = data.astype("f4")
    active = dice.one(arrays)
    for name, samples in arrays.items():
        array = numpy_support.numpy_to_vtk(samples.ravel(), deep=True)
        array.SetName(name)
        holder.AddArray(array)
    holder.SetActiveScalars(active)
    if dice.often(0.3):
        numbers = numpy_support.numpy_to_vtk(numpy.arange(4.0), deep=True)
        numbers.SetName("numbers of the whole")
        image.GetFieldData().AddArray(numbers)
    path = folder / ("a.vti" if xml else "a.vtk")
    writer = vtk.vtkXMLImageDataWriter() if xml else vtk.vtkStructuredPointsWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(image)
    if not xml:
        writer.SetFileType(vtk.VTK_ASCII if as_text else vtk.VTK_BINARY)
    elif as_text:
        writer.SetDataModeToAscii()
    else:
        dice.one((writer.SetDataModeToAppended, writer.SetDataModeToBinary))()
        (writer.EncodeAppendedDataOn if dice.often(0.5) else writer.EncodeAppendedDataOff)()
        dice.one((writer.SetByteOrderToBigEndian, writer.SetByteOrderToLittleEndian))()
        dice.one((writer.SetHeaderTypeToUInt32, writer.SetHeaderTypeToUInt64))()
        writer.SetCompressorType(dice.randint(0, 4))
        writer.SetBlockSize(dice.one((1024, 32768)))
    assert writer.Write() == 1
    half = 0.5 if cells else 0
    place = lambda index: origin + directions @ (spacing * (numpy.array(index) + extent + half))
    expect(path, [arrays[active]], place, "f4" if active == "second" else dtype, False, by_the_box=not as_text and not xml)


def vtk_legacy(dice, folder):
    vtk_file(dice, folder, False)


def vti(dice, folder):
    vtk_file(dice, folder, True)


@pytest.mark.parametrize("generate", (nrrd, meta_image, nifti, mgh, mrc, vtk_legacy, vti))
def test_random_headers(tmp_path, generate):
    try_seeds(tmp_path, generate, 40)
