"""Random DICOM: series of slices, files of several frames, doses and segmentations. Each generator combines types, syntaxes,
orientations, orders and scalings, and computes the value and the place of every pixel from the standard (PS3.3 C.7.6.2)."""

import numpy
import palpate
import pytest
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.sequence import Sequence
from random_headers_test import try_seeds
from readers_test import SYNTAXES

USUAL = tuple(SYNTAXES)
CT, MR, PT, DOSE = (f"1.2.840.10008.5.1.4.1.1.{kind}" for kind in ("2", "4", "128", "481.2"))
ENHANCED_CT, ENHANCED_MR, SEGMENTS = (f"1.2.840.10008.5.1.4.1.1.{kind}" for kind in ("2.1", "4.1", "66.4"))


def items(**members):
    data = Dataset()
    for name, value in members.items():
        setattr(data, name, value)
    return Sequence([data])


def decimals(numbers):
    """As many digits as a decimal string has."""
    return [float(f"{number:.10g}") for number in numbers]


class Placed:
    """Directions, distances and the origin of a stack, and which values lie where."""

    def __init__(self, dice):
        axes = numpy.linalg.qr(dice.randn(3, 3))[0] if dice.often(0.5) else numpy.eye(3)[:, dice.permutation(3)] * dice.choice([-1, 1], 3)
        self.row, self.column = numpy.round(axes[:, 0], 9), numpy.round(axes[:, 1], 9)
        self.normal = numpy.cross(self.row, self.column)
        self.step = float(dice.one((1, 2.5, 0.3)) * dice.choice([-1, 1]))
        self.between_rows, self.between_columns = dice.one((0.5, 1, 0.125, 3)), dice.one((0.5, 1, 0.25))
        self.origin = dice.origin()
        self.orientation = decimals([*self.row, *self.column])
        self.spacing = [self.between_rows, self.between_columns]

    def position(self, number):
        return decimals(self.origin + self.normal * self.step * number)

    def expect(self, volume, planes):
        """`planes`: by their number, the values of pixels. All others are 0."""
        for number, values in planes.items():
            rows, columns = (place.ravel()[:, None] for place in numpy.indices(values.shape))
            places = self.position(number) + self.row * self.between_columns * columns + self.column * self.between_rows * rows
            indices = numpy.array([volume.geometry.index(place) for place in places])
            x, y, z = numpy.rint(indices).astype(int).T
            assert abs(indices - numpy.rint(indices)).max() < 0.03
            assert numpy.allclose(volume.array[z, y, x].reshape(values.shape), values, rtol=3e-7, atol=1e-30)
        assert volume.geometry.oriented
        assert numpy.isclose(volume.array.sum(dtype="f8"), sum(values.sum(dtype="f8") for values in planes.values()), rtol=1e-5, atol=1e-3)


def image(dice, kind, modality, dtype, stored, shape):
    data = Dataset()
    data.SOPClassUID, data.SOPInstanceUID, data.SeriesInstanceUID = kind, "1.2.3.1", "1.2.4.5"
    data.Modality, data.PatientName, data.SeriesNumber = modality, "Nobody", int(dice.randint(1, 9))
    data.Rows, data.Columns = (int(size) for size in shape)
    data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
    data.BitsAllocated, data.BitsStored, data.HighBit = 8 * numpy.dtype(dtype).itemsize, stored, stored - 1
    data.PixelRepresentation = int(numpy.dtype(dtype).kind == "i")
    return data


def save(data, path, samples, syntax):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = data.SOPClassUID, data.SOPInstanceUID
    meta.TransferSyntaxUID = SYNTAXES[syntax]
    file = FileDataset(str(path), data, file_meta=meta, preamble=b"\0" * 128)
    file.is_little_endian, file.is_implicit_VR = syntax != "big", syntax == "implicit"
    file.PixelData = samples.astype(samples.dtype.newbyteorder("<" if file.is_little_endian else ">")).tobytes()
    file.PixelData += bytes(len(file.PixelData) % 2)
    file["PixelData"].VR = "OW" if syntax == "implicit" or samples.dtype.itemsize > 1 else "OB"
    if syntax == "RLE":
        file.compress("1.2.840.10008.1.2.5")
    file.save_as(path, write_like_original=False)


def stored_numbers(dice, dtype, bits, shape):
    first = -2 ** (bits - 1) if numpy.dtype(dtype).kind == "i" else 0
    return (dice.randint(0, 2 ** bits, shape, dtype="i8") + first).astype(dtype)


SCALINGS = ((1, 0), (1, -1024), (2, 5), (0.5, -3.25), (-1, 0), (1, -32768), (1.7, 0.001))


def scalings(dice, count):
    """A slope and an intercept for each plane: the same, or another slope for each."""
    slope, intercept = dice.one(SCALINGS)
    return [(decimals([slope * (1 + i)])[0], intercept) for i in range(count)] if dice.often(0.3) else [(slope, intercept)] * count


def series(dice, folder):
    kind, modality = dice.one(((CT, "CT"), (MR, "MR"), (PT, "PT")))
    dtype = dice.one(("u1", "i1", "u2", "i2"))
    bits = 8 * numpy.dtype(dtype).itemsize - dice.one((0, 0, 4, 6))
    slices, times, shape = dice.randint(2, 6), dice.one((1, 1, 2, 3)), dice.randint(2, 6, 2)
    order = [(z, t) for t in range(times) for z in range(slices)]
    if dice.often(0.5):
        order.sort()
    placed, by = Placed(dice), dice.one(("TemporalPositionIdentifier", "AcquisitionNumber", "TriggerTime", "AcquisitionTime", ""))
    scaled, names, syntax = scalings(dice, len(order)), dice.permutation(len(order)), dice.one(USUAL)
    planes = [{} for _ in range(times)]
    for number, (z, t) in enumerate(order):
        data = image(dice, kind, modality, dtype, bits, shape)
        data.SOPInstanceUID, data.InstanceNumber = f"1.2.3.{number + 1}", number + 1
        data.ImagePositionPatient, data.ImageOrientationPatient, data.PixelSpacing = placed.position(z), placed.orientation, placed.spacing
        data.SliceThickness = dice.one((1, 7))
        if times > 1 and by:
            setattr(data, by, f"1200{7 * t:02}.5" if by == "AcquisitionTime" else t + 1)
        slope, intercept = scaled[number]
        if (slope, intercept) != (1, 0) or dice.often(0.5):
            data.RescaleSlope, data.RescaleIntercept = slope, intercept
        if dice.often(0.2):
            data.ReferencedImageSequence = items(ReferencedSOPClassUID=kind, Rows=99, PixelSpacing=[9, 9])
        numbers = stored_numbers(dice, dtype, bits, shape)
        planes[t][z] = numbers.astype("f8") * slope + intercept
        save(data, folder / dice.one((f"{names[number]}", f"IM{names[number]}", f"{names[number]}.dcm")), numbers, syntax)
    for time, expected in enumerate(planes):
        loaded = palpate.load(folder, frame=time)
        assert loaded.time_steps == times
        placed.expect(loaded.volume, expected)


def frames(dice, folder):
    kind, modality = dice.one(((ENHANCED_CT, "CT"), (ENHANCED_MR, "MR")))
    dtype, bits = dice.one(("u2", "i2")), dice.one((16, 12))
    slices, times, shape = dice.randint(2, 6), dice.one((1, 1, 2)), dice.randint(2, 6, 2)
    order = [(z, t) for t in range(times) for z in range(slices)]
    dice.shuffle(order)
    placed, scaled = Placed(dice), scalings(dice, len(order))
    shared, groups, planes, stack = Dataset(), [], [{} for _ in range(times)], []
    own = [dice.often(0.5) for _ in range(2)]  # of each frame
    for (z, t), (slope, intercept) in zip(order, scaled):
        group = Dataset()
        group.PlanePositionSequence = items(ImagePositionPatient=placed.position(z))
        group.FrameContentSequence = items(StackID="1", InStackPositionNumber=z + 1, TemporalPositionIndex=t + 1,
                                           DimensionIndexValues=[z + 1, t + 1])
        group.PixelValueTransformationSequence = items(RescaleSlope=slope, RescaleIntercept=intercept, RescaleType="US")
        (group if own[0] else shared).PixelMeasuresSequence = items(PixelSpacing=placed.spacing, SliceThickness=abs(placed.step))
        (group if own[1] else shared).PlaneOrientationSequence = items(ImageOrientationPatient=placed.orientation)
        groups.append(group)
        stack.append(stored_numbers(dice, dtype, bits, shape))
        planes[t][z] = stack[-1].astype("f8") * slope + intercept
    data = image(dice, kind, modality, dtype, bits, shape)
    data.NumberOfFrames, data.InstanceNumber = len(order), 1
    data.PerFrameFunctionalGroupsSequence, data.SharedFunctionalGroupsSequence = Sequence(groups), Sequence([shared])
    save(data, folder / "a.dcm", numpy.stack(stack), dice.one(USUAL))
    for time, expected in enumerate(planes):
        placed.expect(palpate.load(dice.one((folder, folder / "a.dcm")), frame=time).volume, expected)


def dose(dice, folder):
    dtype, slices, shape, placed = dice.one(("u2", "u4")), dice.randint(2, 6), dice.randint(2, 6, 2), Placed(dice)
    numbers, scaling = dice.randint(0, 65536, (slices, *shape)).astype(dtype), dice.one((1, 1e-4, 0.000123456))
    data = image(dice, DOSE, "RTDOSE", dtype, 8 * numbers.dtype.itemsize, shape)
    data.ImagePositionPatient, data.ImageOrientationPatient, data.PixelSpacing = placed.position(0), placed.orientation, placed.spacing
    data.NumberOfFrames, data.FrameIncrementPointer = int(slices), 0x3004000C
    data.GridFrameOffsetVector = decimals(placed.step * numpy.arange(slices))
    data.DoseGridScaling, data.DoseUnits = scaling, "GY"
    save(data, folder / "a.dcm", numbers, dice.one(("implicit", "explicit", "deflated")))
    placed.expect(palpate.load(folder / "a.dcm").volume, {z: plane.astype("f8") * scaling for z, plane in enumerate(numbers)})


def segmentation(dice, folder):
    """One bit per pixel, or fractions. Slices without anything of a segment are left out."""
    bits, greatest, placed = dice.one(((1, 1), (8, 255), (8, 100))) + (Placed(dice),)
    slices, segments, shape = dice.randint(2, 7), dice.one((1, 1, 2, 3)), dice.randint(1, 7, 2)
    order = [(z, s) for s in range(segments) for z in range(slices) if z in (0, slices - 1) or dice.often(0.7)]
    dice.shuffle(order)
    groups, planes, stack = [], [{} for _ in range(segments)], []
    for z, segment in order:
        group = Dataset()
        group.PlanePositionSequence = items(ImagePositionPatient=placed.position(z))
        group.SegmentIdentificationSequence = items(ReferencedSegmentNumber=segment + 1)
        groups.append(group)
        stack.append(dice.randint(0, greatest + 1, shape).astype("u1"))
        planes[segment][z] = stack[-1] / greatest
    shared = Dataset()
    shared.PixelMeasuresSequence = items(PixelSpacing=placed.spacing, SliceThickness=1, SpacingBetweenSlices=abs(placed.step))
    shared.PlaneOrientationSequence = items(ImageOrientationPatient=placed.orientation)
    data = image(dice, SEGMENTS, "SEG", "u1", bits, shape)
    data.SegmentSequence = Sequence([items(SegmentNumber=number + 1, SegmentLabel="a")[0] for number in range(segments)])
    data.BitsAllocated, data.SegmentationType = bits, "BINARY" if bits == 1 else "FRACTIONAL"
    if bits > 1:
        data.MaximumFractionalValue = greatest
    data.NumberOfFrames, data.PerFrameFunctionalGroupsSequence = len(order), Sequence(groups)
    data.SharedFunctionalGroupsSequence = Sequence([shared])
    numbers = numpy.stack(stack)
    if bits == 1:
        numbers = numpy.packbits(numbers.ravel(), bitorder="little")
    save(data, folder / "a.dcm", numbers, dice.one(("implicit", "explicit", "deflated")))
    for segment, expected in enumerate(planes):
        placed.expect(palpate.load(folder / "a.dcm", series=str(segment + 1) if segments > 1 else "").volume, expected)


@pytest.mark.parametrize("generate", (series, frames, dose, segmentation))
def test_random_dicom(tmp_path, generate):
    try_seeds(tmp_path, generate, 20)
