"""Families of DICOM files that pydicom writes: time steps, frames, kinds of images, values. Each is compared with the arrays
it was made of, or with pydicom."""

import io
import random

import numpy
import palpate
import pydicom
import pytest
from PIL import Image
from pydicom.encaps import encapsulate
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.fileset import FileSet

from readers_test import SYNTAXES, expect_pydicoms, noted, ramp, refused, save, slice_of, stack


def items(**values):
    """A sequence of one item."""
    one = Dataset()
    for name, value in values.items():
        setattr(one, name, value)
    return [one]


# Time steps of files with one frame -----------------------------------------------------------------

PLACES, STEPS = 5, 3
NUMBERS = {"by time": lambda t, z: t * PLACES + z + 1, "by place": lambda t, z: z * STEPS + t + 1,
           "repeated": lambda t, z: z + 1, "shuffled": lambda t, z: (t * PLACES + z) * 7 % 16 + 1}
KEYS = {"temporal position": lambda t, z: {"TemporalPositionIdentifier": t + 1},
        "trigger time": lambda t, z: {"TriggerTime": 30.5 * t},
        "acquisition time": lambda t, z: {"AcquisitionTime": f"1159{57 + t}.5"},
        "acquisition of each slice": lambda t, z: {"AcquisitionDate": "20260101", "AcquisitionTime": f"10{t:02}{z:02}"},
        "acquisition number": lambda t, z: {"AcquisitionNumber": t + 1},
        "nothing": lambda t, z: {}}


def played(folder, key, numbers, places=PLACES):
    """`STEPS` volumes whose samples are 1000 apart, in files of random names."""
    rng = random.Random(1)
    slices = []
    for t in range(STEPS):
        for z in range(places):
            more = key(t, z)
            data = slice_of(ramp("i2")[z] + 1000 * t, numbers(t, z), (1, 2, 3 + 2 * z), **more)
            data.SOPInstanceUID = f"1.2.3.{t}.{z}"
            slices.append(data)
    rng.shuffle(slices)
    folder.mkdir()
    for i, data in enumerate(slices):
        save(folder / str(i), [data])
        (folder / str(i) / f"{data.InstanceNumber:03}.dcm").rename(folder / f"{i:03}.dcm")
        (folder / str(i)).rmdir()
    return folder


def expect_steps(path, steps=STEPS, array=None):
    array = ramp("i2") if array is None else array
    for t in range(steps):
        loaded = palpate.load(path, frame=t)
        assert loaded.time_steps == steps
        assert numpy.array_equal(loaded.volume.array, array + 1000 * t), t


@pytest.mark.parametrize("numbers", NUMBERS)
@pytest.mark.parametrize("key", KEYS)
def test_a_time_step_is_one_moment_at_every_place(tmp_path, key, numbers):
    folder = played(tmp_path / "a", KEYS[key], NUMBERS[numbers])
    if key == "nothing" and numbers in ("repeated", "shuffled"):
        return refused(folder, "belong together")
    expect_steps(folder)


def test_places_of_different_moments_are_refused_or_noted(tmp_path):
    apart = played(tmp_path / "a", lambda t, z: {"TemporalPositionIdentifier": t + 1 + (z == 2)}, NUMBERS["by place"])
    refused(apart, "belong together")
    late = played(tmp_path / "b", lambda t, z: {"TriggerTime": 30 * (t + (z == 2))}, NUMBERS["by place"])
    noted(late, "TriggerTime is not the same at every place")


def test_steps_of_a_moving_table_are_at_one_place(tmp_path):
    slices = []
    for t in range(2):
        for data in stack(ramp("i2") + 1000 * t, start=3 + 0.01 * t):
            data.InstanceNumber += 5 * t
            data.SOPInstanceUID += f".{t}"
            slices.append(data)
    expect_steps(save(tmp_path / "a", slices), 2)


def test_slices_of_one_position_lie_at_their_slice_location(tmp_path):
    slices = [slice_of(plane, i + 1, (1, 2, 3), SliceLocation=20 - 3 * i) for i, plane in enumerate(ramp("i2"))]
    volume = noted(save(tmp_path / "a", slices), "all have one position")
    assert volume.geometry.spacing[2] == 3 and numpy.array_equal(volume.array, ramp("i2")[::-1])


@pytest.mark.parametrize("kinds", ({"ImageType": "DERIVED\\PRIMARY\\DIXON\\WATER"}, {"ImageType": "DERIVED\\PRIMARY\\DIXON\\FAT"}),
                         ids=("water", "fat"))
def test_contrasts_of_one_series_are_chosen_and_not_played(tmp_path, kinds):
    other = {"ImageType": "DERIVED\\PRIMARY\\DIXON\\IN_PHASE"}
    slices = stack(ramp("i2"), change=lambda i: other) + stack(ramp("i2") + 1000, change=lambda i: kinds)
    expect_two_series(numbered(tmp_path / "a", slices), kinds["ImageType"].split("\\")[-1])


def test_a_type_of_one_slice_makes_no_series_where_no_place_has_two(tmp_path):
    change = lambda i: {"ImageType": "ORIGINAL\\PRIMARY\\AXIAL" + ("\\FIRST" if i == 0 else "")}
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", stack(ramp("i2"), change=change))).volume.array, ramp("i2"))


def test_echo_times_that_were_measured_for_each_slice_make_no_series(tmp_path):
    slices = stack(ramp("i2"), change=lambda i: {"EchoTime": 30 + 0.004 * i})
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", slices)).volume.array, ramp("i2"))
    slices += stack(ramp("i2") + 1000, change=lambda i: {"EchoTime": 31 + 0.004 * i})
    expect_two_series(numbered(tmp_path / "b", slices), "echo time 31 ms")


def test_a_gap_between_three_slices_is_filled_at_the_distance_of_two(tmp_path):
    slices = [data for i, data in enumerate(stack(ramp("i2")[:4])) if i != 2]
    volume = noted(save(tmp_path / "a", slices), "1 of 4 slices are missing")
    assert volume.geometry.spacing[2] == 2 and numpy.array_equal(volume.array[[0, 1, 3]], ramp("i2")[[0, 1, 3]])


def numbered(folder, slices):
    for number, data in enumerate(slices):
        data.InstanceNumber, data.SOPInstanceUID = number + 1, f"1.2.3.{number}"
    return save(folder, slices)


def expect_two_series(path, word):
    with pytest.raises(palpate.SeriesChoice) as caught:
        palpate.load(path)
    assert any(word in series["description"] for series in caught.value.series), caught.value.series
    volumes = [palpate.load(path, series=str(number)).volume.array for number in (1, 2)]
    volumes.sort(key=lambda array: array.min())
    assert numpy.array_equal(volumes[0], ramp("i2")) and numpy.array_equal(volumes[1], ramp("i2") + 1000)


# Enhanced files: many frames with functional groups -------------------------------------------------

SHUFFLED = numpy.random.default_rng(3).permutation(2 * PLACES)


def enhanced(path, planes, places, group, syntax="explicit", number=1, volume=False, **changes):
    """`group(i)` are functional groups of frame i."""
    data = slice_of(planes[0], number, (0, 0, 0), NumberOfFrames=len(planes), PixelData=numpy.stack(planes).tobytes(),
                    SOPClassUID="1.2.840.10008.5.1.4.1.1.4.1", Modality="MR", **changes)
    for name in ("ImagePositionPatient", "ImageOrientationPatient", "PixelSpacing", "SliceThickness"):
        delattr(data, name)
    shared = Dataset()
    shared.PixelMeasuresSequence = items(PixelSpacing=[0.5, 0.25], SliceThickness=2)
    axes = [1, 0, 0, 0, 1, 0]
    if volume:
        shared.PlaneOrientationVolumeSequence = items(ImageOrientationVolume=axes)
    else:
        shared.PlaneOrientationSequence = items(ImageOrientationPatient=axes)
    data.SharedFunctionalGroupsSequence = [shared]
    frames = []
    for i, z in enumerate(places):
        frame = Dataset()
        if volume:
            frame.PlanePositionVolumeSequence = items(ImagePositionVolume=[1.0, 2.0, 3.0 + 2 * z])
        else:
            frame.PlanePositionSequence = items(ImagePositionPatient=[1, 2, 3 + 2 * int(z)])
        frame.FrameContentSequence = items(StackID="1")
        for name, value in group(i).items():
            setattr(frame.FrameContentSequence[0] if name in CONTENT else frame, name, value)
        frames.append(frame)
    data.PerFrameFunctionalGroupsSequence = frames
    return save(path, [data], syntax)


CONTENT = ("DimensionIndexValues", "TemporalPositionIndex", "FrameAcquisitionDateTime")
FRAMES = numpy.concatenate([ramp("u2"), ramp("u2") + 1000])
MOMENTS = {"dimensions": lambda t, z: {"DimensionIndexValues": [z + 1, t + 1]},
           "temporal position": lambda t, z: {"TemporalPositionIndex": t + 1},
           "trigger delay": lambda t, z: {"CardiacSynchronizationSequence": items(NominalCardiacTriggerDelayTime=10.0 + 500 * t)},
           "time": lambda t, z: {"FrameAcquisitionDateTime": f"20260101235959.{5 * t}"},
           "offset": lambda t, z: {"TemporalPositionSequence": items(TemporalPositionTimeOffset=1.5 * t)}}
KINDS = {"b-value 1000": lambda t: {"MRDiffusionSequence": items(DiffusionBValue=1000.0 * t)},
         "echo time 9": lambda t: {"MREchoSequence": items(EffectiveEchoTime=2.0 + 7 * t)},
         "segment 2 liver": lambda t: {"SegmentIdentificationSequence": items(ReferencedSegmentNumber=t + 1)}}


@pytest.mark.parametrize("syntax", ("explicit", "implicit", "big"))
@pytest.mark.parametrize("moment", MOMENTS)
def test_frames_of_one_moment_are_one_time_step(tmp_path, moment, syntax):
    group = lambda i: MOMENTS[moment](int(SHUFFLED[i] // PLACES), int(SHUFFLED[i] % PLACES))
    expect_steps(enhanced(tmp_path / "a", FRAMES[SHUFFLED], SHUFFLED % PLACES, group, syntax), 2)


@pytest.mark.parametrize("dimensions", (True, False))
@pytest.mark.parametrize("kind", KINDS)
def test_frames_of_another_kind_are_a_series_of_their_own(tmp_path, kind, dimensions):
    group = lambda i: {**KINDS[kind](int(SHUFFLED[i] // PLACES)), **(
        {"DimensionIndexValues": [int(SHUFFLED[i] // PLACES) + 1, int(SHUFFLED[i] % PLACES) + 1]} if dimensions else {})}
    segments = [items(SegmentNumber=n, SegmentLabel=name)[0] for n, name in ((1, "bone"), (2, "liver"))]
    expect_two_series(enhanced(tmp_path / "a", FRAMES[SHUFFLED], SHUFFLED % PLACES, group, SegmentSequence=segments), kind)


def test_files_of_many_frames_are_in_the_order_of_their_numbers(tmp_path):
    folder = tmp_path / "a"
    folder.mkdir()
    for t, name in ((0, "z"), (1, "b")):
        part = enhanced(tmp_path / name, ramp("u2") + 1000 * t, range(PLACES), lambda i: {}, number=t + 1)
        (part / f"{t + 1:03}.dcm").rename(folder / name)
    expect_steps(folder, 2)


def test_frames_of_an_ultrasound_volume_lie_in_its_space(tmp_path):
    group = lambda i: MOMENTS["offset"](int(SHUFFLED[i] // PLACES), 0)
    folder = enhanced(tmp_path / "a", FRAMES[SHUFFLED], SHUFFLED % PLACES, group, volume=True)
    expect_steps(folder, 2)
    geometry = palpate.load(folder).volume.geometry
    assert numpy.allclose(geometry.origin, (1, 2, 3)) and geometry.spacing[2] == 2 and not geometry.oriented


def unplaced(path, group, kind="1.2.840.10008.5.1.4.1.1.4.1", **changes):
    """Five frames without a position."""
    folder = enhanced(path, ramp("u2"), range(PLACES), group, **changes)
    data = pydicom.dcmread(folder / "001.dcm")
    data.SOPClassUID = kind
    for frame in data.PerFrameFunctionalGroupsSequence:
        del frame.PlanePositionSequence
    data.save_as(folder / "001.dcm")
    return folder


def test_tiles_of_a_slide_are_no_slices(tmp_path):
    refused(unplaced(tmp_path / "a", lambda i: {}, TotalPixelMatrixRows=8, TotalPixelMatrixColumns=18), "microscope")
    whole = unplaced(tmp_path / "b", lambda i: {}, TotalPixelMatrixRows=4, TotalPixelMatrixColumns=6)
    assert numpy.array_equal(palpate.load(whole).volume.array, ramp("u2"))


def test_x_rays_from_several_directions_are_no_slices_and_those_from_one_are_moments(tmp_path):
    from_side = lambda turned: lambda i: {"PositionerPositionSequence": items(
        PositionerPrimaryAngle=turned * i, PositionerSecondaryAngle=5)}
    kind = "1.2.840.10008.5.1.4.1.1.12.1.1"
    refused(unplaced(tmp_path / "a", from_side(2), kind), "projections")
    loaded = palpate.load(unplaced(tmp_path / "b", from_side(0), kind), frame=2)
    assert loaded.time_steps == PLACES and numpy.array_equal(loaded.volume.array, ramp("u2")[2:3])


# Frames without functional groups --------------------------------------------------------------------


def frames_of(array, **changes):
    return slice_of(array[0], 1, (1, 2, 3), NumberOfFrames=len(array), PixelData=array.tobytes(), **changes)


@pytest.mark.parametrize("pointer", (0x3004000C, None))
def test_a_dose_grid_lies_at_its_offsets_with_and_without_a_pointer_to_them(tmp_path, pointer):
    data = frames_of(ramp("u2"), Modality="RTDOSE", SOPClassUID="1.2.840.10008.5.1.4.1.1.481.2", SliceThickness=None,
                     GridFrameOffsetVector=[0, 2.5, 5, 7.5, 10], DoseGridScaling=2, DoseUnits="GY")
    if pointer:
        data.FrameIncrementPointer = pointer
    loaded = palpate.load(save(tmp_path / "a", [data]))
    assert loaded.volume.geometry.spacing[2] == 2.5 and not loaded.notes
    assert numpy.array_equal(loaded.volume.array, ramp("u2") * 2)


def test_frames_counted_by_location_or_page_are_slices(tmp_path):
    for name, tag, more in (("a", 0x00182005, {"SliceLocationVector": [5, 6.5, 8, 9.5, 11]}),
                            ("b", 0x00182001, {"PageNumberVector": [1, 2, 3, 4, 5], "SliceThickness": 1.5})):
        volume = palpate.load(save(tmp_path / name, [frames_of(ramp("u2"), FrameIncrementPointer=tag, **more)])).volume
        assert volume.geometry.spacing[2] == 1.5 and numpy.array_equal(volume.array, ramp("u2"))


@pytest.mark.parametrize("kind", ("3.1", "12.1", "12.2"))
def test_frames_of_a_film_are_moments_where_nothing_says_that_they_are_slices(tmp_path, kind):
    film = {"SOPClassUID": f"1.2.840.10008.5.1.4.1.1.{kind}", "ImageOrientationPatient": None, "CineRate": 20}
    data = frames_of(ramp("u2"), **film, ImagePositionPatient=None)
    loaded = palpate.load(save(tmp_path / "a", [data]), frame=3)
    assert loaded.time_steps == 5 and numpy.array_equal(loaded.volume.array, ramp("u2")[3:4])
    assert not any("how much time" in note for note in loaded.notes)
    data = frames_of(ramp("u2"), **film, SpacingBetweenSlices=3)
    volume = palpate.load(save(tmp_path / "b", [data])).volume
    assert volume.geometry.spacing[2] == 3 and numpy.array_equal(volume.array, ramp("u2"))


def test_a_number_of_frames_may_have_a_sign(tmp_path):
    folder = save(tmp_path / "a", [frames_of(ramp("u2"), SpacingBetweenSlices=2)])
    path = folder / "001.dcm"
    path.write_bytes(path.read_bytes().replace(b"\x28\x00\x08\x00IS\x02\x005 ", b"\x28\x00\x08\x00IS\x02\x00+5"))
    assert numpy.array_equal(palpate.load(folder).volume.array, ramp("u2"))


# Samples ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", ((4, 8, 8), (3, 13, 12), (4, 5, 3)))
def test_samples_of_one_bit_are_zero_or_one_in_each_slice_and_each_frame(tmp_path, shape):
    mask = numpy.random.default_rng(0).integers(0, 2, shape).astype("u1")
    bits = lambda array: numpy.packbits(array.ravel(), bitorder="little").tobytes()
    single = {"BitsAllocated": 1, "BitsStored": 1, "HighBit": 0}
    slices = stack(mask, change=lambda i: {**single, "PixelData": bits(mask[i]) + b"\0" * (len(bits(mask[i])) % 2)})
    frames = slice_of(mask[0], 1, (1, 2, 3), **single, NumberOfFrames=len(mask), SpacingBetweenSlices=2,
                      PixelData=bits(mask) + b"\0" * (len(bits(mask)) % 2))
    for name, files in (("slices", slices), ("frames", [frames])):
        assert numpy.array_equal(palpate.load(save(tmp_path / name, files)).volume.array, mask), name


@pytest.mark.parametrize("stored, intercept", ((16, 32768), (12, 2048), (12, 8192), (16, 40000), (16, -1e6)))
def test_signed_samples_are_rescaled_whatever_their_range(tmp_path, stored, intercept):
    array = ramp("i2") - 300
    change = lambda i: {"BitsStored": stored, "HighBit": stored - 1, "RescaleIntercept": intercept}
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", stack(array, change=change))).volume.array,
                             array.astype("i8") + int(intercept))


@pytest.mark.parametrize("dtype", ("u2", "i2"))
def test_bits_that_are_not_stored_do_not_count(tmp_path, dtype):
    array = ramp(dtype) - (100 if dtype == "i2" else 0)
    slices = stack((array.view("u2") & 0x0FFF | 0xA000).view(dtype), change=lambda i: {"BitsStored": 12, "HighBit": 11})
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", slices)).volume.array, array)


@pytest.mark.parametrize("kind", ("1.3.46.670589.11.0.0.12.2", "1.2.840.10008.5.1.4.1.1.66.7", "1.2.840.10008.5.1.4.1.1.30"))
def test_classes_of_objects_that_no_library_knows_are_read(tmp_path, kind):
    slices = stack(ramp("i2"), change=lambda i: {"SOPClassUID": kind})
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", slices)).volume.array, ramp("i2"))


@pytest.mark.parametrize("name, dtype", (("FloatPixelData", "f4"), ("DoubleFloatPixelData", "f8")))
def test_samples_that_are_not_whole_numbers_are_read(tmp_path, name, dtype):
    real = lambda i: {name: (ramp(dtype)[i] / 7).tobytes(), "BitsAllocated": 8 * numpy.dtype(dtype).itemsize,
                      "PixelData": None, "BitsStored": None, "HighBit": None, "PixelRepresentation": None}
    volume = palpate.load(save(tmp_path / "a", stack(ramp("i2"), change=real))).volume
    assert numpy.array_equal(volume.array, (ramp(dtype) / 7).astype("f4"))


def test_an_image_without_samples_is_named(tmp_path):
    refused(save(tmp_path / "a", stack(ramp("i2"), change=lambda i: {"PixelData": None} if i == 2 else {})), "003.dcm", "no samples")


def coded(folder, array, fragments, **changes):
    """JPEG 2000 without loss, each frame in a number of fragments."""
    SYNTAXES["JPEG 2000"] = "1.2.840.10008.1.2.4.90"
    slices = stack(array, change=lambda i: changes)
    for data, plane in zip(slices, array):
        out = io.BytesIO()
        Image.fromarray(plane).save(out, "JPEG2000", irreversible=False, no_jp2=True)
        data.PixelData = encapsulate([out.getvalue()], fragments_per_frame=fragments)
        data["PixelData"].is_undefined_length = True
    return save(folder, slices, "JPEG 2000")


@pytest.mark.parametrize("shape", ((3, 4, 6), (3, 5, 3)))  # of even and odd length
@pytest.mark.parametrize("dtype", ("u1", "i2"))
def test_fragments_without_compression_are_frames(tmp_path, dtype, shape):
    SYNTAXES["in fragments"] = "1.2.840.10008.1.2.1.98"
    array = ramp(dtype, shape)
    array[:, -1, -1] = 0xD9  # the end of a code stream, and zeros behind it, are samples here
    data = frames_of(array, SpacingBetweenSlices=2)
    for name, planes in (("whole", array), ("cut", array[:, 1:])):
        data.PixelData = encapsulate([plane.tobytes() for plane in planes])
        data["PixelData"].is_undefined_length = True
        folder = save(tmp_path / name, [data], "in fragments")
        if name == "cut":
            refused(folder, "its header asks for")
        else:
            loaded = palpate.load(folder)
            assert numpy.array_equal(loaded.volume.array, array) and not loaded.notes


@pytest.mark.parametrize("fragments", (1, 3))
def test_streams_with_padding_or_in_fragments_are_not_called_damaged(tmp_path, fragments):
    for size in range(40, 48):  # of odd and even length
        array = numpy.random.default_rng(size).integers(0, 4096, (2, size, 20)).astype("u2")
        loaded = palpate.load(coded(tmp_path / str(size), array, fragments, BitsStored=12, HighBit=11))
        assert numpy.array_equal(loaded.volume.array, array) and not any("warned" in note for note in loaded.notes), loaded.notes


def test_a_stream_of_fewer_bits_than_are_allocated_is_read(tmp_path):
    array = ramp("u1", (2, 40, 20))
    folder = coded(tmp_path / "a", array, 1, BitsAllocated=16, BitsStored=16, HighBit=15)
    assert numpy.array_equal(palpate.load(folder).volume.array, array)


def jpeg(folder, array, padding):
    """JPEG, 8 bits, with bytes behind the end marker."""
    SYNTAXES["JPEG"] = "1.2.840.10008.1.2.4.50"
    slices = stack(array)
    for data, plane in zip(slices, array):
        out = io.BytesIO()
        Image.fromarray(plane).save(out, "JPEG", quality=95)
        data.PixelData = encapsulate([out.getvalue() + padding])
        data["PixelData"].is_undefined_length = True
    return save(folder, slices, "JPEG")


def test_a_jpeg_stream_may_be_padded_with_ones(tmp_path):
    array = numpy.full((2, 40, 20), 100, "u1")
    for number, padding in enumerate((b"", b"\xff", b"\xff\xff\xff", b"\xff\0")):
        loaded = palpate.load(jpeg(tmp_path / str(number), array, padding))
        assert numpy.abs(loaded.volume.array.astype(int) - 100).max() < 3
        assert not any("warned" in note for note in loaded.notes), loaded.notes


# Folders with broken slices -------------------------------------------------------------------------


def broken(path, name, data):
    save(path, stack(ramp("u2")))
    if "." not in name:
        for slice_ in path.iterdir():
            slice_.rename(path / f"IM{slice_.stem}")
    (path / name).write_bytes(data)
    return path


@pytest.mark.parametrize("name, words", (
    ("009.dcm", "is no DICOM file"), ("cut.DCM", "is no DICOM file"), ("009.ima", "is no DICOM file"),
    ("009.dcm.gz", "is no DICOM file"), ("IM009", "is no DICOM file")))
def test_a_broken_slice_is_named_and_never_passed_over(tmp_path, name, words):
    for number, data in enumerate((b"<html>404</html>", bytes(1000), bytes(100))):
        refused(broken(tmp_path / str(number), name, data), f"'{name}'", words)
    refused(broken(tmp_path / "empty", name, b""), f"'{name}'", "is empty (0 bytes)")


def test_an_empty_file_with_a_number_among_slices_without_an_extension_is_named(tmp_path):
    refused(broken(tmp_path / "a", "scan7", b""), "'scan7'", "is empty")


def test_an_empty_file_beside_the_list_of_a_disc_is_no_slice(tmp_path):
    disc = FileSet()
    for file in save(tmp_path / "series", stack(ramp("u2"), change=lambda _: {
            "PatientID": "1", "PatientName": "A", "StudyID": "1", "StudyInstanceUID": "1.2.3", "StudyDate": "20260101", "StudyTime": "120000",
            "SeriesNumber": 1})).iterdir():
        disc.add(file)
    disc.write(tmp_path / "disc")
    (tmp_path / "disc" / "LICENSE").write_bytes(b"")
    assert numpy.array_equal(palpate.load(tmp_path / "disc").volume.array, ramp("u2"))


@pytest.mark.parametrize("name, data", (
    ("notes.txt", b"seen"), ("empty.txt", b""), ("Thumbs.db", bytes(99)), ("._001.dcm", bytes(99)), ("a.xml", b"<a/>"),
    ("README", b"a disc"), ("001.jpg", b"picture"), ("VERSION", b"1")))
def test_other_files_among_slices_are_passed_over(tmp_path, name, data):
    loaded = palpate.load(broken(tmp_path / "a", name, data))
    assert numpy.array_equal(loaded.volume.array, ramp("u2")) and not loaded.notes


# Headers and samples that do not fit ----------------------------------------------------------------

def test_bits_above_the_stored_ones_are_shifted_down_in_run_lengths_too(tmp_path):
    array = ramp("u2")
    slices = stack(array << 4, change=lambda i: {"BitsStored": 12, "HighBit": 15})
    for syntax in ("explicit", "RLE"):
        assert numpy.array_equal(noted(save(tmp_path / syntax, slices), "shifted down").array, array)


def test_real_numbers_in_a_code_stream_are_refused(tmp_path):
    folder = coded(tmp_path / "a", ramp("u1", (2, 40, 20)), 1)
    for path in folder.iterdir():
        data = path.read_bytes()  # FloatPixelData of one byte a sample, where four are trusted
        path.write_bytes(data.replace(b"\xe0\x7f\x10\x00OB", b"\xe0\x7f\x08\x00OF"))
    refused(folder, "export it again")


def test_real_numbers_of_a_size_that_comes_after_them_are_refused(tmp_path):
    slices = stack(ramp("u1"), change=lambda i: {"FloatPixelData": bytes(24), "PixelData": None})
    folder = save(tmp_path / "a", slices)
    for path in folder.iterdir():
        data = path.read_bytes()
        at, pixels = data.index(b"\x28\x00\x10\x00US"), data.index(b"\xe0\x7f\x08\x00OF")
        path.write_bytes(data[:at] + data[pixels:] + data[at:pixels])
    refused(folder)


def test_single_bits_in_big_endian_words_are_refused(tmp_path):
    slices = stack(ramp("u1"), change=lambda i: {"BitsAllocated": 1, "BitsStored": 1, "HighBit": 0, "Rows": 16, "Columns": 16})
    for data in slices:
        data.add_new((0x7fe0, 0x0010), "OW", bytes(32))
    refused(save(tmp_path / "a", slices, "big"), "little-endian")


def test_big_endian_words_are_read_also_where_they_are_called_bytes(tmp_path):
    array = ramp("u2")
    slices = stack(array)
    for data, plane in zip(slices, array):
        data.add_new((0x7fe0, 0x0010), "OB", plane.tobytes())
    expect_pydicoms(save(tmp_path / "a", slices, "big"))


def test_real_numbers_are_not_looked_up_in_a_table(tmp_path):
    table = items(LUTDescriptor=[256, 0, 16], LUTData=numpy.arange(256, dtype="u2").tobytes())
    real = lambda i: {"FloatPixelData": numpy.full((4, 6), numpy.nan, "f4").tobytes(), "BitsAllocated": 32, "PixelData": None,
                      "BitsStored": None, "HighBit": None, "PixelRepresentation": None, "ModalityLUTSequence": table,
                      "RescaleSlope": None, "RescaleIntercept": None}
    refused(save(tmp_path / "a", stack(ramp("i2"), change=real)), "export it again")
