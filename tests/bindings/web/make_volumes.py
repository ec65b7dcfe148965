#!/usr/bin/env python3
"""Writes volumes with other people's libraries (pydicom, Zarr, numcodecs), for opening.test.mjs.

usage: make_volumes.py FOLDER
"""

import gzip
import json
import struct
import sys
import zlib
from pathlib import Path

import numcodecs
import numpy as np
import zarr
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian, JPEGLosslessSV1, generate_uid

sys.path.insert(0, str(Path(__file__).parents[2] / "stream"))
from zarr_reference import crc32c

CT = "1.2.840.10008.5.1.4.1.1.2"
ENHANCED_CT = "1.2.840.10008.5.1.4.1.1.2.1"
VALUES = (np.arange(4 * 5 * 6).reshape(4, 5, 6) * 7 % 251).astype(np.int16)  # z, y, x


def dataset(path, syntax, storage=CT):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID, meta.TransferSyntaxUID = storage, generate_uid(), syntax
    one = FileDataset(str(path), {}, file_meta=meta, preamble=b"\0" * 128)
    one.is_little_endian, one.is_implicit_VR = syntax != ExplicitVRBigEndian, syntax == ImplicitVRLittleEndian
    one.SOPClassUID, one.SOPInstanceUID, one.Modality = storage, meta.MediaStorageSOPInstanceUID, "CT"
    one.Rows, one.Columns, one.SamplesPerPixel, one.PhotometricInterpretation = 5, 6, 1, "MONOCHROME2"
    one.BitsAllocated, one.BitsStored, one.HighBit, one.PixelRepresentation = 16, 12, 11, 0
    one.ReferencedStudySequence = Sequence([Dataset()])  # to be passed over
    return one


def pixels(values, syntax=ExplicitVRLittleEndian):
    return values.astype(">u2" if syntax == ExplicitVRBigEndian else "<u2").tobytes()


def series(folder, syntax, left_out=(), fraction=1):
    folder.mkdir(parents=True)
    uid = generate_uid()
    for k in (2, 0, 3, 1):
        if k in left_out:
            continue
        one = dataset(folder / f"{(k * 7) % 4}.dcm", syntax)
        one.SeriesInstanceUID, one.PixelSpacing = uid, [2, 3]
        one.ImageOrientationPatient, one.ImagePositionPatient = [1, 0, 0, 0, 0, -1], [-10, 20 + 4 * k, 30]
        one.RescaleSlope, one.RescaleIntercept = fraction, -100
        one.PixelData = pixels(VALUES[k], syntax)
        one["PixelData"].VR = "OW"
        one.save_as(folder / f"{(k * 7) % 4}.dcm", write_like_original=False)
    (folder / "notes.txt").write_text("no DICOM")


def frames(path):
    """Four slices in one file, described by functional groups."""
    one = dataset(path, ExplicitVRLittleEndian, ENHANCED_CT)
    one.SeriesInstanceUID, one.NumberOfFrames = generate_uid(), 4

    def group(name, **members):
        inside, outside = Dataset(), Dataset()
        for member, value in members.items():
            setattr(inside, member, value)
        setattr(outside, name, Sequence([inside]))
        return outside

    shared = group("PlaneOrientationSequence", ImageOrientationPatient=[1, 0, 0, 0, 0, -1])
    shared.update(group("PixelMeasuresSequence", PixelSpacing=[2, 3], SliceThickness=4))
    shared.update(group("PixelValueTransformationSequence", RescaleSlope=1, RescaleIntercept=-100))
    one.SharedFunctionalGroupsSequence = Sequence([shared])
    one.PerFrameFunctionalGroupsSequence = Sequence(
        [group("PlanePositionSequence", ImagePositionPatient=[-10, 20 + 4 * k, 30]) for k in range(4)])
    one.PixelData = pixels(VALUES)
    one["PixelData"].VR = "OW"
    one.save_as(path, write_like_original=False)


def compressed(path):
    one = dataset(path, JPEGLosslessSV1)
    one.SeriesInstanceUID = generate_uid()
    one.PixelData = b"\xfe\xff\x00\xe0\0\0\0\0\xfe\xff\xdd\xe0\0\0\0\0"
    one["PixelData"].VR, one["PixelData"].is_undefined_length = "OB", True
    one.save_as(path, write_like_original=False)


def ome(folder, compressor, dtype="<i2", order="C", separator="/", noise=False):
    """OME-Zarr 0.4: channels, and two levels of which the first has a scale and a translation."""
    values = VALUES.astype(dtype)
    if noise:  # so much that blosc needs several blocks
        values = np.random.default_rng(3).integers(-500, 500, (40, 50, 60)).astype(dtype)
    group = zarr.open_group(str(folder), mode="w")
    group.create_dataset("0", data=np.stack([values, values + 1]), chunks=(1, *(n // 2 + 1 for n in values.shape)),
                         compressor=compressor, order=order, dimension_separator=separator)
    axes = [{"name": "c", "type": "channel"}] + [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": [
        {"type": "scale", "scale": [1, 3000, 2000, 1000]}, {"type": "translation", "translation": [0, 30000, 20000, 10000]}]}]}]
    values.astype("<f4").tofile(folder.with_suffix(".raw"))


def sharded(folder):
    """A Zarr 3 array of two shards, each of two chunks, of which one is missing."""
    folder.mkdir()
    inner = {"chunk_shape": [2, 5, 3], "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "gzip", "configuration": {"level": 1}}],
             "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "crc32c"}], "index_location": "end"}
    (folder / "zarr.json").write_text(json.dumps({
        "zarr_format": 3, "node_type": "array", "shape": [4, 5, 6], "data_type": "int16", "fill_value": 9, "attributes": {},
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 5, 6]}},
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}}, "dimension_names": ["z", "y", "x"],
        "codecs": [{"name": "sharding_indexed", "configuration": inner}]}))
    expected = VALUES.copy()
    expected[2:, :, 3:] = 9
    for shard in range(2):
        body, index = b"", b""
        for part in range(2):
            if shard == 1 and part == 1:
                index += struct.pack("<QQ", 2**64 - 1, 2**64 - 1)
                continue
            chunk = numcodecs.GZip(1).encode(np.ascontiguousarray(VALUES[2 * shard:2 * shard + 2, :, 3 * part:3 * part + 3]).tobytes())
            index += struct.pack("<QQ", len(body), len(chunk))
            body += bytes(chunk)
        place = folder / "c" / str(shard) / "0"
        place.mkdir(parents=True)
        (place / "0").write_bytes(body + index + crc32c(index))
    expected.astype("<f4").tofile(folder.with_suffix(".raw"))


EIGHT = np.arange(8).astype("<i2").tobytes()
BYTES = {"name": "bytes", "configuration": {"endian": "little"}}


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())


def array3(**changes):
    """2 x 2 x 2 samples of Zarr 3, in one chunk."""
    whole = {"zarr_format": 3, "node_type": "array", "shape": [2, 2, 2], "data_type": "int16", "fill_value": 0, "codecs": [BYTES],
             "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2] * len(changes.get("shape", "xyz"))}},
             "chunk_key_encoding": {"name": "default"}, "attributes": {}}
    whole.update(changes)
    return {"zarr.json": whole, "c/" + "/".join("0" * len(whole["shape"])): EIGHT}


def shards(index_codecs=(BYTES,), **changes):
    """Of two channels, each in a chunk of its own."""
    inner = {"chunk_shape": [1, 2, 2, 2], "codecs": [BYTES], "index_codecs": list(index_codecs), **changes}
    other = np.arange(100, 108).astype("<i2").tobytes()
    array = array3(shape=[2, 2, 2, 2], dimension_names=["c", "z", "y", "x"], codecs=[{"name": "sharding_indexed", "configuration": inner}])
    array["c/0/0/0/0"] = EIGHT + other + struct.pack("<4Q", 0, 16, 16, 16)
    return array


def image3(steps=({"type": "scale", "scale": [1, 2, 3]},), unit="millimeter", names="zyx", outer=(), **attributes):
    axes = [{"name": name, "type": "space", **({"unit": unit} if unit else {})} for name in names]
    multiscales = [{"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": list(steps)}], "coordinateTransformations": list(outer)}]
    group = {"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.5", "multiscales": multiscales}, **attributes}}
    return {"zarr.json": group, **{f"0/{path}": content for path, content in array3().items()}}


def systems3():
    """Of OME-Zarr 0.6, whose axes are in a coordinate system."""
    objects = image3()
    [image] = objects["zarr.json"]["attributes"]["ome"]["multiscales"]
    image["coordinateSystems"] = [{"name": "physical", "axes": image.pop("axes")}]
    steps = [{"type": "scale", "scale": [1, 2, 3]}, translation(1, 2, 3)]
    image["datasets"][0]["coordinateTransformations"] = [{"type": "sequence", "input": "0", "output": "physical", "transformations": steps}]
    return objects


def pyramid(*levels, **changes):
    """Levels of a path, a shape and transformations, in the order of their list."""
    image = {"axes": [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"],
             "datasets": [{"path": path, **({"coordinateTransformations": steps} if steps else {})} for path, _, steps in levels]}
    objects = {"zarr.json": {"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.5", "multiscales": [image]}}}}
    for path, shape, _ in levels:
        array = array3(**{"shape": shape, "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 2, 2]}}, **changes.get(path, {})})
        objects |= {f"{path}/{name}": content for name, content in array.items()}
    return objects


def array2(attributes=None, **changes):
    array = {"zarr_format": 2, "shape": [2, 2, 2], "chunks": [2, 2, 2], "dtype": "<i2", "compressor": None, "filters": None, "fill_value": 0, "order": "C"}
    return {".zarray": {**array, **changes}, ".zattrs": attributes or {}, "0.0.0": EIGHT}


def mgh():
    head = struct.pack(">7ih15f", 1, 2, 2, 2, 1, 4, 0, 1, 1, 2, 3, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7)
    return head + bytes(284 - len(head)) + np.frombuffer(EIGHT, "<i2").astype(">i2").tobytes()


def meta(data=EIGHT, samples="LOCAL", **changes):
    base = {"NDims": 3, "DimSize": "2 2 2", "ElementType": "MET_SHORT", "ElementSpacing": "1 2 3", "Offset": "4 5 6", **changes, "ElementDataFile": samples}
    return "".join(f"{name} = {value}\n" for name, value in base.items()).encode() + data


def nrrd(*fields, data=EIGHT, **changes):
    base = {"type": "short", "dimension": 3, "sizes": "2 2 2", "endian": "little", "encoding": "raw", **changes}
    lines = [f"{name}: {value}" for name, value in base.items() if value] + list(fields)
    return "\n".join(["NRRD0004", *lines, "", ""]).encode() + data


def nifti(kind=4, steps=(1, 1, 2, 3), offset=352, sform=None, qform=None, data=EIGHT, moments=1, scale=(1, 0), unit=2, magic=b"n+1"):
    head = bytearray(352)

    def put(form, at, *values):
        struct.pack_into("<" + form, head, at, *values)
    put("i", 0, 348)
    put("8h", 40, 3 if moments == 1 else 4, 2, 2, 2, moments, 1, 1, 1)
    put("2h", 70, kind, {4: 16, 16: 32}[kind])
    put("4f", 76, *steps)
    put("3f", 108, offset, *scale)
    put("B", 123, unit)
    put("2h", 252, int(qform is not None), int(sform is not None))
    put("6f", 256, *(qform or [0] * 6))
    put("12f", 280, *(sform or [0] * 12))
    put("4s", 344, magic)
    return bytes(head) + data


def translation(*shift):
    return {"type": "translation", "translation": list(shift)}


SCALE = {"type": "scale", "scale": [1, 2, 3]}
LPS = ["space: LPS", "space directions: (1,0,0) (0,2,0) (0,0,3)"]
HOLES = np.array([1, 2, np.nan, 4, np.inf, 6, -7, 8], "<f4").tobytes()
HALVES = np.array([1, 0.1, np.nan, -65504, -np.inf, 6e-8, -1e-5, 0], "<f2").tobytes()  # also the smallest ones
ZSTD = bytes.fromhex("28b52ffd 24 10 810000") + EIGHT + bytes.fromhex("88494901")  # not packed, with a checksum
FINE, COARSE, HUGE = [4, 4, 4], [2, 2, 2], [4, 8192, 8192]
HALF = [{"type": "scale", "scale": [2, 4, 6]}, translation(0.5, 1, 1.5)]
PART = [{"type": "scale", "scale": [2, 8192, 12288]}, translation(0.5, 4095, 6142.5)]
EXTRA = {"extra": {"name": "x"}}
SAME_ZARR = {
    "coarse_first": pyramid(("half", COARSE, HALF), ("whole", FINE, [SCALE])), "understood": array3(extra={"must_understand": False}),
    "zstd_sum": array3(codecs=[BYTES, {"name": "zstd"}]) | {"c/0/0/0": ZSTD},
    "bytes": array3(data_type="uint8", codecs=[{"name": "bytes"}]) | {"c/0/0/0": EIGHT[:8]},
    "shards": shards(), "image": image3(), "systems": systems3(), "prefixed": array3(codecs=[BYTES, {"name": "numcodecs.gzip"}]) | {"c/0/0/0": gzip.compress(EIGHT)}, "inches": image3(unit="inch"), "kilometers": image3(unit="kilometer"),
    "no_unit": image3(unit=None), "packed": array2({"add_offset": 5, "scale_factor": 2}), "turned": image3(palpate={"direction": [0, 1, 0, 1, 0, 0, 0, 0, -1]}),
    "outer": image3([SCALE, translation(1, 2, 3)], outer=[{"type": "scale", "scale": [2, 2, 2]}, translation(5, 6, 7)]),
    "named": array2({"_ARRAY_DIMENSIONS": ["x", "y", "z"]}), "capitals": array3(dimension_names=["X", "Y", "Z"]),
    "holes": array3(data_type="float32", fill_value="NaN", shape=[2, 2, 2]) | {"c/0/0/0": HOLES},
    "halves": array3(data_type="float16", fill_value=0.5, shape=[2, 2, 3]) | {"c/0/0/0": HALVES},
    "longs": array3(data_type="int64") | {"c/0/0/0": np.array([1, -2, 3, 4, 2**40, 2**53, -2**62, 0], "<i8").tobytes()},
    "checked": array3(codecs=[BYTES, {"name": "crc32c"}]) | {"c/0/0/0": EIGHT + crc32c(EIGHT)},
}
# Read, or refused in the same words, as by the native program. What is in a folder is opened with all beside it.
FILES = {
    "plain.mgh": mgh(), "plain.mgz": gzip.compress(mgh()), "plain.nrrd": nrrd(), "longer.nrrd": nrrd(data=EIGHT + EIGHT[:4]), "magic.nrrd": nrrd(data=b"\x1f\x8b" + EIGHT[2:]), "uint.nrrd": nrrd(type="uint", data=2 * EIGHT),
    "ras.nrrd": nrrd("space: RAS", LPS[1], "space origin: (1,2,3)"), "las.nrrd": nrrd("space: left-anterior-superior", LPS[1]),
    "dimension.nrrd": nrrd("space dimension: 3", LPS[1], 'space units: "m" "m" "m"'), "key.nrrd": nrrd("type:=none"),
    "holes.nrrd": nrrd(type="float", data=HOLES), "holes.nii": nifti(16, data=HOLES), "plain.nii": nifti(),
    "sform.nii": nifti(sform=[-1, 0, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7]), "qform.nii": nifti(qform=[0, 0, 1, 5, 6, 7], steps=[-1, 1, 2, 3]),
    "rpi.nrrd": nrrd("space: RPI", LPS[1]), "scanner.nrrd": nrrd("space: scanner-xyz", LPS[1]), "spaceless.nrrd": nrrd(LPS[1]),
    "mins.nrrd": nrrd("spacings: 1 2 3", "axis mins: 5 6 7"), "none.nrrd": nrrd(LPS[0], "space directions: none (0,2,0) (0,0,3)"),
    "doubled.nrrd": nrrd(data=2 * EIGHT), "endian.nrrd": nrrd(endian=None), "nan.nrrd": nrrd("spacings: NaN 2 3"), "twice.nrrd": nrrd("sizes: 2 2 1"),
    "time.nrrd": nrrd("kinds: domain domain time"), "units.nrrd": nrrd("spacings: 1 2 3", 'units: "m" "m" "m"'), "both.nrrd": nrrd(*LPS, "spacings: 1 2 3"),
    "sheared.nrrd": nrrd(LPS[0], "space directions: (1,0,0) (1,2,0) (0,0,3)"), "huge.nrrd": nrrd(sizes="9999 9999 9999"),
    "offset.nii": nifti(offset=0), "steps.nii": nifti(steps=[1, -1, 2, 3]), "sheared.nii": nifti(sform=[1, 0.5, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0]),
    "flat.nii": nifti(sform=[0] * 12),
    "rows.nii": nifti(sform=[0] * 12, qform=[0, 0, 1, 5, 6, 7]), "both.nii": nifti(sform=[1, 0.5, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0], qform=[0, 0, 1, 5, 6, 7]),
    "moments.nii": nifti(moments=2, data=2 * EIGHT), "scaled.nii": nifti(scale=(2, 1)), "unscaled.nii": nifti(scale=(float("nan"), 5)), "no_intercept.nii": nifti(scale=(2, float("nan"))),
    "metres.nii": nifti(unit=1, sform=[1, 0, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7]), "cut.nii": nifti(data=EIGHT[:6]), "packed.nii.gz": gzip.compress(nifti()), "twice.nii.gz": gzip.compress(nifti()[:360]) + gzip.compress(nifti()[360:]),
    "packed.nrrd": nrrd(*LPS, encoding="gzip", data=gzip.compress(EIGHT)), "text.nrrd": nrrd(*LPS, encoding="text", data=b"1 2 3 4 5 6 7 8"), "skip.nrrd": nrrd(*LPS, "byte skip: 4", data=b"skip" + EIGHT),
    "end.nrrd": nrrd(*LPS, "byte skip: -1", data=b"skip" + EIGHT), "cut.nrrd": nrrd(data=EIGHT[:6]), "colours.nrrd": nrrd("kinds: vector domain domain"),
    "plain.mha": meta(), "packed.mha": meta(zlib.compress(EIGHT), CompressedData=True, CompressedDataSize=len(zlib.compress(EIGHT))), "turned.mha": meta(TransformMatrix="0 1 0 1 0 0 0 0 -1"),
    "detached/head.nhdr": nrrd(*LPS, "data file: head.raw", data=b""), "detached/head.raw": EIGHT, "parts/head.mhd": meta(b"", "slice%d.raw 1 2 1"), "parts/slice1.raw": EIGHT[:8], "parts/slice2.raw": EIGHT[8:],
    "pair/head.hdr": nifti(offset=0, magic=b"ni1")[:348], "pair/head.img": EIGHT, "alone/head.nhdr": nrrd(*LPS, "data file: head.raw", data=b""),
}
REFUSED_ZARR = {
    "index_big": ("index", shards([{"name": "bytes", "configuration": {"endian": "big"}}])),
    "shards_beyond": ("shorter", shards() | {"c/0/0/0/0": EIGHT}),
    "sum": ("checksum", array3(codecs=[BYTES, {"name": "crc32c"}]) | {"c/0/0/0": EIGHT + b"0000"}), "long_chunk": ("32 bytes", array3() | {"c/0/0/0": 2 * EIGHT}),
    "keys": ("chunk_key_encoding", array3(chunk_key_encoding={"name": "fanout"})), "transformers": ("storage_transformers", array3(storage_transformers=[{"name": "x"}])),
    "endian": ("endian", array3(codecs=[{"name": "bytes", "configuration": {"endian": "middle"}}])), "fill_text": ("fill_value", array3(fill_value="abc")),
    "fill_hex": ("fill_value", array3(data_type="float32", fill_value="0x42280000")), "fill_beyond": ("fill_value", array2(fill_value=40000)),
    "no_chunk": ("no possible size", array3(chunk_grid={"name": "regular", "configuration": {"chunk_shape": [0, 2, 2]}})),
    "axes": ("x, y, angle", array3(dimension_names=["x", "y", "angle"])), "no_name": ("null", array3(dimension_names=["z", None, "x"])), "ijk": ("i, j, k", image3(names="ijk")),
    "parsec": ("parsec", image3(unit="parsec")), "um": ("'um'", image3(unit="um")), "swapped": ("translation,scale", image3([translation(1, 1, 1), SCALE])),
    "short": ("3 numbers", image3([{"type": "scale", "scale": [2, 3]}])), "negative": ("spacing", image3([{"type": "scale", "scale": [1, 1, -1]}])),
    "sheared": ("right angles", image3(palpate={"direction": [1, 0, 0, 1, 1, 0, 0, 0, 1]})), "filter": ("delta", array2(filters=[{"id": "delta"}])), "no_json": ("JSON", {"zarr.json": b"{"}),
    "zstd_damaged": ("checksum", array3(codecs=[BYTES, {"name": "zstd"}]) | {"c/0/0/0": ZSTD.replace(EIGHT[:3], b"\0\0\2")}),
    "member": ("'extra'", array3(**EXTRA)), "member_of_group": ("'extra'", image3() | {"zarr.json": {**image3()["zarr.json"], **EXTRA}}),
    "no_endian": ("endian", array3(codecs=[{"name": "bytes"}])), "index_no_endian": ("endian", shards([{"name": "bytes"}])),
    "other_names": ("no chunk", {"zarr.json": array3()["zarr.json"], "0.0.0": EIGHT}), "no_codecs": ("damaged", array3(codecs=None)),
    "megameters": ("megameter", image3(unit="megameter")), "no_transformations": ("transformations", pyramid(("0", COARSE, [SCALE])) | {"zarr.json": {
        "zarr_format": 3, "node_type": "group", "attributes": {"ome": {"multiscales": [{"axes": ["z", "y", "x"], "datasets": [{"path": "0", "coordinateTransformations": None}]}]}}}}),
    "contradiction": ("million samples", pyramid(("whole", HUGE, [SCALE]), ("part", COARSE, [SCALE]))),
    "elsewhere": ("million samples", pyramid(("whole", HUGE, [SCALE]), ("part", COARSE, [PART[0], translation(0, 0, 3e4)]))),
    "no_scales": ("scales of its levels", pyramid(("whole", HUGE, None), ("part", COARSE, None))),
    "types": ("different types", pyramid(("whole", FINE, [SCALE]), ("half", COARSE, HALF), half={"data_type": "uint16"})),
    "no_level": ("is missing", {path: content for path, content in pyramid(("whole", FINE, [SCALE]), ("half", COARSE, HALF)).items() if not path.startswith("half")}),
}

def slices(folder, count=1, each=None, cut=False, values=VALUES, syntax=ExplicitVRLittleEndian, **attributes):
    """Slices of one series. `each` gives attributes of slice k; None stands for an empty element, "absent" for none."""
    folder.mkdir(parents=True)
    uid = generate_uid()
    for k in range(count):
        one = dataset(folder / f"{k}.dcm", syntax)
        one.SeriesInstanceUID, one.PixelSpacing, one.SliceThickness = uid, [2, 3], 4
        one.ImageOrientationPatient, one.ImagePositionPatient = [1, 0, 0, 0, 0, -1], [-10, 20 + 4 * k, 30]
        one.PixelData = pixels(values[k])
        for name, value in {**attributes, **(each(k) if each else {})}.items():
            if value == "absent":
                delattr(one, name)
            else:
                setattr(one, name, value)
        if "PixelData" in one:
            one["PixelData"].VR = "OB" if attributes.get("BitsAllocated") == 8 and syntax != ExplicitVRBigEndian else "OW"
        one.save_as(folder / f"{k}.dcm", write_like_original=False)


def reported(folder):
    """A slice beside a report of a private class."""
    slices(folder)
    report = dataset(folder / "report.dcm", ExplicitVRLittleEndian, "1.3.12.2.1107.5.9.1")
    del report.Rows, report.Columns
    report.save_as(folder / "report.dcm", write_like_original=False)


def sequence(**members):
    inside = Dataset()
    for name, value in members.items():
        setattr(inside, name, value)
    return Sequence([inside])


def grouped(folder, count=4, private=False, stacks=None, echoes=None):
    """Frames with functional groups, of which a private one has another slope (Philips). `stacks` and `echoes`: of each."""
    groups = []
    for k in range(count):
        group = Dataset()
        group.PlanePositionSequence = sequence(ImagePositionPatient=[-10, 20 + 4 * k, 30])
        group.PixelValueTransformationSequence = sequence(RescaleSlope=10, RescaleIntercept=0)
        if stacks:
            group.FrameContentSequence = sequence(StackID=stacks[k])
        if echoes:
            group.MREchoSequence = sequence(EffectiveEchoTime=float(echoes[k]))
        if private:
            group.add_new((0x2005, 0x0010), "LO", "Philips MR Imaging DD 005")
            group.add_new((0x2005, 0x140f), "SQ", sequence(RescaleSlope=1))
        groups.append(group)
    slices(folder, NumberOfFrames=4, PixelData=pixels(VALUES), PerFrameFunctionalGroupsSequence=Sequence(groups), ImagePositionPatient="absent")


def shared_only(folder):
    """A frame described by what all frames share."""
    group = sequence(PixelMeasuresSequence=sequence(PixelSpacing=[3, 2]), PixelValueTransformationSequence=sequence(RescaleSlope=2, RescaleIntercept=-5))
    slices(folder, SharedFunctionalGroupsSequence=group)


def siemens_mosaic(folder):
    """Told by a private element, without the word."""
    slices(folder)
    one = dcmread(folder / "0.dcm")
    one.add_new((0x0019, 0x0010), "LO", "SIEMENS MR HEADER")
    one.add_new((0x0019, 0x100a), "US", 4)
    one.save_as(folder / "0.dcm")


def beside(folder, name, content, bare=False):
    """Slices, and another file of such a name."""
    slices(folder, 3)
    if bare:
        for path in list(folder.iterdir()):
            path.rename(path.with_suffix(""))
    (folder / name).write_bytes(content)


def damaged(folder, change):
    slices(folder, 3)
    path = folder / "2.dcm"
    path.write_bytes(change(path.read_bytes()))


def cut(data):
    return data[:data.index(b"\xe0\x7f\x10\0")]


def twice(data):
    return data + data[data.index(b"\xe0\x7f\x10\0"):]


def unknown_sequence(data):
    """A sequence of unknown type and length is in implicit syntax."""
    inside = b"\xfe\xff\0\xe0" + b"\xff" * 4 + struct.pack("<HHI", 9, 0x1150, 4) + b"1.2\0" + b"\xfe\xff\x0d\xe0\0\0\0\0" + b"\xfe\xff\xdd\xe0\0\0\0\0"
    at = data.index(b"\x18\0\x50\0DS")
    return data[:at] + struct.pack("<HH", 9, 0x1010) + b"UN\0\0" + b"\xff" * 4 + inside + data[at:]


def shifted(k):
    return {"ImagePositionPatient": [-10, 20 + 4 * k, 30 + k]}


def apart(part):
    return lambda k: {"ImagePositionPatient": [-10, 20 + 4 * (k + part * (k == 2)), 30]}


TIMES = {"NumberOfFrames": 4, "PixelData": pixels(VALUES)}
SAME_DICOM = {
    "empty": lambda at: slices(at, RescaleSlope=None, RescaleIntercept=None), "no_slope": lambda at: slices(at, RescaleSlope=0, RescaleIntercept=5),
    "philips": lambda at: grouped(at, private=True), "unspaced": lambda at: slices(at, PixelSpacing="absent", SliceThickness="absent"),
    "even": lambda at: slices(at, 4, apart(0.015)), "unknown": lambda at: damaged(at, unknown_sequence), "padded": lambda at: damaged(at, lambda data: data + b"\0" * 64),
    "negative": lambda at: slices(at, PixelRepresentation=1, values=VALUES - 100), "inverse": lambda at: slices(at, PhotometricInterpretation="MONOCHROME1"),
    "unplaced": lambda at: slices(at, ImagePositionPatient=None), "reported": reported, "no_frames": lambda at: slices(at, NumberOfFrames=0),
    "aspect": lambda at: slices(at, 3, PixelSpacing="absent", PixelAspectRatio=[3, 2]), "bytes": lambda at: slices(at, BitsAllocated=8, BitsStored=8, HighBit=7, PixelData=bytes(range(30))),
    "wide": lambda at: slices(at, BitsStored=16, HighBit=15, values=VALUES * 200), "small": lambda at: slices(at, 3, RescaleSlope=1, RescaleIntercept=1),
    "stack": lambda at: grouped(at, stacks="1111"), "shared": shared_only, "units": lambda at: slices(at, RescaleSlope=2, RescaleIntercept=0, RescaleType="US"),
    "lacking": lambda at: slices(at, 4, lambda k: {"RescaleSlope": 2, **({} if k == 1 else {"RescaleIntercept": -5})}),
}
REFUSED_DICOM = {
    "cut": ("no pixels", lambda at: damaged(at, cut)), "pixels_twice": ("twice", lambda at: damaged(at, twice)), "bare": ("DICM", lambda at: damaged(at, lambda data: data[132:])),
    "one_spacing": ("1 numbers in place of 2", lambda at: slices(at, PixelSpacing=[2])), "two_slopes": ("2 numbers in place of 1", lambda at: slices(at, RescaleSlope=[1, 2])),
    "high": ("HighBit", lambda at: slices(at, HighBit=15)), "table": ("Modality LUT", lambda at: slices(at, ModalityLUTSequence=sequence(LUTDescriptor=[4, 0, 16], ModalityLUTType="US", LUTData=b"\0" * 8))),
    "dose": ("DoseGridScaling", lambda at: slices(at, DoseGridScaling="0.001")), "few_groups": ("describes 2", lambda at: grouped(at, 2)),
    "moments": ("where they lie", lambda at: slices(at, FrameIncrementPointer=0x00181063, FrameTime=40, **TIMES)), "vector": ("where they lie", lambda at: slices(at, FrameIncrementPointer=0x00540080, SliceVector=[2, 1, 3, 4], **TIMES)),
    "mosaic": ("MOSAIC", lambda at: slices(at, ImageType=["ORIGINAL", "PRIMARY", "M", "MOSAIC"])), "vframe": ("MOSAIC", lambda at: slices(at, ImageType=["ORIGINAL", "PRIMARY", "VFRAME"])),
    "packed": ("MOSAIC", siemens_mosaic), "palette": ("PALETTE", lambda at: slices(at, PhotometricInterpretation="PALETTE COLOR")),
    "two_series": ("2 series", lambda at: slices(at, 2, lambda k: {"SeriesInstanceUID": f"1.2.{k + 3}"})), "localizer": ("LOCALIZER", lambda at: slices(at, 3, lambda k: {"ImageType": ["ORIGINAL", "PRIMARY", "AXIAL" if k else "LOCALIZER"]})),
    "stacks": ("2 series", lambda at: grouped(at, stacks="1122")), "frame_echoes": ("2 series", lambda at: grouped(at, echoes="1122")),
    "one_place": ("several at one place", lambda at: slices(at, 3, lambda k: {"ImagePositionPatient": [-10, 20 + 0.01 * k, 30]})), "tiles": ("tiles", lambda at: slices(at, TotalPixelMatrixColumns=600)),
    "lost": ("such names", lambda at: beside(at, "7", b"", bare=True)), "text": ("such names", lambda at: beside(at, "7", b"no slice", bare=True)),
    "patients": ("2 series", lambda at: slices(at, 4, lambda k: {"PatientID": f"p{k % 2}"})), "spaces": ("2 series", lambda at: slices(at, 4, lambda k: {"FrameOfReferenceUID": f"1.2.{k % 2 + 5}"})),
    "drift": ("not evenly spaced", lambda at: slices(at, 9, lambda k: {"ImagePositionPatient": [-10, round(20 + 3.96 * k + 0.07 * max(0, k - 4), 3), 30]}, values=VALUES[[0] * 9])),
    "echoes": ("2 series", lambda at: slices(at, 4, lambda k: {"EchoTime": 10 + k % 2})), "frames_x": ("'-1' frames", lambda at: slices(at, NumberOfFrames=-1)),
    "more_bytes": ("bytes of pixels", lambda at: slices(at, PixelData=pixels(VALUES[:2]))), "words": ("big-endian", lambda at: slices(at, BitsAllocated=8, BitsStored=8, HighBit=7, PixelData=bytes(30), syntax=ExplicitVRBigEndian)),
    "detector": ("ImagerPixelSpacing", lambda at: slices(at, PixelSpacing="absent", ImagerPixelSpacing=[0.2, 0.3])), "tilt": ("gantry tilt", lambda at: slices(at, 4, shifted)),
    "regions": ("of ultrasound", lambda at: slices(at, PixelSpacing="absent", SequenceOfUltrasoundRegions=sequence(PhysicalDeltaX=0.02))),
    "uneven": ("not evenly", lambda at: slices(at, 4, apart(0.03))), "nowhere": ("where they lie", lambda at: slices(at, 3, ImagePositionPatient="absent")),
    "oblique": ("right angles", lambda at: slices(at, ImageOrientationPatient=[1, 0, 0, 0.5, 0.866, 0])), "mixed": ("several volumes", lambda at: (slices(at), write(at / "a.nii", nifti()))),
    "two_files": ("two_files/a.nii, two_files/b.nii", lambda at: [write(at / name, nifti()) for name in ("a.nii", "b.nii")]),
}


def cases(out):
    """What has to be read as the native program reads it, and what is refused, with a word of the reason."""
    packed, uneven = shards(), array3(shape=[3, 2, 2], chunk_grid={"name": "regular", "configuration": {"chunk_shape": [3, 2, 2]}})
    packed["zarr.json"]["codecs"].append({"name": "gzip"})
    uneven["zarr.json"]["codecs"] = [{"name": "sharding_indexed", "configuration": {"chunk_shape": [2, 2, 2], "codecs": [BYTES], "index_codecs": [BYTES]}}]
    refused = {**REFUSED_ZARR, "shards_packed": ("packed as a whole", packed), "shards_uneven": ("1.5", uneven)}
    for name, objects in [*SAME_ZARR.items(), *((name, objects) for name, (_, objects) in refused.items())]:
        for path, content in objects.items():
            write(out / f"{name}.zarr" / path, content)
    for name, content in FILES.items():
        write(out / name, content)
    for name, make in [*SAME_DICOM.items(), *((name, make) for name, (_, make) in REFUSED_DICOM.items())]:
        make(out / name)
    for path, content in pyramid(("whole", HUGE, [SCALE]), ("part", COARSE, PART)).items():
        write(out / "large.zarr" / path, content)
    write(out / "left" / "volume.nii", nifti())
    write(out / "left" / ".DS_Store", b"\0")
    words = {name: word for name, (word, _) in REFUSED_DICOM.items()} | {f"{name}.zarr": word for name, (word, _) in refused.items()}
    files = [name for name in FILES if not name.endswith((".raw", ".img"))]
    write(out / "cases.json", {"same": [*(f"{name}.zarr" for name in SAME_ZARR), *SAME_DICOM], "files": files, "refused": words})


def main(out):
    series(out / "implicit", ImplicitVRLittleEndian)
    series(out / "explicit", ExplicitVRLittleEndian, fraction=0.5)
    series(out / "big", ExplicitVRBigEndian)
    series(out / "incomplete", ExplicitVRLittleEndian, left_out=(1,))
    frames(out / "frames.dcm")
    compressed(out / "compressed.dcm")
    blosc = numcodecs.Blosc
    for name, compressor in {
            "none": None, "zlib": numcodecs.Zlib(), "gzip": numcodecs.GZip(), "lz4": numcodecs.LZ4(), "zstd": numcodecs.Zstd(),
            "blosc_lz4": blosc("lz4", shuffle=blosc.SHUFFLE), "blosc_zstd": blosc("zstd", shuffle=blosc.BITSHUFFLE, blocksize=4096),
            "blosc_zlib": blosc("zlib", shuffle=blosc.NOSHUFFLE)}.items():
        ome(out / f"{name}.zarr", compressor, noise=name != "none", dtype="<f4" if name == "zlib" else "<i2",
            order="F" if name == "gzip" else "C", separator="." if name == "lz4" else "/")
    ome(out / "big_endian.zarr", None, dtype=">u2")
    ome(out / "blosclz.zarr", blosc("blosclz"), noise=True)
    sharded(out / "sharded.zarr")
    cases(out)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
