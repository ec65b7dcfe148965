"""Slices of one DICOM series that are of several volumes: stations, parts of complex numbers, contrasts. And the order of
their moments, which clocks, vectors and character sets of the files tell."""

import itertools

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
