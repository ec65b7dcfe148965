"""Slices of one DICOM series that are of several volumes: stations, parts of complex numbers, contrasts. And the order of
their moments, which clocks, vectors and character sets of the files tell."""

import itertools
import struct

import numpy
import palpate
import pytest

from dicom_readers_test import SHUFFLED, FRAMES, PLACES, enhanced, expect_steps, expect_two_series, frames_of, items, numbered
from readers_test import noted, ramp, refused, save, slice_of, stack


def stations(shift, along=0.0):
    """Two stacks, the second one shifted by so many mm within the plane, and along the normal."""
    first = stack(ramp("i2"))
    second = stack(ramp("i2") + 1000, start=3 + along)
    for data in second:
        x, y, z = data.ImagePositionPatient
        data.ImagePositionPatient = [x + shift[0], y + shift[1], z]
    return first + second


@pytest.mark.parametrize("shift, along", [*itertools.product(((300, 0), (0, -300), (0.8, 0), (0, 0.1)), (0, 4)), ((300, 0), 0.02)])
def test_stations_beside_each_other_are_series_and_no_moments(tmp_path, shift, along):
    folder = numbered(tmp_path / "a", stations(shift, along))
    expect_two_series(folder, "mm")
    places = {tuple(palpate.load(folder, series=n).volume.geometry.origin) for n in ("1", "2")}
    assert places == {(1, 2, 3), (1 + shift[0], 2 + shift[1], 3 + along)}


def test_stations_whose_planes_lie_between_each_other_are_series(tmp_path):
    expect_two_series(numbered(tmp_path / "a", stations((300, 0), 0.7)), "mm")


def test_one_plane_at_several_places_is_a_series_for_each(tmp_path):
    slices = [slice_of(plane, i + 1, (1 + 2 * i, 2, 3)) for i, plane in enumerate(ramp("i2"))]
    refused(save(tmp_path / "a", slices), "5 DICOM series")


def test_tilted_stations_are_refused(tmp_path):
    slices = stations((300, 0))
    for data in slices:
        x, y, z = data.ImagePositionPatient
        data.ImagePositionPatient = [x, y + 0.3 * z, z]
    refused(numbered(tmp_path / "a", slices), "side by side in one plane")


def test_moments_of_tilted_slices_are_moments(tmp_path):
    slices = []
    for t in range(2):
        for data in stack(ramp("i2") + 1000 * t, change=lambda i: {"TemporalPositionIdentifier": t + 1}):
            x, y, z = data.ImagePositionPatient
            data.ImagePositionPatient = [x, y + 0.5 * (z - 3), z]
            slices.append(data)
    assert noted(numbered(tmp_path / "a", slices), "gantry tilt") and palpate.load(tmp_path / "a").time_steps == 2


# Contrasts ------------------------------------------------------------------------------------------

def contrasts(tag, values):
    """Two images at each place, whose order changes from place to place."""
    slices = []
    for z, second in itertools.product(range(PLACES), range(2)):
        which = (second + z // 2) % 2
        slices.append(slice_of(ramp("i2")[z] + 1000 * which, 1, (1, 2, 3 + 2 * z)))
        if values[which] is not None:
            setattr(slices[-1], tag, values[which])
    return slices


TRAITS = {"InversionTime": (100, 900), "FlipAngle": (4, 18), "RepetitionTime": (500, 2000), "KVP": (80, 140), "EchoNumbers": (1, 2),
          "ConvolutionKernel": ("B30f", "B70f"), "ReceiveCoilName": ("C1", "C2"), "ComplexImageComponent": ("MAGNITUDE", "PHASE"),
          "ScanOptions": ("FS", None), "CorrectedImage": (["ATTN", "SCAT"], ["NONE"])}


@pytest.mark.parametrize("tag", TRAITS)
def test_contrasts_are_series_whatever_their_order_at_each_place(tmp_path, tag):
    expect_two_series(numbered(tmp_path / "a", contrasts(tag, TRAITS[tag])), "")


def test_inversion_times_measured_for_each_slice_are_one_contrast(tmp_path):
    slices = contrasts("InversionTime", (100, 900))
    for i, data in enumerate(slices):
        data.InversionTime = float(data.InversionTime) + 0.02 * i
    expect_two_series(numbered(tmp_path / "a", slices), "inversion time")


def test_inversion_times_of_a_film_are_moments(tmp_path):
    slices = contrasts("InversionTime", (100, 900))
    for data in slices:
        data.TriggerTime = float(data.InversionTime) + 7
    expect_steps(numbered(tmp_path / "a", slices), 2)


@pytest.mark.parametrize("tag", ("KVP", "FlipAngle", "ScanOptions"))
def test_a_property_that_follows_the_place_makes_no_series(tmp_path, tag):
    slices = stack(ramp("i2"), change=lambda i: {tag: 10 * i + 10 if tag != "ScanOptions" else "AB"[i % 2]})
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", slices)).volume.array, ramp("i2"))


GROUPS = {"phase": lambda t: {"MRImageFrameTypeSequence": items(
              FrameType=["ORIGINAL", "PRIMARY", "OTHER", "NONE"], ComplexImageComponent=("MAGNITUDE", "PHASE")[t])},
          "flip angle": lambda t: {"MRTimingAndRelatedParametersSequence": items(FlipAngle=(4.0, 18.0)[t])},
          "inversion time": lambda t: {"MRModifierSequence": items(InversionTimes=(100.0, 900.0)[t])},
          "tube voltage": lambda t: {"CTXRayDetailsSequence": items(KVP=(80.0, 140.0)[t])},
          "kernel": lambda t: {"CTReconstructionSequence": items(ConvolutionKernel=("B30f", "B70f")[t])}}


@pytest.mark.parametrize("name", GROUPS)
def test_contrasts_of_frames_are_series(tmp_path, name):
    group = lambda i: {"TemporalPositionIndex": 1, **GROUPS[name](int(SHUFFLED[i] // PLACES))}
    expect_two_series(enhanced(tmp_path / "a", FRAMES[SHUFFLED], SHUFFLED % PLACES, group), name)


# Places and moments ---------------------------------------------------------------------------------

@pytest.mark.parametrize("pointer", (0x00182005, None))
@pytest.mark.parametrize("locations", ([8, 6, 0, 2, 4], [0, 5, 10, 15, 20], [-3, 1, -1, 5, 3]))
def test_frames_without_an_orientation_lie_at_their_slice_locations(tmp_path, locations, pointer):
    more = {} if pointer is None else {"FrameIncrementPointer": pointer}
    data = frames_of(ramp("u2"), SliceLocationVector=locations, ImagePositionPatient=None, ImageOrientationPatient=None, **more)
    volume = noted(save(tmp_path / "a", [data]), "SliceLocationVector")
    assert not volume.geometry.oriented and numpy.array_equal(volume.array, ramp("u2")[numpy.argsort(locations)])
    assert volume.geometry.spacing[2] == numpy.diff(sorted(locations))[0]


def test_frames_at_one_slice_location_are_moments(tmp_path):
    data = frames_of(FRAMES, FrameIncrementPointer=0x00182005, SliceLocationVector=[2 * z for z in range(PLACES)] * 2,
                     ImagePositionPatient=None, ImageOrientationPatient=None)
    expect_steps(save(tmp_path / "a", [data]), 2)


def test_a_vector_of_another_length_is_noted(tmp_path):
    data = frames_of(ramp("u2"), FrameIncrementPointer=0x00182005, SliceLocationVector=[1, 2, 3])
    noted(save(tmp_path / "a", [data]), "SliceLocationVector has 3 numbers for 5 frames")


def test_pages_are_in_the_order_of_their_numbers(tmp_path):
    pages = [30, 10, 20, 50, 40]
    data = frames_of(ramp("u2"), FrameIncrementPointer=0x00182001, PageNumberVector=pages)
    assert numpy.array_equal(palpate.load(save(tmp_path / "a", [data])).volume.array, ramp("u2")[numpy.argsort(pages)])


CLOCKS = {"offsets": [{"AcquisitionDateTime": "20201025025930+0200"}, {"AcquisitionDateTime": "20201025020010+0100"}],
          "an offset beside": [{"AcquisitionDate": "20201025", "AcquisitionTime": "025930", "TimezoneOffsetFromUTC": "+0200"},
                               {"AcquisitionDate": "20201025", "AcquisitionTime": "020010", "TimezoneOffsetFromUTC": "+0100"}],
          "the end of a month": [{"AcquisitionDateTime": "20201001003000+0200"}, {"AcquisitionDateTime": "20200930224500-0000"}],
          "a missing zero": [{"AcquisitionTime": "93015.5"}, {"AcquisitionTime": "101500"}],
          "midnight": [{"AcquisitionDate": "20201231", "AcquisitionTime": "235959.9"}, {"AcquisitionDate": "20210101", "AcquisitionTime": "000000.1"}]}


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.filterwarnings("ignore:Invalid value")
def test_moments_are_in_the_order_of_the_clock(tmp_path, clock):
    slices = []
    for t in (1, 0):
        slices += stack(ramp("i2") + 1000 * t, change=lambda i: CLOCKS[clock][t])
    expect_steps(numbered(tmp_path / "a", slices), 2)


# Text -----------------------------------------------------------------------------------------------

TEXTS = {"ISO_IR 100": "Kopf Schädel", "ISO_IR 144": "Голова", "ISO_IR 192": "頭部", "GB18030": "头部平扫誠", "ISO_IR 13": "ｱｲｳ"}
EXTENDED = {("", "ISO 2022 IR 87"): "頭部単純 CT", ("", "ISO 2022 IR 149"): "머리 CT", ("ISO 2022 IR 100", "ISO 2022 IR 144"): "Schädel"}


@pytest.mark.parametrize("set, text", [*TEXTS.items(), *EXTENDED.items()])
def test_descriptions_are_in_utf_8_whatever_the_character_set(tmp_path, set, text):
    more = {"SpecificCharacterSet": list(set) if isinstance(set, tuple) else set}
    slices = contrasts("InversionTime", (100, 900))
    for data in slices:
        data.SpecificCharacterSet, data.SeriesDescription = more["SpecificCharacterSet"], text
    with pytest.raises(palpate.SeriesChoice) as caught:
        palpate.load(numbered(tmp_path / "a", slices))
    assert all(series["description"].startswith(text) for series in caught.value.series), caught.value.series


def test_bytes_that_no_set_explains_are_shown_as_bytes(tmp_path):
    slices = contrasts("InversionTime", (100, 900))
    for data in slices:
        data.SeriesDescription = "Schadel"
    folder = numbered(tmp_path / "a", slices)
    for path in folder.iterdir():
        path.write_bytes(path.read_bytes().replace(b"Schadel", b"Sch\xe4del"))
    with pytest.raises(palpate.SeriesChoice) as caught:
        palpate.load(folder)
    assert caught.value.series[0]["description"].startswith("Sch\\xe4del")


# Time steps of one series, and what else a reader has to take or refuse ------------------------------

def dynamic(folder, arrays, change=lambda t, z: {}):
    slices = []
    for t, array in enumerate(arrays):
        slices += stack(array, change=lambda z: {"TemporalPositionIdentifier": t + 1, **change(t, z)})
    return numbered(folder, slices)


SCALES = {"fraction": (0.37, 0, "float32"), "below": (1, -5, "float32"), "whole": (2, 0, "float32"), "stored": (1, 0, "uint16")}


@pytest.mark.parametrize("scale", SCALES)
def test_all_time_steps_have_one_type(tmp_path, scale):
    slope, intercept, dtype = SCALES[scale]
    arrays = [ramp("u2") * 0, ramp("u2"), ramp("u2") + 40000]
    folder = dynamic(tmp_path / "a", arrays, lambda t, z: {"RescaleSlope": slope, "RescaleIntercept": intercept})
    for t, array in enumerate(arrays):
        volume = palpate.load(folder, frame=t).volume
        assert volume.array.dtype == dtype and numpy.allclose(volume.array, array.astype("f8") * slope + intercept)


def test_samples_of_fewer_bits_stay_16_bits_in_all_time_steps(tmp_path):
    change = lambda t, z: {"BitsStored": 12, "HighBit": 11, "RescaleIntercept": -1024}
    folder = dynamic(tmp_path / "a", [ramp("u2"), ramp("u2") + 3900], change)
    assert [palpate.load(folder, frame=t).volume.array.dtype for t in (0, 1)] == ["int16", "int16"]


@pytest.mark.parametrize("shift", ((0, 0, 1e-5), (0.01, 0, 0), (0, 0.02, -0.005)))
def test_all_time_steps_lie_on_one_grid(tmp_path, shift):
    place = lambda t, z: {"ImagePositionPatient": [1 + shift[0] * t, 2 + shift[1] * t, 3 + 2 * z + shift[2] * t * (1 + (z == 4))]}
    folder = dynamic(tmp_path / "a", [ramp("i2"), ramp("i2") + 1000], place)
    first, second = (palpate.load(folder, frame=t).volume.geometry for t in (0, 1))
    assert tuple(first.origin) == tuple(second.origin) and tuple(first.spacing) == tuple(second.spacing)
    expect_steps(folder, 2)


def test_each_direction_of_diffusion_is_one_time_step(tmp_path):
    directions = numpy.array([[1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    which = [numpy.roll(range(3), z) for z in range(PLACES)]
    planes = [ramp("u2")[z] + 1000 * int(which[z][k]) for z in range(PLACES) for k in range(3)]
    group = lambda i: {"MRDiffusionSequence": items(
        DiffusionBValue=1000.0, DiffusionGradientDirectionSequence=items(DiffusionGradientOrientation=list(directions[which[i // 3][i % 3]])))}
    expect_steps(enhanced(tmp_path / "a", planes, [z for z in range(PLACES) for _ in range(3)], group), 3)


@pytest.mark.parametrize("axes", ([1.5, 0, 0, 0, 1.5, 0], [1, 0, 0, 0, 0.98, 0], [0.9, 0.1, 0, 0, 1, 0]))
def test_directions_of_another_length_are_refused(tmp_path, axes):
    refused(save(tmp_path / "a", stack(ramp("i2"), change=lambda i: {"ImageOrientationPatient": axes})), "no unit vectors")


def test_directions_nearly_of_length_1_are_noted(tmp_path):
    noted(save(tmp_path / "a", stack(ramp("i2"), change=lambda i: {"ImageOrientationPatient": [1.008, 0, 0, 0, 1, 0]})), "not quite of length 1")


@pytest.mark.parametrize("kind", ("200.2", "68.1", "77.1.5.3", "78.1", "90.1", "131", "9.1.1", "99999", "66.5"))
def test_objects_without_an_image_are_passed_over(tmp_path, kind):
    folder = save(tmp_path / "a", stack(ramp("i2")))
    image = ("ImagePositionPatient", "ImageOrientationPatient", "PixelSpacing", "Rows", "Columns", "PixelData", "BitsAllocated")
    record = slice_of(ramp("i2")[0], 99, (0, 0, 0), SOPClassUID=f"1.2.840.10008.5.1.4.1.1.{kind}", **dict.fromkeys(image))
    (save(tmp_path / "b", [record]) / "099.dcm").rename(folder / "record.dcm")
    assert numpy.array_equal(palpate.load(folder).volume.array, ramp("i2"))
    record.SOPClassUID = "1.2.840.10008.5.1.4.1.1.66.4"
    (save(tmp_path / "c", [record]) / "099.dcm").rename(folder / "record.dcm")
    refused(folder, "no size of its image")


def test_shifts_that_are_no_tilt_are_not_called_one(tmp_path):
    for name, shift in (("a", [0, 0, 1, 0, 0]), ("b", [0, 0, 0, 5, 5])):
        slices = stack(ramp("i2"), change=lambda i: {"ImagePositionPatient": [1 + shift[i] / 8, 2, 3 + 2 * i]})
        noted(save(tmp_path / name, slices), "no gantry tilt")


@pytest.mark.parametrize("implicit", (True, False))
def test_elements_behind_the_samples_are_used(tmp_path, implicit):
    first = slice_of(ramp("i2")[0], 1, (1, 2, 3), RescaleSlope=None, RescaleIntercept=None, ImagePositionPatient=None)
    path = save(tmp_path / "a", [first], "implicit" if implicit else "explicit") / "001.dcm"
    for group, number, vr, value in ((0x20, 0x32, b"DS", b"4\\5\\6 "), (0x28, 0x1052, b"DS", b"-7"), (0x28, 0x1053, b"DS", b"3 ")):
        tag = group.to_bytes(2, "little") + number.to_bytes(2, "little")
        size = len(value).to_bytes(4, "little") if implicit else vr + len(value).to_bytes(2, "little")
        path.write_bytes(path.read_bytes() + tag + size + value)
    volume = noted(path, "stand behind its samples")
    assert numpy.array_equal(volume.array[0], ramp("i2")[0] * 3 - 7) and tuple(volume.geometry.origin) == (4, 5, 6)


NUMBERS = {"none": lambda i: None, "one": lambda i: 1}


@pytest.mark.parametrize("numbers", NUMBERS)
@pytest.mark.parametrize("names", ("{}.dcm", "slice {} of 5.dcm", "{}"))
def test_slices_without_a_place_or_a_number_are_counted_by_their_names(tmp_path, numbers, names):
    planes = numpy.concatenate([ramp("i2"), ramp("i2") + 1000, ramp("i2") + 2000])
    slices = stack(planes, change=lambda i: {"ImagePositionPatient": None, "ImageOrientationPatient": None})
    folder = save(tmp_path / "a", slices)
    for i, path in enumerate(sorted(folder.iterdir())):
        data = path.read_bytes()
        number = f"{i + 1}".encode().ljust(2)
        own = b"\x20\x00\x13\x00IS\x02\x00"
        path.write_bytes(data.replace(own + number, own + (b"1 " if numbers == "one" else b"  ")))
        path.rename(folder / names.format(i + 1))
    assert numpy.array_equal(noted(folder, "numbers in the names of their files").array, planes)
    for i, path in enumerate(sorted(folder.iterdir())):
        path.rename(folder / ("x" * (i + 1) + ".dcm"))
    refused(folder, "nor in which order")


def element(group, number, vr, value):
    value += b" " * (len(value) % 2)
    size = struct.pack("<HI", 0, len(value)) if vr in ("SQ", "OW") else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + vr.encode() + size + value


def test_many_frames_of_few_bytes_are_read(tmp_path):
    places, times = 60, 800
    path = enhanced(tmp_path / "a", [numpy.zeros((2, 2), "u2")] * 2, range(2), lambda i: {}) / "001.dcm"
    head = path.read_bytes()
    head = head[:head.index(b"\x00\x52\x30\x92SQ")].replace(element(0x28, 8, "IS", b"2"), element(0x28, 8, "IS", b"%d" % (places * times)))
    groups = []
    for t, z in itertools.product(range(times), range(places)):
        content = b"".join(element(0x20, number, "UL", struct.pack("<I", value)) for number, value in ((0x9057, z + 1), (0x9128, t + 1)))
        group = element(0x20, 0x9111, "SQ", struct.pack("<HHI", 0xFFFE, 0xE000, len(content)) + content)
        place = element(0x20, 0x32, "DS", b"1\\2\\%d" % (3 + 2 * z))
        group += element(0x20, 0x9113, "SQ", struct.pack("<HHI", 0xFFFE, 0xE000, len(place)) + place)
        groups.append(struct.pack("<HHI", 0xFFFE, 0xE000, len(group)) + group)
    samples = numpy.arange(places * times, dtype="<u2").repeat(4)
    path.write_bytes(head + element(0x5200, 0x9230, "SQ", b"".join(groups)) + element(0x7FE0, 0x10, "OW", samples.tobytes()))
    loaded = palpate.load(path, frame=7)
    assert loaded.time_steps == times and numpy.array_equal(loaded.volume.array[:, 0, 0], numpy.arange(places) + 7 * places)
