"""Transfer syntaxes of DICOM: compressed images that bytes follow, deflated frames, big-endian samples of GE, and syntaxes
that are not known."""

import io
import zlib

import numpy
import palpate
import pydicom
import pytest
from PIL import Image
from pydicom.encaps import encapsulate

from dicom_readers_test import frames_of
from readers_test import noted, ramp, refused, save, slice_of

KINDS = {"JPEG": "1.2.840.10008.1.2.4.50", "JPEG2000": "1.2.840.10008.1.2.4.90"}
PICTURE = (numpy.arange(600) % 251).astype("u1").reshape(20, 30)


def with_syntax(folder, data, syntax, frames=None, implicit=False):
    """One file, whose pixels are `frames` in fragments, or as they are."""
    path = save(folder, [data], "implicit" if implicit else "explicit") / "001.dcm"
    file = pydicom.dcmread(path)
    unknown_to_pydicom = syntax.startswith("1.2.840.10008.1.2.8.")
    file.file_meta.TransferSyntaxUID = KINDS["JPEG2000"] if unknown_to_pydicom else syntax
    file.is_little_endian, file.is_implicit_VR = True, implicit
    if frames is not None:
        file.PixelData = encapsulate(frames)
        file["PixelData"].is_undefined_length = True
        file["PixelData"].VR = "OB"
    file.save_as(path)
    if unknown_to_pydicom:
        path.write_bytes(path.read_bytes().replace(KINDS["JPEG2000"].encode(), syntax.encode() + b"\0"))
    return path


def compressed(kind):
    stream = io.BytesIO()
    Image.fromarray(PICTURE).save(stream, kind, **({"irreversible": False} if kind == "JPEG2000" else {"quality": 100}))
    return stream.getvalue()


@pytest.mark.parametrize("behind", (b"", bytes(8), bytes(64), bytes(5000), b"\xff" * 64, bytes(range(1, 65)), b"\xff\xd9" * 2))
@pytest.mark.parametrize("kind", KINDS)
def test_what_follows_the_end_of_an_image_is_no_part_of_it(tmp_path, kind, behind):
    frame = compressed(kind)
    frames = [frame + behind + bytes(len(frame + behind) % 2)]
    loaded = palpate.load(with_syntax(tmp_path / "a", slice_of(PICTURE, 1, (1, 2, 3)), KINDS[kind], frames))
    values = loaded.volume.array[0].astype(int)
    assert abs(values - PICTURE).max() <= (0 if kind == "JPEG2000" else 3)
    assert any("behind the end" in note for note in loaded.notes) == (behind not in (b"", bytes(8)))


@pytest.mark.parametrize("kind", KINDS)
def test_an_image_without_an_end_is_cut_off(tmp_path, kind):
    frame = compressed(kind)
    cut = frame[:-40] + bytes(400)
    refused(with_syntax(tmp_path / "a", slice_of(PICTURE, 1, (1, 2, 3)), KINDS[kind], [cut + bytes(len(cut) % 2)]), "cut off")


def deflated(frame):
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    stream = packer.compress(frame) + packer.flush()
    return stream + bytes(len(stream) % 2)


@pytest.mark.parametrize("dtype", ("u1", "u2", "i2"))
def test_deflated_frames_are_read(tmp_path, dtype):
    array = ramp(dtype)
    data = frames_of(array, SpacingBetweenSlices=2)
    path = with_syntax(tmp_path / "a", data, "1.2.840.10008.1.2.8.1", [deflated(plane.tobytes()) for plane in array])
    assert numpy.array_equal(palpate.load(path).volume.array, array)
    refused(with_syntax(tmp_path / "b", data, "1.2.840.10008.1.2.8.1", [deflated(plane.tobytes() * 2) for plane in array]), "another size")
    refused(with_syntax(tmp_path / "c", data, "1.2.840.10008.1.2.8.1", [b"\xfe" * 40] * len(array)), "damaged")


def test_deflated_frames_of_single_bits_begin_with_a_byte(tmp_path):
    mask = numpy.random.default_rng(1).random((3, 5, 7)) > 0.5
    data = frames_of(mask.astype("u1"), SpacingBetweenSlices=2, BitsAllocated=1, BitsStored=1, HighBit=0,
                     Modality="SEG", RescaleSlope=None, RescaleIntercept=None)
    frames = [deflated(numpy.packbits(plane.ravel(), bitorder="little").tobytes()) for plane in mask]
    path = with_syntax(tmp_path / "a", data, "1.2.840.10008.1.2.8.1", frames)
    assert numpy.array_equal(palpate.load(path).volume.array, mask)


@pytest.mark.parametrize("dtype", ("u1", "u2", "i2", "i4"))
def test_samples_of_ge_are_big_endian(tmp_path, dtype):
    array = ramp(dtype)
    data = slice_of(array[0].astype(numpy.dtype(dtype).newbyteorder(">")), 1, (1, 2, 3))
    path = with_syntax(tmp_path / "a", data, "1.2.840.113619.5.2", implicit=True)
    assert numpy.array_equal(palpate.load(path).volume.array[0], array[0])


@pytest.mark.parametrize("implicit", (True, False))
def test_a_syntax_that_is_not_known_is_noted(tmp_path, implicit):
    path = with_syntax(tmp_path / "a", slice_of(ramp("i2")[0], 1, (1, 2, 3)), "1.2.3.4.5", implicit=implicit)
    assert numpy.array_equal(noted(path, "transfer syntax '1.2.3.4.5' is not known").array[0], ramp("i2")[0])


@pytest.mark.parametrize("syntax", ("1.2.3.4.5", "1.2.840.10008.1.2.8.9"))
def test_a_compression_that_is_not_known_is_no_damage(tmp_path, syntax):
    path = with_syntax(tmp_path / "a", slice_of(PICTURE, 1, (1, 2, 3)), syntax, [b"ab" * 20])
    with pytest.raises(palpate.InputError, match="is not read; export it again without compression") as caught:
        palpate.load(path)
    assert "damaged" not in str(caught.value) and syntax in str(caught.value)
