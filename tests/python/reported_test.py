"""Files of the kinds that people report to other programs: what is not read is refused with what to do."""

import bz2
import gzip
import struct
import zlib

import h5py
import numpy
import palpate
import pytest
import tifffile
from formats_test import nrrd
from headers_test import meta_image
from readers_test import SHAPE, ramp, refused, save, stack

# What to do -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("data, words", (
    (gzip.compress(gzip.compress(bytes(1000))), "packed twice"), (bz2.compress(bytes(1000)), "bzip2; unpack it"),
    (b"PK\3\4" + bytes(1000), "zip; unpack it"), (b"\x28\xb5\x2f\xfd" + bytes(1000), "zstd; unpack it"),
    (b"<!DOCTYPE html><html><head>" + bytes(1000), "web page"), (b"<HTML><BODY>" + bytes(1000), "web page")), ids=range(6))
@pytest.mark.parametrize("name", ("a.nii.gz", "a.nrrd", "a.mha", "a.mrc"))
def test_a_file_that_is_something_else_than_its_name_says_is_refused_with_what_to_do(tmp_path, name, data, words):
    (tmp_path / name).write_bytes(data)
    refused(tmp_path / name, words)


@pytest.mark.parametrize("pack", (gzip.compress, zlib.compress))
def test_samples_that_are_compressed_against_their_header_are_refused_for_that(tmp_path, pack):
    data = numpy.zeros(SHAPE, "i2")  # packs well
    for path in (nrrd(tmp_path / "a.nrrd", data, "space: RAS"), meta_image(tmp_path / "a.mha", data=data.tobytes())):
        path.write_bytes(path.read_bytes()[:-data.nbytes] + pack(data.tobytes()))
        refused(path, "not compressed, but they begin")
    refused(meta_image(tmp_path / "b.mha", "CompressedData = True", data=ramp("i2").tobytes()), "do not begin as")
    path = nrrd(tmp_path / "b.nrrd", ramp("i2"))
    path.write_bytes(path.read_bytes().replace(b"encoding: raw", b"encoding: gzip"))
    refused(path, "do not begin as")


@pytest.mark.parametrize("name, words", (("a.mnc", "mnc2nii"), ("a.mif", "mrconvert"), ("a.mif.gz", "unpack"), ("a.HEAD", "AFNI"),
                                         ("a.npy", "palpate.Volume"), ("a.czi", "OME-TIFF"), ("a.vtk", ".vti"),
                                         ("a.nii.zst", "unpack"), ("a.png", "TIFF"), ("a.other", "no extension of a known format")))
def test_a_format_that_is_not_read_is_refused_with_what_to_do(tmp_path, name, words):
    (tmp_path / name).write_bytes(b"something")
    refused(tmp_path / name, words)


def test_slices_that_are_packed_are_refused_with_what_to_do(tmp_path):
    folder = save(tmp_path / "a", stack(ramp("i2")))
    for path in list(folder.iterdir()):
        path.with_suffix(".dcm.gz").write_bytes(gzip.compress(path.read_bytes()))
        path.unlink()
    refused(folder, "gunzip")


def test_hdf5_of_another_program_is_refused_with_what_to_do(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["data"] = ramp("i2")
    refused(tmp_path / "a.h5", "another program", ".nrrd")
    with pytest.raises(palpate.InputError, match="another program.*OME-Zarr"):
        palpate.open_store(tmp_path / "a.h5")


@pytest.mark.parametrize("number", (33003, 34712, 65000))
def test_compressions_that_libtiff_does_not_have_are_refused_with_what_to_do(tmp_path, number):
    tifffile.imwrite(tmp_path / "a.tif", ramp("u2"), photometric="minisblack", metadata=None)
    data = bytearray((tmp_path / "a.tif").read_bytes())
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        for page in file.pages:
            struct.pack_into("<H", data, page.tags["Compression"].valueoffset, number)
    (tmp_path / "a.tif").write_bytes(data)
    refused(tmp_path / "a.tif", f"TIFF number {number}", "deflate")
