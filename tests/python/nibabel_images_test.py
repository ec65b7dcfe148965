"""Images of nibabel are placed as their files, and the letters of an orientation are those of nibabel."""

import contextlib
import json
import os
import struct
import subprocess

import nibabel
import numpy
import palpate
import pytest


def test_a_unit_of_nibabel_that_is_not_known_is_taken_as_mm_with_a_warning(tmp_path):
    path = tmp_path / "a.nii"
    nibabel.save(nibabel.Nifti1Image(numpy.zeros((6, 5, 4), "i2"), numpy.diag([0.5, 0.6, 2, 1])), path)
    for code in (7, 4, 64 + 2):
        content = bytearray(path.read_bytes())
        content[123] = code
        path.write_bytes(content)
        warning = pytest.warns(UserWarning, match=f"unit of length '{code}'") if code < 8 else contextlib.nullcontext()
        with warning:
            assert numpy.allclose(palpate.as_volume(nibabel.load(path)).geometry.spacing, (0.5, 0.6, 2))


def test_an_mgh_image_of_nibabel_without_a_place_is_that_of_its_file(tmp_path):
    path = tmp_path / "a.mgh"
    head = struct.pack(">iiiiiiih", 1, 6, 5, 4, 1, 4, 0, 0)
    path.write_bytes(head + bytes(284 - len(head)) + numpy.arange(120, dtype=">i2").tobytes())
    expected = palpate.load(path).volume
    with pytest.warns(UserWarning, match="goodRASFlag"):
        volume = palpate.as_volume(nibabel.load(path))
    assert numpy.array_equal(volume.array, expected.array)
    for name in ("origin", "spacing", "direction", "oriented", "measured"):
        assert numpy.array_equal(getattr(volume.geometry, name), getattr(expected.geometry, name)), name


def test_the_letters_of_an_orientation_name_three_sides(tmp_path):
    rng = numpy.random.default_rng(1)
    for case in range(12):
        turn = numpy.linalg.qr(rng.standard_normal((3, 3)))[0]
        if case == 0:
            turn = numpy.array([[-0.656692, -0.676962, 0.332383], [0.360389, -0.668844, -0.650205], [0.662477, -0.307197, 0.683194]])
        affine = numpy.eye(4)
        affine[:3, :3] = turn
        path = tmp_path / f"{case}.nii"
        nibabel.save(nibabel.Nifti1Image(numpy.arange(120, dtype="i2").reshape(6, 5, 4), affine), path)
        described = json.loads(subprocess.run([os.environ["PALPATE"], "info", "--json", path], check=True, capture_output=True).stdout)
        letters = described["orientation"].replace(" ", "")
        assert letters == "".join(nibabel.aff2axcodes(affine)), case
