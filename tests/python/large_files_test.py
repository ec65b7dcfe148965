"""Files of more than 4 GiB (sparse, so small on disk): samples beyond 2^31 and 2^32 bytes are those that NumPy finds
there."""

import nibabel
import numpy
import palpate
import pytest

SIZE = (1024, 1024, 2200)  # x, y, z of uint16: 4.6 GB
MARKS = {(3, 2, 1): 7, (1000, 5, 1023): 1234, (0, 1023, 1024): 77, (511, 512, 2047): 4321, (1, 0, 2048): 99,
         (1023, 1023, 2199): 65535}


def put_marks(path, start):
    samples = numpy.memmap(path, "<u2", "r+", start, SIZE[::-1])
    for (x, y, z), value in MARKS.items():
        samples[z, y, x] = value
    samples.flush()


def sparse(path, header):
    with open(path, "wb") as file:
        file.write(header)
        file.truncate(len(header) + 2 * SIZE[0] * SIZE[1] * SIZE[2])
    put_marks(path, len(header))


def nrrd(folder):
    path = folder / "a.nrrd"
    sparse(path, b"NRRD0004\ntype: uint16\ndimension: 3\nsizes: %d %d %d\nspacings: 1 1 1\nencoding: raw\n"
           b"endian: little\n\n" % SIZE)
    return path


def detached_nrrd(folder):
    sparse(folder / "a.raw", b"")
    path = folder / "a.nhdr"
    path.write_text("NRRD0004\ntype: uint16\ndimension: 3\nsizes: %d %d %d\nspacings: 1 1 1\nencoding: raw\n"
                    "endian: little\ndata file: a.raw\n" % SIZE)
    return path


def meta(folder):
    sparse(folder / "a.raw", b"")
    path = folder / "a.mhd"
    path.write_text("ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\nElementType = MET_USHORT\nElementSpacing = 1 1 1\n"
                    "ElementByteOrderMSB = False\nElementDataFile = a.raw\n" % SIZE)
    return path


def nifti(folder):
    image = nibabel.Nifti1Header()
    image.set_data_dtype("<u2")
    image.set_data_shape(SIZE)
    image["pixdim"][1:4], image["xyzt_units"], image["vox_offset"], image["magic"] = 1, 2, 352, b"n+1"
    path = folder / "a.nii"
    sparse(path, image.binaryblock + bytes(4))
    return path


@pytest.mark.parametrize("written", [nrrd, detached_nrrd, meta, nifti])
def test_samples_of_large_files_are_where_they_belong(written, tmp_path):
    store = palpate.open_store(written(tmp_path))
    assert tuple(store.levels[0].size) == SIZE
    for mark, value in MARKS.items():
        low = [max(0, i - 1) for i in mark]
        high = [min(n, i + 2) for i, n in zip(mark, SIZE)]
        box = store.read(low, high).array
        expected = numpy.zeros(box.shape, numpy.uint16)
        x, y, z = (i - j for i, j in zip(mark, low))
        expected[z, y, x] = value
        assert numpy.array_equal(box, expected), mark
