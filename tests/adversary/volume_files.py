"""Writes small volumes in the formats that the program reads, from their specifications. A file is a list
of named parts (header, samples, checksum ...), so that damage can be done to one part and the others be
made to agree with it again."""

import struct
import zlib

TYPES = {"uint8": ("B", 1), "int16": ("h", 2), "uint16": ("H", 2), "float32": ("f", 4)}


def packed(values, kind, order="<"):
    code, _ = TYPES[kind]
    whole = kind != "float32"
    return struct.pack(f"{order}{len(values)}{code}", *(int(v) if whole else v for v in values))


def gzipped(data, level=6):
    """A gzip member with a right checksum and length."""
    packer = zlib.compressobj(level, zlib.DEFLATED, 31)
    return packer.compress(data) + packer.flush()


def nrrd(grid, kind="float32", compressed=False, fields=None):
    """`fields` replace or add header fields; None leaves one out."""
    nx, ny, nz = grid.size
    columns = [tuple(grid.axes[a][c] * grid.spacing[a] for c in range(3)) for a in range(3)]
    vector = lambda v: "(" + ",".join(repr(float(x)) for x in v) + ")"
    header = {
        "type": {"float32": "float"}.get(kind, kind), "dimension": "3",
        "space": "left-posterior-superior", "sizes": f"{nx} {ny} {nz}",
        "space directions": " ".join(vector(c) for c in columns),
        "space origin": vector(grid.origin), "endian": "little",
        "encoding": "gzip" if compressed else "raw"}
    header.update(fields or {})
    text = "NRRD0004\n" + "".join(f"{k}: {v}\n" for k, v in header.items() if v is not None) + "\n"
    data = packed(grid.samples, kind)
    return text.encode() + (gzipped(data) if compressed else data)


def meta(grid, kind="float32", compressed=False, fields=None):
    nx, ny, nz = grid.size
    data = packed(grid.samples, kind)
    data = zlib.compress(data) if compressed else data
    header = {
        "ObjectType": "Image", "NDims": "3", "BinaryData": "True", "BinaryDataByteOrderMSB": "False",
        "CompressedData": str(compressed),
        "TransformMatrix": " ".join(repr(float(x)) for axis in grid.axes for x in axis),
        "Offset": " ".join(repr(float(x)) for x in grid.origin),
        "ElementSpacing": " ".join(repr(float(x)) for x in grid.spacing),
        "DimSize": f"{nx} {ny} {nz}",
        "ElementType": {"uint8": "MET_UCHAR", "int16": "MET_SHORT", "uint16": "MET_USHORT",
                        "float32": "MET_FLOAT"}[kind]}
    if compressed:
        header["CompressedDataSize"] = str(len(data))
    header.update(fields or {})
    text = "".join(f"{k} = {v}\n" for k, v in header.items() if v is not None)
    return text.encode() + b"ElementDataFile = LOCAL\n" + data


NIFTI_TYPES = {"uint8": (2, 8), "int16": (4, 16), "float32": (16, 32), "uint16": (512, 16)}


def nifti(grid, kind="float32", compressed=False, numbers=None):
    """`numbers`: {(offset, struct format): value} put over the header."""
    code, bits = NIFTI_TYPES[kind]
    head = bytearray(352)
    put = lambda at, form, *values: struct.pack_into("<" + form, head, at, *values)
    put(0, "i", 348)
    put(40, "8h", 3, *grid.size, 1, 1, 1, 1)
    put(70, "hh", code, bits)
    put(76, "8f", 1, *grid.spacing, 0, 0, 0, 0)
    put(108, "f", 352)
    put(123, "B", 2)  # mm
    put(252, "hh", 0, 1)
    for row in range(3):  # sform, RAS
        sign = -1 if row < 2 else 1
        put(280 + 16 * row, "4f", *(sign * grid.axes[a][row] * grid.spacing[a] for a in range(3)),
            sign * grid.origin[row])
    put(344, "4s", b"n+1\0")
    for (at, form), value in (numbers or {}).items():
        put(at, form, value)
    data = bytes(head) + packed(grid.samples, kind)
    return gzipped(data) if compressed else data


def tiff(grid, kind="uint8", tags=None):
    """One page a slice, uncompressed strips, little-endian. `tags`: {tag: value} put over each page's."""
    nx, ny, nz = grid.size
    size = TYPES[kind][1]
    out = bytearray(b"II*\0\0\0\0\0")
    link = 4
    for k in range(nz):
        data = packed(grid.samples[k * nx * ny:(k + 1) * nx * ny], kind)
        strip = len(out)
        out += data + b"\0" * (len(data) % 2)
        entries = {256: nx, 257: ny, 258: 8 * size, 259: 1, 262: 1, 273: strip, 277: 1, 278: ny,
                   279: len(data), 339: {"float32": 3, "int16": 2}.get(kind, 1)}
        entries.update(tags or {})
        struct.pack_into("<I", out, link, len(out))
        out += struct.pack("<H", len(entries))
        for tag in sorted(entries):
            out += struct.pack("<HHII", tag, 4, 1, entries[tag] & 0xFFFFFFFF)
        link = len(out)
        out += b"\0\0\0\0"
    return bytes(out)


def vti(grid, kind="float32", attributes=None):
    """Appended raw data. `attributes` replace those of ImageData."""
    nx, ny, nz = grid.size
    name = {"uint8": "UInt8", "int16": "Int16", "uint16": "UInt16", "float32": "Float32"}[kind]
    extent = f"0 {nx - 1} 0 {ny - 1} 0 {nz - 1}"
    image = {"WholeExtent": extent, "Origin": " ".join(map(repr, map(float, grid.origin))),
             "Spacing": " ".join(map(repr, map(float, grid.spacing))),
             "Direction": " ".join(repr(float(grid.axes[a][c])) for c in range(3) for a in range(3))}
    image.update(attributes or {})
    words = " ".join(f'{k}="{v}"' for k, v in image.items())
    data = packed(grid.samples, kind)
    return (f'<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt32">'
            f'<ImageData {words}><Piece Extent="{extent}"><PointData Scalars="s">'
            f'<DataArray type="{name}" Name="s" format="appended" offset="0"/></PointData></Piece>'
            f'</ImageData><AppendedData encoding="raw">_').encode() + struct.pack("<I", len(data)) + \
        data + b"</AppendedData></VTKFile>"


EXPLICIT, DEFLATED = "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.1.99"
JPEG2000, JPEG_LS, RLE = "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.5"


def element(tag, kind, value):
    """One data element, explicit VR, little-endian. `tag` is (group, element)."""
    if isinstance(value, str):
        value = value.encode()
    if len(value) % 2:
        value += b"\0" if kind in ("UI", "OB", "OW") else b" "
    if kind in ("OB", "OW", "SQ", "UN", "UT"):
        return struct.pack("<HH2sHI", *tag, kind.encode(), 0, len(value)) + value
    return struct.pack("<HH2sH", *tag, kind.encode(), len(value)) + value


def encapsulated(streams):
    """Pixel data as fragments: an empty offset table, then one fragment each."""
    item = lambda data: struct.pack("<HHI", 0xFFFE, 0xE000, len(data)) + data
    return struct.pack("<HH2sHI", 0x7FE0, 0x0010, b"OB", 0, 0xFFFFFFFF) + item(b"") + \
        b"".join(item(s + b"\0" * (len(s) % 2)) for s in streams) + struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)


def dicom_slice(rows, columns, samples, number=1, z=0.0, series="1.2.3.4", syntax=EXPLICIT, tags=None,
                pixels=None):
    """A CT slice of int16 samples. `tags`: {tag: (VR, value)} put over the data set; value None leaves one
    out. `pixels`: the whole pixel data element, for encapsulated streams."""
    short = lambda v: struct.pack("<H", v & 0xFFFF)
    data = {
        (0x0008, 0x0016): ("UI", "1.2.840.10008.5.1.4.1.1.2"),
        (0x0008, 0x0018): ("UI", f"{series}.{number}"), (0x0008, 0x0060): ("CS", "CT"),
        (0x0020, 0x000D): ("UI", "1.2.3"), (0x0020, 0x000E): ("UI", series),
        (0x0020, 0x0013): ("IS", str(number)),
        (0x0020, 0x0032): ("DS", f"0\\0\\{z}"), (0x0020, 0x0037): ("DS", "1\\0\\0\\0\\1\\0"),
        (0x0028, 0x0002): ("US", short(1)), (0x0028, 0x0004): ("CS", "MONOCHROME2"),
        (0x0028, 0x0010): ("US", short(rows)), (0x0028, 0x0011): ("US", short(columns)),
        (0x0028, 0x0030): ("DS", "1\\1"), (0x0028, 0x0100): ("US", short(16)),
        (0x0028, 0x0101): ("US", short(16)), (0x0028, 0x0102): ("US", short(15)),
        (0x0028, 0x0103): ("US", short(1)), (0x0028, 0x1052): ("DS", "-1024"),
        (0x0028, 0x1053): ("DS", "1")}
    data.update(tags or {})
    body = b"".join(element(tag, *data[tag]) for tag in sorted(data) if data[tag][1] is not None)
    body += pixels if pixels is not None else element((0x7FE0, 0x0010), "OW", packed(samples, "int16"))
    if syntax == DEFLATED:
        packer = zlib.compressobj(6, zlib.DEFLATED, -15)
        body = packer.compress(body) + packer.flush()
        body += b"\0" * (len(body) % 2)
    meta_ = element((2, 2), "UI", "1.2.840.10008.5.1.4.1.1.2") + element((2, 3), "UI", f"{series}.{number}") \
        + element((2, 0x10), "UI", syntax)
    return b"\0" * 128 + b"DICM" + element((2, 0), "UL", struct.pack("<I", len(meta_))) + meta_ + body


def jpeg2000_head(width, height, components=1, bits=16):
    """Start and size markers of a JPEG 2000 code stream, without a picture behind them."""
    size = struct.pack(">HIIIIIIIIH", 0, width, height, 0, 0, width, height, 0, 0, components)
    size += bytes((bits - 1 | 0x80, 1, 1)) * components
    return b"\xFF\x4F\xFF\x51" + struct.pack(">H", len(size) + 2) + size + b"\xFF\xD9"


WRITERS = {".nrrd": nrrd, ".mha": meta, ".nii": nifti, ".vti": vti, ".tif": tiff}
