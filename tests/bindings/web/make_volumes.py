#!/usr/bin/env python3
"""Writes volumes with other people's libraries (pydicom, Zarr, numcodecs), for opening.test.mjs.

usage: make_volumes.py FOLDER
"""

import json
import struct
import sys
from pathlib import Path

import numcodecs
import numpy as np
import zarr
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian, JPEGLosslessSV1, generate_uid

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
        (place / "0").write_bytes(body + index + b"\0\0\0\0")
    expected.astype("<f4").tofile(folder.with_suffix(".raw"))


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


if __name__ == "__main__":
    main(Path(sys.argv[1]))
