"""Small files that say they are large: each is refused in a line with its name, and neither the program nor a helper process takes much
memory for it."""

import base64
import gzip
import json
import os
import struct
import subprocess
import sys
import zlib

import pytest

PROGRAM = os.environ["PALPATE"]
MEGABYTE = 1_000_000
# Prints the exit status, the last line on standard error, and the most memory that one process had: the program's or a helper's.
MEASURE = """
import json, resource, subprocess, sys
done = subprocess.run(sys.argv[1:], capture_output=True, text=True)
print(json.dumps([done.returncode, done.stderr.strip().splitlines()[-1:], resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024]))
"""


def measured(folder, *words):
    done = subprocess.run([sys.executable, "-c", MEASURE, PROGRAM, *words], cwd=folder, capture_output=True, text=True, check=True)
    status, lines, most = json.loads(done.stdout)
    return status, "".join(lines), most


def vtk_zlib(count):
    """Zeros, as VTK's XML files keep compressed arrays."""
    block = 1 << 20
    blocks, one = -(-count // block), zlib.compress(bytes(block), 9)
    head = struct.pack(f"<{3 + blocks}I", blocks, block, 0, *[len(one)] * blocks)
    return (base64.b64encode(head) + base64.b64encode(one * blocks)).decode()


def vtp(points):
    def array(name, kind, count):
        return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{3 if name == "p" else 1}" format="binary">{vtk_zlib(count)}</DataArray>'
    return ('<?xml version="1.0"?><VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" compressor="vtkZLibDataCompressor">'
            f'<PolyData><Piece NumberOfPoints="{points}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{points // 3}">'
            f'<Points>{array("p", "Float32", 12 * points)}</Points><Polys>{array("connectivity", "Int32", 4 * points)}'
            f'{array("offsets", "Int32", 4 * (points // 3))}</Polys></Piece></PolyData></VTKFile>').encode()


def expanding(tag):
    """Entities that stand for each other, 10^11 times three letters."""
    entities = "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10 if i else "lol"}">' for i in range(12))
    return f'<?xml version="1.0"?><!DOCTYPE l [{entities}]><VTKFile type="{tag}"><{tag}>&a11;</{tag}></VTKFile>'.encode()


PLY = ("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
       "element face {}\nproperty list uint uint vertex_indices\nend_header\n")
TOOLS = {
    "points.vtp": lambda: vtp(30_000_000), "entities.vtp": lambda: expanding("PolyData"),
    "count.stl": lambda: bytes(80) + struct.pack("<I", 0xffffffff) + bytes(50),
    "count.ply": lambda: PLY.format(4_000_000_000, 4_000_000_000).encode() + bytes(1000),
    "list.ply": lambda: PLY.format(3, 1).encode() + bytes(36) + struct.pack("<I", 0xfffffff0) + bytes(100),
}

GZIP = gzip.compress(bytes(1 << 20), 9) * 1000  # of a gigabyte


def tiff(width, height, data):
    tags = [(256, width), (257, height), (258, 8), (259, 8), (262, 1), (273, 8), (277, 1), (278, height), (279, len(data))]
    data += bytes(len(data) % 2)
    return (b"II*\0" + struct.pack("<I", 8 + len(data)) + data + struct.pack("<H", len(tags))
            + b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags) + bytes(4))


def mgz(rest):
    head = struct.pack(">7ih15f", 1, 4, 4, 4, 1, 0, 0, 1, 1, 1, 1, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0).ljust(284, b"\0")
    return gzip.compress(head + bytes(64) + struct.pack(">4f", 1, 1, 1, 1)) + rest


def deep_dicom(depth):
    syntax = b"1.2.840.10008.1.2.1\0"
    item = struct.pack("<HH2sHI", 8, 0x1140, b"SQ", 0, 0xffffffff) + struct.pack("<HHI", 0xfffe, 0xe000, 0xffffffff)
    return bytes(128) + b"DICM" + struct.pack("<HH2sHI", 2, 0, b"UL", 4, 8 + len(syntax)) + struct.pack(
        "<HH2sH", 2, 0x10, b"UI", len(syntax)) + syntax + item * depth


VOLUMES = {
    "samples.nrrd": lambda: b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 10 10 10\nencoding: gzip\n\n" + GZIP,
    "samples.mha": lambda: b"ObjectType = Image\nNDims = 3\nDimSize = 9 9 9\nElementType = MET_UCHAR\nCompressedData = True\n"
                           b"ElementDataFile = LOCAL\n" + zlib.compress(bytes(500_000_000), 9),
    "tags.mgz": lambda: mgz(gzip.compress(struct.pack(">iq", 3, 0x7ffffff0)) + GZIP),
    "strip.tif": lambda: tiff(4, 4, zlib.compress(bytes(500_000_000), 9)),
    "entities.vti": lambda: expanding("ImageData"),
    "deep.dcm": lambda: deep_dicom(45_000),
}


@pytest.mark.parametrize("name", TOOLS)
def test_a_tool_costs_no_more_than_the_program_may_use(tmp_path, name):
    (tmp_path / name).write_bytes(TOOLS[name]())
    subprocess.run([PROGRAM, "convert", "-q", "synthetic:sphere:64x64x64", tmp_path / "ball.zarr"], check=True)
    status, line, most = measured(tmp_path, "touch", "ball.zarr", "--tool", name, "--memory", "256M", "--unpaced", "--seconds", "0.1", "-q")
    assert status == 3 and name in line
    assert most < 200 * MEGABYTE, line


@pytest.mark.parametrize("name", VOLUMES)
def test_a_volume_costs_no_more_than_its_header_says(tmp_path, name):
    (tmp_path / name).write_bytes(VOLUMES[name]())
    status, line, most = measured(tmp_path, "info", name)
    assert status == 3 and name in line
    assert most < 200 * MEGABYTE, line
