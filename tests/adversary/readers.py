"""Attack on the readers: files of every format, damaged where it hurts. A file is read or refused in one
line, in time, in little memory, and leaves nothing behind."""

import math
import struct

from damage import ODD_INTEGERS, ODD_NUMBERS, bomb, bytes_changed, odd_float32, repacked, text_changed
from fields import Grid, rotation, samples_of
from program import Finding, expect_tidy, judge
from volume_files import (DEFLATED, EXPLICIT, JPEG2000, JPEG_LS, RLE, WRITERS, dicom_slice, encapsulated,
                          jpeg2000_head, meta, nifti, nrrd, packed, tiff, vti)

MEMORY_MB = 400  # of the program and its reader, for files of a few kilobytes
ANSWERS = {0, 2, 3}


def grid_of(random):
    size = tuple(random.randint(1, 12) for _ in range(3))
    spacing = tuple(random.choice((1, 0.3, 5)) for _ in range(3))
    return Grid(size, samples_of("bytes", size, random), spacing, (1, 2, 3),
                rotation(random) if random.random() < 0.3 else None)


def one(program, random, folder, counts):
    what = random.choice(FORMS)
    name, words = what(random, folder)
    ended = judge(program.run(["info", name, *words], folder, seconds=60), ANSWERS)
    counts[what.__name__] += 1
    counts["refused" if ended.status else "read"] += 1
    if ended.peak_mb > MEMORY_MB:
        raise Finding(f"{ended.peak_mb:.0f} MB for {name}: {ended}")
    if ended.status == 3 and name not in ended.err:
        raise Finding(f"the message does not name {name}: {ended}")
    expect_tidy(folder, ended)


def damaged_bytes(random, folder):
    extension = random.choice(list(WRITERS))
    data = WRITERS[extension](grid_of(random), "uint8")
    (folder / f"a{extension}").write_bytes(bytes_changed(data, random))
    return f"a{extension}", []


def damaged_gzip(random, folder):
    data = nifti(grid_of(random), "int16", compressed=True)
    (folder / "a.nii.gz").write_bytes(repacked(data, random))
    return "a.nii.gz", []


def odd_nrrd(random, folder):
    data = nrrd(grid_of(random), "int16", compressed=random.random() < 0.3)
    for _ in range(random.choice((1, 2))):
        data = text_changed(data, random, b"\n\n")
    (folder / "a.nrrd").write_bytes(data)
    return "a.nrrd", []


def odd_meta(random, folder):
    data = meta(grid_of(random), "uint16", compressed=random.random() < 0.3)
    for _ in range(random.choice((1, 2))):
        data = text_changed(data, random, b"ElementDataFile")
    (folder / "a.mha").write_bytes(data)
    return "a.mha", []


def odd_nifti(random, folder):
    """Numbers of the header at the edge of what they can be; sizes and codes as they should be."""
    places = [(at, "f") for at in (76, 80, 84, 88, 92, 112, 116, 256, 260, 264, 268, 272, 276,
                                   *range(280, 328, 4))]
    places += [(at, "h") for at in (252, 254)] + [(123, "B")]
    numbers = {}
    for _ in range(random.choice((1, 3, 12))):
        at, form = random.choice(places)
        numbers[at, form] = odd_float32(random) if form == "f" else random.choice((0, 1, 2, 3, 4, 127))
    numbers[252, "h"] = random.choice((0, 1))
    data = nifti(grid_of(random), "int16", random.random() < 0.3, numbers)
    name = "a.nii.gz" if data[:2] == b"\x1f\x8b" else "a.nii"
    (folder / name).write_bytes(data)
    return name, []


def odd_tiff(random, folder):
    tags = {random.choice((256, 257, 258, 259, 262, 273, 277, 278, 279, 339)):
            random.choice(ODD_INTEGERS) for _ in range(random.choice((1, 2)))}
    (folder / "a.tif").write_bytes(tiff(grid_of(random), "uint8", tags))
    return "a.tif", []


def odd_vti(random, folder):
    name = random.choice(("WholeExtent", "Origin", "Spacing", "Direction"))
    count = {"WholeExtent": 6, "Direction": 9}.get(name, 3)
    values = [random.choice(ODD_NUMBERS[:12] + ("1",) * 12) for _ in range(count)]
    (folder / "a.vti").write_bytes(vti(grid_of(random), "float32", {name: " ".join(values)}))
    return "a.vti", []


def consistent_lie(random, folder):
    """A small file that declares a huge volume in every field that says so."""
    size = random.choice(((60000, 60000, 2), (2**31 - 1, 1, 1), (1, 1, 2**40), (1024, 1024, 1024)))
    grid = grid_of(random)
    words = " ".join(map(str, size))
    if random.random() < 0.5:
        data, name = nrrd(grid, "int16", random.random() < 0.5, {"sizes": words}), "a.nrrd"
    else:
        data, name = meta(grid, "int16", random.random() < 0.5, {"DimSize": words}), "a.mha"
    (folder / name).write_bytes(data)
    return name, []


def gzip_bomb(random, folder):
    """Declares a few hundred samples and unpacks to hundreds of megabytes."""
    grid = grid_of(random)
    zipped = bomb(random.choice((200, 600)))
    if random.random() < 0.5:
        head = nrrd(grid, "uint8", True).split(b"\n\n")[0] + b"\n\n"
        (folder / "a.nrrd").write_bytes(head + zipped)
        return "a.nrrd", []
    if random.random() < 0.5:
        (folder / "a.nii.gz").write_bytes(zipped)
        return "a.nii.gz", []
    (folder / "a.raw.gz").write_bytes(zipped)
    return "a.raw.gz", ["--dims", "8x8x8", "--type", "uint8"]


def damaged_raw(random, folder):
    (folder / "a.raw").write_bytes(bytes(random.randrange(256) for _ in range(random.choice((0, 1, 27, 64)))))
    dims = random.choice(("3x3x3", "4x4x4", "0x3x3", "3x3", "99999999x99999999x9", "3x3x3x3", "-3x3x3"))
    return "a.raw", ["--dims", dims, "--type", random.choice(("uint8", "int16", "float32", "int64"))]


def series(random, folder):
    """A DICOM series with something unusual: gaps, twice the same place, tilt, mixed sizes or series, odd
    numbers, damaged slices, streams that are not what the header says."""
    (folder / "d").mkdir()
    rows, columns, slices = random.randint(1, 8), random.randint(1, 8), random.randint(1, 7)
    syntax = random.choice((EXPLICIT, EXPLICIT, DEFLATED))
    unusual = random.choice(("gap", "twice", "tilt", "size", "mixed", "numbers", "bytes", "stream", "none"))
    odd_tag = random.choice(((0x0020, 0x0032), (0x0020, 0x0037), (0x0028, 0x0030), (0x0028, 0x1052),
                             (0x0028, 0x1053), (0x0028, 0x0100), (0x0028, 0x0010)))
    for i in range(slices):
        z, tags, pixels, r = 2.0 * i, {}, None, rows
        chosen = i == slices // 2
        if unusual == "gap" and i > slices // 2:
            z += random.choice((2, 4, 0.7, 1000, 1e30))
        elif unusual == "twice" and chosen:
            z = 0
        elif unusual == "tilt":
            tags[0x0020, 0x0032] = ("DS", f"0\\{z * 0.3:.6f}\\{z}")
        elif unusual == "size" and chosen:
            r = rows + 1
        elif unusual == "numbers" and (chosen or random.random() < 0.3):
            short = odd_tag[0] == 0x28 and odd_tag[1] in (0x100, 0x10)
            tags[odd_tag] = ("US", struct.pack("<H", random.choice((0, 1, 8, 12, 32, 65535)))) if short \
                else ("DS", "\\".join(random.choice(ODD_NUMBERS[:14])[:16] for _ in range(
                    {0x32: 3, 0x37: 6, 0x30: 2}.get(odd_tag[1], 1))))
        elif unusual == "stream":
            kind = random.choice((JPEG2000, JPEG_LS, RLE))
            stream = jpeg2000_head(random.choice((columns, 7, 60000)), random.choice((r, 9, 60000)))
            if random.random() < 0.3:
                stream = bytes_changed(stream, random)
            data = dicom_slice(r, columns, [], i + 1, z, syntax=kind, pixels=encapsulated([stream]))
            (folder / "d" / f"{i}.dcm").write_bytes(data)
            continue
        data = dicom_slice(r, columns, [(i * 7 + k) % 99 for k in range(r * columns)], i + 1, z,
                           f"1.2.3.{random.randint(4, 5) if unusual == 'mixed' else 4}", syntax, tags, pixels)
        if unusual == "bytes" and chosen:
            data = bytes_changed(data, random)
        (folder / "d" / f"{i}.dcm").write_bytes(data)
    return "d", []


FORMS = (damaged_bytes, damaged_bytes, damaged_gzip, odd_nrrd, odd_meta, odd_nifti, odd_nifti, odd_tiff,
         odd_vti, consistent_lie, gzip_bomb, damaged_raw, series, series, series)
