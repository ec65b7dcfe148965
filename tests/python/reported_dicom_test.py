"""DICOM files of kinds that people report to other programs: groups that all frames share, missing units, mosaics,
zeros in place of missing numbers, overlapping acquisitions, and the index of a disc."""

import io

import numpy
import palpate
import pydicom
import pytest
from dicom_readers_test import enhanced, items
from PIL import Image
from pydicom.dataset import Dataset
from pydicom.encaps import encapsulate
from pydicom.fileset import FileSet
from readers_test import SHAPE, noted, ramp, refused, save, slice_of, stack

# Functional groups ------------------------------------------------------------------------------------


def described_together(array, **changes):
    """Frames with shared functional groups alone."""
    data = slice_of(array[0], 1, (0, 0, 0), NumberOfFrames=len(array), PixelData=array.tobytes(), **changes)
    for name in ("ImagePositionPatient", "ImageOrientationPatient", "PixelSpacing", "SliceThickness", "RescaleSlope",
                 "RescaleIntercept"):
        delattr(data, name)
    shared = Dataset()
    shared.PixelMeasuresSequence = items(PixelSpacing=[0.5, 0.25], SliceThickness=2, SpacingBetweenSlices=3)
    shared.PlaneOrientationSequence = items(ImageOrientationPatient=[0, 1, 0, 0, 0, -1])
    shared.PlanePositionSequence = items(ImagePositionPatient=[1, 2, 3])
    shared.PixelValueTransformationSequence = items(RescaleSlope=2, RescaleIntercept=-1000, RescaleType="HU")
    data.SharedFunctionalGroupsSequence = [shared]
    return data


def test_groups_that_frames_share_count_without_any_of_single_frames(tmp_path):
    loaded = palpate.load(save(tmp_path / "a", [described_together(ramp("i2"))]))
    volume = loaded.volume
    assert any("describes its 5 frames all together" in note for note in loaded.notes), loaded.notes
    assert numpy.array_equal(volume.array, 2 * ramp("i2") - 1000) and loaded.values["units"] == "HU"
    assert numpy.allclose(volume.geometry.spacing, (0.25, 0.5, 3)) and not volume.geometry.oriented
    assert numpy.allclose(volume.geometry.origin, (1, 2, 3))
    assert numpy.allclose(numpy.abs(volume.geometry.direction[0]), (0, 0, 1))


def test_groups_that_a_single_frame_shares_with_none_count(tmp_path):
    data = described_together(ramp("i2")[:1])
    volume = palpate.load(save(tmp_path / "a", [data])).volume
    assert numpy.array_equal(volume.array, 2 * ramp("i2")[:1] - 1000) and volume.geometry.oriented


@pytest.mark.parametrize("intercept", (-1000, 0))
def test_the_padding_of_frames_is_in_their_units(tmp_path, intercept):
    array = ramp("i2")
    array[:, 0, 0] = -2000
    value = lambda i: {"PixelValueTransformationSequence": items(RescaleSlope=1, RescaleIntercept=intercept, RescaleType="HU")}
    loaded = palpate.load(enhanced(tmp_path / "a", array, range(len(array)), value))
    assert loaded.values.get("padding") is None
    folder = enhanced(tmp_path / "b", array, range(len(array)), value)
    data = pydicom.dcmread(folder / "001.dcm")
    data.add(pydicom.DataElement(0x00280120, "SS", -2000))
    data.save_as(folder / "001.dcm")
    loaded = palpate.load(folder)
    assert loaded.values["padding"] == -2000 + intercept == loaded.volume.array.min()


# Distances between frames: the sign of a group counts, and 0 is none.
@pytest.mark.parametrize("between, at_top, gap", ((-4, None, 4), (4, 0, 4), (0, 5, 5), (-4, 5, 4), (0, None, 2), (0, -5, 5)))
def test_a_distance_that_frames_share_keeps_its_sign_and_zero_is_none(tmp_path, between, at_top, gap):
    data = described_together(ramp("i2"), **({} if at_top is None else {"SpacingBetweenSlices": at_top}))
    data.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0].SpacingBetweenSlices = between
    loaded = palpate.load(save(tmp_path / "a", [data]))
    told = between or at_top or 0
    assert loaded.volume.geometry.spacing[2] == gap
    assert numpy.array_equal(loaded.volume.array, (2 * ramp("i2") - 1000)[:: -1 if told < 0 else 1])
    assert any("do not say where they lie" in note for note in loaded.notes) == (told == 0), loaded.notes


@pytest.mark.parametrize("between", (4, -4))
def test_frames_of_one_position_lie_on_the_side_that_their_distance_tells(tmp_path, between):
    folder = enhanced(tmp_path / "a", ramp("i2"), [0] * SHAPE[0], lambda i: {})
    data = pydicom.dcmread(folder / "001.dcm")
    data.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0].SpacingBetweenSlices = between
    data.save_as(folder / "001.dcm")
    volume = noted(folder, "one behind the other, 4 mm apart")
    assert volume.geometry.spacing[2] == 4 and numpy.array_equal(volume.array, ramp("i2")[:: between // 4])


def test_dimensions_order_the_frames_of_several_files_and_not_their_numbers_in_each(tmp_path):
    """Three moments at two places. At each place, the frames are the first, second and third of a file by chance."""
    planes = numpy.stack([ramp("u2")[0] + 1000 * t + 500 * z for t in range(3) for z in range(2)])
    for number, part in enumerate(([0, 1, 2], [3, 4, 5])):
        folder = enhanced(tmp_path / str(number), planes[part], [i % 2 for i in part],
                          lambda i: {"DimensionIndexValues": [part[i] % 2 + 1, part[i] // 2 + 1]}, SOPInstanceUID=f"1.2.3.{number}",
                          ConcatenationUID="1.2.5", InConcatenationNumber=number + 1, ConcatenationFrameOffsetNumber=3 * number)
        (tmp_path / "all").mkdir(exist_ok=True)
        (folder / "001.dcm").rename(tmp_path / "all" / f"{number}.dcm")
    for t in range(3):
        loaded = palpate.load(tmp_path / "all", frame=t)
        assert loaded.time_steps == 3
        assert numpy.array_equal(loaded.volume.array, planes[2 * t:2 * t + 2])


# Units ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("missing", (("RescaleSlope",), ("RescaleIntercept",), ("RescaleSlope", "RescaleIntercept")))
def test_a_ct_without_slope_or_intercept_is_not_known_to_be_in_hounsfield_units(tmp_path, missing):
    folder = save(tmp_path / "a", stack(ramp("i2"), change=lambda i: dict.fromkeys(missing)))
    assert numpy.array_equal(noted(folder, "not known to be HU").array, ramp("i2"))
    assert palpate.load(folder).values["units"] == ""


@pytest.mark.parametrize("told, units", (("US", ""), ("HU", "HU"), ("MGML", "MGML"), ("", "HU"), (None, "HU")))
def test_the_units_of_a_ct_are_those_of_its_rescale_type(tmp_path, told, units):
    change = lambda i: {} if told is None else {"RescaleType": told}
    loaded = palpate.load(save(tmp_path / "a", stack(ramp("i2"), change=change)))
    assert loaded.values["units"] == units and not loaded.notes


def test_unspecified_units_of_pet_are_those_of_its_series(tmp_path):
    change = lambda i: {"Modality": "PT", "RescaleType": "US", "Units": "BQML"}
    assert palpate.load(save(tmp_path / "a", stack(ramp("i2"), change=change))).values["units"] == "BQML"


def test_unspecified_units_of_frames_leave_those_of_the_series(tmp_path):
    data = described_together(ramp("i2"), Modality="PT", Units="BQML")
    data.SharedFunctionalGroupsSequence[0].PixelValueTransformationSequence[0].RescaleType = "US"
    assert palpate.load(save(tmp_path / "a", [data])).values["units"] == "BQML"


@pytest.mark.parametrize("told, units", (("US", ""), ("HU", "HU")))
def test_units_of_frames_of_a_ct_are_those_of_their_group(tmp_path, told, units):
    data = described_together(ramp("i2"))
    data.SharedFunctionalGroupsSequence[0].PixelValueTransformationSequence[0].RescaleType = told
    assert palpate.load(save(tmp_path / "a", [data])).values["units"] == units


# Mosaics ----------------------------------------------------------------------------------------------


def private(data, group, owner, element, vr, value):
    data.private_block(group, owner, create=True).add_new(element, vr, value)
    return data


MOSAICS = {"marked": lambda data: setattr(data, "ImageType", "ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC"),
           "of Siemens without its mark": lambda data: private(data, 0x19, "SIEMENS MR HEADER", 0x0A, "US", 36),
           "of United Imaging": lambda data: private(data, 0x65, "Image Private Header", 0x50, "DS", "36"),
           "of United Imaging by its type": lambda data: setattr(data, "ImageType", "ORIGINAL\\PRIMARY\\M\\VFRAME")}


@pytest.mark.parametrize("syntax", ("explicit", "implicit", "big"))
@pytest.mark.parametrize("kind", MOSAICS)
def test_a_mosaic_is_refused_with_and_without_its_mark(tmp_path, kind, syntax):
    data = slice_of(ramp("i2")[0], 1, (0, 0, 0))
    MOSAICS[kind](data)
    refused(save(tmp_path / "a", [data], syntax), "mosaic", "dcm2niix")


@pytest.mark.parametrize("count", (0, 1))
def test_counts_of_images_that_are_none_or_one_make_no_mosaic(tmp_path, count):
    slices = stack(ramp("i2"))
    for data in slices:
        private(data, 0x19, "SIEMENS MR HEADER", 0x0A, "US", count)
        private(data, 0x65, "Image Private Header", 0x50, "DS", str(count))
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", slices)).volume.array, ramp("i2"))


def test_frames_of_an_enhanced_file_with_the_mark_of_a_mosaic_are_slices(tmp_path):
    folder = enhanced(tmp_path / "a", ramp("i2"), range(SHAPE[0]), lambda i: {}, ImageType="ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC")
    assert numpy.array_equal(palpate.load(folder).volume.array, ramp("i2"))


# Zeros in place of missing numbers --------------------------------------------------------------------


def test_an_orientation_of_zeros_is_none(tmp_path):
    folder = save(tmp_path / "a", stack(ramp("i2"), change=lambda i: {"ImageOrientationPatient": [0] * 6}))
    volume = noted(folder, "ImageOrientationPatient has only zeros")
    assert numpy.array_equal(volume.array, ramp("i2")) and not volume.geometry.oriented
    assert numpy.allclose(volume.geometry.spacing, (0.25, 0.5, 2))


@pytest.mark.parametrize("other", (None, "ImagerPixelSpacing", "NominalScannedPixelSpacing"))
def test_a_pixel_spacing_of_zero_is_none(tmp_path, other):
    change = lambda i: {"PixelSpacing": [0, 0], **({other: [0.5, 0.25]} if other else {})}
    volume = noted(save(tmp_path / "a", stack(ramp("i2"), change=change)), "pixel spacing of 0 mm was ignored")
    assert numpy.allclose(volume.geometry.spacing, (0.25, 0.5, 2) if other else (1, 1, 2))
    assert volume.geometry.measured == bool(other)


@pytest.mark.parametrize("spacing", ([0, 0.5], [-0.5, 0.5]))
def test_a_pixel_spacing_of_one_zero_or_below_is_refused(tmp_path, spacing):
    refused(save(tmp_path / "a", stack(ramp("i2"), change=lambda i: {"PixelSpacing": spacing})), "PixelSpacing")


# Overlapping acquisitions -----------------------------------------------------------------------------


def overlapping(folder, first, second, numbers=(1, 2)):
    """Two acquisitions of the places from these on, 2 mm apart."""
    slices = []
    for start, number in zip((first, second), numbers):
        slices += stack(ramp("i2") + 1000 * (number - 1), start=start, change=lambda i: {"AcquisitionNumber": number})
    return save(folder, numbered(slices))


def numbered(slices):
    for i, data in enumerate(slices):
        data.InstanceNumber, data.SOPInstanceUID = i + 1, f"1.2.3.{i}"
    return slices


@pytest.mark.parametrize("second", (5.0, 11.0, 11.01))
def test_acquisitions_that_overlap_are_chosen_by_their_number(tmp_path, second):
    folder = overlapping(tmp_path / "a", 3.0, second)
    with pytest.raises(palpate.SeriesChoice) as caught:
        palpate.load(folder)
    assert [f"acquisition {n}" in series["description"] for n, series in enumerate(caught.value.series, 1)] == [True, True]
    for number, start in ((1, 3.0), (2, second)):
        volume = palpate.load(folder, series=str(number)).volume
        assert numpy.array_equal(volume.array, ramp("i2") + 1000 * (number - 1)) and volume.geometry.origin[2] == start


def test_acquisitions_at_all_the_same_places_are_time_steps_and_those_beside_each_other_one_volume(tmp_path):
    assert palpate.load(overlapping(tmp_path / "a", 3.0, 3.0)).time_steps == 2
    assert len(palpate.load(overlapping(tmp_path / "b", 3.0, 13.0)).volume.array) == 10


def test_slices_that_overlap_in_one_acquisition_are_refused(tmp_path):
    refused(overlapping(tmp_path / "a", 3.0, 5.0, (1, 1)), "lie at the same place")


def acquired(folder, acquisitions):
    """Slices at these places, one list for each acquisition."""
    return save(folder, numbered([
        slice_of(ramp("i2")[0] + 1000 * number, 1, (0, 0, 2 * place), AcquisitionNumber=number)
        for number, places in enumerate(acquisitions, 1) for place in places]))


EVEN, ODD, SLABS = range(0, 20, 2), range(1, 20, 2), [range(i, i + 4) for i in range(0, 20, 4)]
PARTS = {"every second slice": (EVEN, ODD), "every second slice, one again in it": ([*EVEN, 4], ODD),
         "every second slice, one again alone": (EVEN, ODD, [4]), "every second slice, one again in the other": (EVEN, [*ODD, 4]),
         "slabs": SLABS, "slabs, one slice again": [*SLABS, [4]], "slabs, one of them again": [*SLABS, SLABS[1]],
         "a slice is missing": (range(12), [8, 9, 11, 12])}


@pytest.mark.parametrize("parts", PARTS)
def test_acquisitions_that_are_parts_of_one_volume_are_not_divided(tmp_path, parts):
    folder = acquired(tmp_path / "a", PARTS[parts])
    if sum(map(len, PARTS[parts])) == 20:
        assert len(palpate.load(folder).volume.array) == 20
    else:
        refused(folder, "lie at the same place")


WHOLE = {"one slice again": (range(10), [4]), "three that overlap": (range(10), range(9, 15), range(12, 20)),
         "three times, the last one stopped": (range(10), range(10), range(7))}


@pytest.mark.parametrize("parts", WHOLE)
def test_acquisitions_of_their_own_are_divided(tmp_path, parts):
    folder = acquired(tmp_path / "a", WHOLE[parts])
    for number, places in enumerate(WHOLE[parts], 1):
        volume = palpate.load(folder, series=str(number)).volume
        assert len(volume.array) == len(places) and volume.array[0, 0, 0] == ramp("i2")[0, 0, 0] + 1000 * number


# The index of a disc ----------------------------------------------------------------------------------


def disc(folder):
    files = FileSet()
    told = {"PatientID": "1", "PatientName": "A", "StudyID": "1", "StudyInstanceUID": "1.2.3", "StudyDate": "20260101",
            "StudyTime": "120000", "SeriesNumber": 1}
    for file in sorted(save(folder.with_name("series"), stack(ramp("i2"), change=lambda i: told)).iterdir()):
        files.add(file)
    files.write(folder)
    return sorted(file for file in folder.rglob("*") if file.is_file() and file.name != "DICOMDIR")


def test_images_that_the_index_lists_and_the_disc_lacks_are_noted(tmp_path):
    files = disc(tmp_path / "disc")
    assert len(files) == 5 and not palpate.load(tmp_path / "disc").notes
    files[-1].unlink()
    loaded = palpate.load(tmp_path / "disc")
    assert any("lists 1 images that are not in the folder" in note for note in loaded.notes), loaded.notes
    assert len(loaded.volume.array) == 4


@pytest.mark.parametrize("name", (str.lower, lambda name: name + ";1", lambda name: name + ".dcm", lambda name: name + "."))
def test_names_of_a_disc_may_be_written_as_discs_are_copied(tmp_path, name):
    for file in disc(tmp_path / "disc"):
        file.rename(file.with_name(name(file.name)))
    loaded = palpate.load(tmp_path / "disc")
    assert numpy.array_equal(loaded.volume.array, ramp("i2")) and not loaded.notes


def test_an_index_of_other_names_says_nothing(tmp_path):
    for i, file in enumerate(disc(tmp_path / "disc")):
        file.rename(file.with_name(f"renamed{i}"))
    assert not palpate.load(tmp_path / "disc").notes


# Compression ------------------------------------------------------------------------------------------


def test_a_jpeg_2000_file_in_place_of_its_code_stream_is_no_damage(tmp_path):
    array = (numpy.arange(32 * 32).reshape(32, 32) * 7 % 4096).astype("u2")
    packed = io.BytesIO()
    Image.fromarray(array).save(packed, "JPEG2000", irreversible=False)
    assert packed.getvalue()[4:8] == b"jP  "
    data = slice_of(array, 1, (0, 0, 0), PixelData=encapsulate([packed.getvalue()]))
    data["PixelData"].is_undefined_length = True
    folder = save(tmp_path / "a", [data])
    file = pydicom.dcmread(folder / "001.dcm")
    file.file_meta.TransferSyntaxUID = "1.2.840.10008.1.2.4.90"
    file.save_as(folder / "001.dcm")
    loaded = palpate.load(folder)
    assert numpy.array_equal(loaded.volume.array[0], array)
    assert not any("damage in" in note for note in loaded.notes), loaded.notes
