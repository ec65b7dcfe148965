"""Segmentations of DICOM, as dcmqi and highdicom write them: they leave out the slices that have nothing of a segment."""

import numpy
import palpate
import pydicom
import pytest
from dicom_readers_test import enhanced, items
from readers_test import noted, ramp, refused

MASK = (ramp("u1") % 2).astype("u1")


def segmentation(path, places, planes=MASK, between=None, **changes):
    """Frames of one segment at `places`, which lie 2 mm apart."""
    group = lambda i: {"SegmentIdentificationSequence": items(ReferencedSegmentNumber=1)}
    folder = enhanced(path, planes[:len(places)], places, group)
    data = pydicom.dcmread(folder / "001.dcm")
    data.Modality, data.SOPClassUID = "SEG", "1.2.840.10008.5.1.4.1.1.66.4"
    for name, value in changes.items():
        setattr(data, name, value)
    if between:
        data.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0].SpacingBetweenSlices = between
    data.save_as(folder / "001.dcm")
    return folder


@pytest.mark.parametrize("places, between, distance", (
    ((0, 1, 2, 7, 9), None, 1), ((0, 1, 2, 7, 9), 2, 1), ((0, 5), 2, 1), ((0, 5), None, 5), ((0, 40), 2, 1), ((0, 3, 6), 2, 1)))
def test_slices_that_a_segmentation_leaves_out_are_empty(tmp_path, places, between, distance):
    expected = numpy.zeros((places[-1] // distance + 1, *MASK.shape[1:]), "u1")
    expected[numpy.array(places) // distance] = MASK[:len(places)]
    loaded = palpate.load(segmentation(tmp_path / "a", places, between=between))
    assert loaded.volume.geometry.spacing[2] == 2 * distance
    assert numpy.array_equal(loaded.volume.array, expected)
    empty = len(expected) - len(places)
    assert empty == 0 or any(f"{empty} of {len(expected)} slices are not in the segmentation" in n for n in loaded.notes)


def test_a_segmentation_of_two_slices_very_far_apart_is_refused(tmp_path):
    refused(segmentation(tmp_path / "a", (0, 100000), between=2), "spread over 200000 mm")


def test_a_segmentation_at_uneven_distances_is_interpolated(tmp_path):
    noted(segmentation(tmp_path / "a", (0, 2, 5)), "not evenly spaced")


def test_fractions_are_of_the_greatest_value(tmp_path):
    changes = {"SegmentationType": "FRACTIONAL", "MaximumFractionalValue": 200}
    volume = palpate.load(segmentation(tmp_path / "a", range(5), ramp("u1"), **changes)).volume
    assert numpy.allclose(volume.array, ramp("u1") / 200)


def test_labels_may_have_colours(tmp_path):
    changes = {"PhotometricInterpretation": "PALETTE COLOR", "SegmentationType": "LABELMAP"}
    volume = palpate.load(segmentation(tmp_path / "a", range(5), ramp("u1"), **changes)).volume
    assert numpy.array_equal(volume.array, ramp("u1"))
