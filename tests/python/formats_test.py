"""Files as other programs write them, written by hand or with other libraries: each was once refused or misread. Samples
and places are compared with those that were written."""

import json
import os
import struct
import subprocess

import h5py
import nibabel
import numpy
import palpate
import pytest
import tifffile
from folders_test import folder, slices_of
from readers_test import SHAPE, noted, ramp, refused, save, slice_of, stack


def program(*arguments):
    """All that the program says."""
    done = subprocess.run([os.environ["PALPATE"], *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    return done.stdout


# NRRD ------------------------------------------------------------------------------------------------


def nrrd(path, data, *fields):
    kinds = {"i2": "int16", "u1": "uint8", "f4": "float", "f8": "double", "i8": "int64", "u8": "uint64"}
    sizes = " ".join(str(size) for size in data.shape[::-1])
    head = (f"NRRD0005\ntype: {kinds[data.dtype.str[1:]]}\ndimension: {data.ndim}\nsizes: {sizes}\nendian: little\n"
            "encoding: raw\n")
    path.write_bytes((head + "".join(field + "\n" for field in fields) + "\n").encode() + data.tobytes())
    return path


@pytest.mark.parametrize("space", ("space dimension: 4", "space: left-posterior-superior-time", "space: RAST"))
@pytest.mark.parametrize("unit, seconds", (("", 2), ('space units: "mm" "mm" "mm" "ms"', 0.002)))
def test_nrrd_with_vectors_of_four_numbers_as_itk_writes_it(tmp_path, space, unit, seconds):
    data = ramp("i2", (3, *SHAPE))
    vectors = "space directions: (2,0,0,0) (0,2,0,0) (0,0,3,0) (0,0,0,2)"
    path = nrrd(tmp_path / "a.nrrd", data, space, vectors, "kinds: domain domain domain domain", "space origin: (1,2,3,4)",
                *([unit] if unit else []))
    for frame, expected in enumerate(data):
        loaded = palpate.load(path, frame=frame)
        assert numpy.array_equal(loaded.volume.array, expected)
    flip = -1 if space.endswith("RAST") else 1
    geometry = loaded.volume.geometry
    assert numpy.array_equal(geometry.spacing, (2, 2, 3)) and numpy.array_equal(geometry.origin, (flip, flip * 2, 3))
    assert numpy.array_equal(geometry.direction, numpy.diag([flip, flip, 1]))
    assert geometry.oriented == (space != "space dimension: 4")
    assert f"frames       from {2 * seconds} to {4 * seconds} s" in program("info", path)


@pytest.mark.parametrize("vectors", ("(2,0,0,0) (0,2,0,0) (0,0,3,1) (0,0,0,1)", "(0,0,0,1) (2,0,0,0) (0,2,0,0) (0,0,3,0)",
                                     "(2,0,0,0) (0,2,0,0) (0,0,3,0) (0,0,1,1)"))
def test_nrrd_with_times_among_its_places_is_refused(tmp_path, vectors):
    refused(nrrd(tmp_path / "a.nrrd", ramp("i2", (3, *SHAPE)), "space dimension: 4", f"space directions: {vectors}"),
            "places and times")


def test_a_slice_of_nrrd_lies_in_space(tmp_path):
    slice_ = nrrd(tmp_path / "a.nrrd", ramp("i2")[0], "space: left-posterior-superior", "space directions: (2,0,0) (0,0,3)",
                  "space origin: (1,2,3)")
    volume = palpate.load(slice_).volume
    assert numpy.array_equal(volume.array, ramp("i2")[:1]) and numpy.array_equal(volume.geometry.origin, (1, 2, 3))
    assert numpy.array_equal(volume.geometry.direction[:, :2], [[1, 0], [0, 0], [0, 1]]) and volume.geometry.oriented


PLACED = ("space: left-posterior-superior", "space directions: (2,0,0) (0,2,0) (0,0,3)", "space origin: (7,8,9)")


@pytest.mark.parametrize("fields, words", (
    (("line skip: 9",), "line skip of 9 goes beyond"), (("line skip: -1",), "line skip"),
    (('space units: "um"',), "'space units' has 1 entries for 3 axes"), (('units: "um"',), "'units' has 1 entries for 3 axes"),
    (("units: um um",), "'units' has 2 entries for 3 axes"), (("space origin: (7,8,9)",), "'space origin' twice"),
    (("type: int16",), "'type' twice"), (("centers: cell cell cell", "centerings: cell cell cell"), "'centerings' twice")))
def test_nrrd_headers_that_say_too_much_or_too_little_are_refused(tmp_path, fields, words):
    refused(nrrd(tmp_path / "a.nrrd", ramp("i2") % 9, *PLACED, *fields), words)  # no sample is the end of a line


def test_a_line_of_blanks_is_not_the_end_of_a_nrrd_header_and_keys_may_repeat(tmp_path):
    path = nrrd(tmp_path / "a.nrrd", ramp("i2"), "   ", "key:=1", "key:=2", 'kinds: "space" "space" "space"', *PLACED)
    loaded = palpate.load(path)
    assert numpy.array_equal(loaded.volume.array, ramp("i2")) and not loaded.notes
    assert numpy.array_equal(loaded.volume.geometry.origin, (7, 8, 9))


def test_an_origin_that_a_nrrd_header_leaves_open_is_noted(tmp_path):
    path = nrrd(tmp_path / "a.nrrd", ramp("i2"), *PLACED[:2], "space origin: (nan,nan,nan)")
    assert numpy.array_equal(noted(path, "0 was taken").geometry.origin, (0, 0, 0))


def test_a_nrrd_of_the_time_before_versions_is_read(tmp_path):
    path = nrrd(tmp_path / "a.nrrd", ramp("i2"), *PLACED)
    path.write_bytes(path.read_bytes().replace(b"NRRD0005", b"NRRD00.01"))
    assert numpy.array_equal(palpate.load(path).volume.array, ramp("i2"))


def test_a_meta_image_may_have_colons_in_place_of_equal_signs(tmp_path):
    lines = ("ObjectType: Image", "NDims: 3", "DimSize: 6 4 5", "ElementSpacing: 1 2 3", "ElementType: MET_SHORT",
             "ElementDataFile: LOCAL", "")
    (tmp_path / "a.mha").write_bytes("\n".join(lines).encode() + ramp("i2").tobytes())
    volume = palpate.load(tmp_path / "a.mha").volume
    assert numpy.array_equal(volume.array, ramp("i2")) and numpy.array_equal(volume.geometry.spacing, (1, 2, 3))


def test_samples_twice_as_wide_as_the_header_says_are_refused(tmp_path):
    data = ramp("i2")
    path = nrrd(tmp_path / "a.nrrd", data, *PLACED)
    path.write_bytes(path.read_bytes().replace(b"int16", b"uint8"))
    refused(path, "asks for 120 bytes of samples, there are 240")
    head = "NDims = 3\nDimSize = 6 4 5\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    (tmp_path / "a.mha").write_bytes(head.encode() + data.tobytes())
    refused(tmp_path / "a.mha", "asks for 120 bytes of samples, there are 240")
    (tmp_path / "a.mha").write_bytes(head.encode() + data.tobytes()[:239])  # less may be padding
    noted(tmp_path / "a.mha", "the rest was ignored")
    nibabel.Nifti1Image(data, numpy.eye(4)).to_filename(tmp_path / "a.nii")
    header = bytearray((tmp_path / "a.nii").read_bytes())
    header[70:74] = struct.pack("<2h", 2, 8)
    (tmp_path / "a.nii").write_bytes(header)
    refused(tmp_path / "a.nii", "asks for 120 bytes of samples, there are 240")


# TIFF and SCIFIO ------------------------------------------------------------------------------------


SCIFIO = "SCIFIO=0.37.3\naxes=X,Y,{}\nlengths=6,4,{}\nscales=0.5,0.25,{}\nunits=micron,micron,{}\n"


def test_axes_of_scifio_are_those_of_image_j(tmp_path):
    def written(*axes):
        path = tmp_path / "a.tif"
        tifffile.imwrite(path, ramp("u2", (6, 4, 6)), photometric="minisblack", metadata=None, description=SCIFIO.format(*axes),
                         resolution=(7, 7))
        return path
    loaded = palpate.load(written("Z", "6", "2.0", "micron"))
    assert numpy.array_equal(loaded.volume.array, ramp("u2", (6, 4, 6))) and not loaded.notes
    assert numpy.allclose(loaded.volume.geometry.spacing, (5e-4, 2.5e-4, 2e-3))
    loaded = palpate.load(written("Z,Time", "3,2", "2.0,null", "micron,null"), frame=1)
    assert loaded.time_steps == 2 and numpy.array_equal(loaded.volume.array, ramp("u2", (6, 4, 6))[3:])
    noted(written("Z", "6", "2.0", "null"), "1 mm was taken")
    refused(written("Channel,Z", "2,3", "null,2.0", "null,micron"), "holds 2 channels")
    refused(written("Lifetime,Z", "2,3", "null,2.0", "null,micron"), "holds 2 channels")
    refused(written("Time,Z", "2,3", "null,2.0", "null,micron"), "times before its slices")


@pytest.mark.parametrize("times", (1, 2))
def test_the_first_channel_of_image_j_is_taken(tmp_path, times):
    data = numpy.arange(times * 3 * 2 * 4 * 6, dtype="u2").reshape(times, 3, 2, 4, 6)
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, data, imagej=True, metadata={"axes": "TZCYX", "spacing": 2.0, "unit": "mm"})
    for frame in range(times):
        loaded = palpate.load(path, frame=frame)
        assert numpy.array_equal(loaded.volume.array, data[frame, :, 0]) and loaded.time_steps == times
        assert any("channel 0 (channel 0) of 2 was taken" in note for note in loaded.notes)
    tifffile.imwrite(path, data[0, :, 0], imagej=True)  # without axes, tifffile counts slices as channels
    refused(path, "holds 3 channels of one slice; if they are slices")


def test_a_channel_of_a_tiff_that_is_read_whole_is_refused(tmp_path):
    path = tmp_path / "a.ome.tif"
    tifffile.imwrite(path, ramp("u2", (2, 3, 4, 6)), photometric="minisblack", metadata={"axes": "CZYX"})
    assert "channel 0" in program("info", path) and "does nothing" not in program("info", path)
    assert "channel, memory and all times are for what can be read in parts" in program("info", path, "--channel", 1)


def test_hidden_files_are_no_slices(tmp_path):
    path = folder(tmp_path / "a", ["a1", "a2", ".a0"])
    (path / "._a1.tif").write_bytes(b"\0\5\x16\7\0\2\0\0Mac OS X        " + bytes(100))
    (path / "._b.nrrd").write_bytes(b"\0\5\x16\7\0\2\0\0Mac OS X        " + bytes(100))
    assert slices_of(path)[0] == [0, 1]
    assert slices_of(path / ".a0.tif")[0] == [2]  # given by its name
    refused(folder(tmp_path / "b", [".a1", ".a2"]), "no DICOM or TIFF slices")
    path = save(tmp_path / "c", [slice_of(ramp("i2")[z], z, (0, 0, z)) for z in range(3)])
    (path / ".002.dcm.x7Gf2").write_bytes((path / "002.dcm").read_bytes()[:700])  # as rsync writes it
    assert numpy.array_equal(palpate.load(path).volume.array, ramp("i2")[:3])


# BigDataViewer and N5 -----------------------------------------------------------------------------------


def n5_array(path, data):
    """One block, not compressed."""
    path.mkdir(parents=True)
    size = list(data.shape[::-1])
    (path / "attributes.json").write_text(json.dumps(
        {"dimensions": size, "blockSize": size, "dataType": data.dtype.name, "compression": {"type": "raw"}}))
    (path / "0/0").mkdir(parents=True)
    (path / "0/0/0").write_bytes(struct.pack(">HHIII", 0, 3, *size) + data.astype(data.dtype.newbyteorder(">")).tobytes())


def bdv_n5(path, setup, time, data):
    n5_array(path / f"setup{setup}/timepoint{time}/s0", data)
    for place in (path, path / f"setup{setup}"):
        (place / "attributes.json").write_text(json.dumps({"n5": "2.5.0", "downsamplingFactors": [[1, 1, 1]]}))


def bdv_hdf5(path, setup, time, data):
    with h5py.File(path, "a") as file:
        if f"s{setup:02}" not in file:
            file[f"s{setup:02}/resolutions"], file[f"s{setup:02}/subdivisions"] = [[1.0, 1, 1]], [[4, 3, 2]]
        file.create_dataset(f"t{time:05}/s{setup:02}/0/cells", data=data, chunks=(2, 3, 4))


@pytest.mark.parametrize("write, name", ((bdv_n5, "a.n5"), (bdv_hdf5, "a.h5")))
@pytest.mark.parametrize("setups, times", (((0,), (1, 2)), ((1, 4), (0,)), ((3,), (5, 7, 14)), ((0, 2), (0, 1))))
def test_setups_and_times_of_big_data_viewer_begin_anywhere(tmp_path, write, name, setups, times):
    for setup in setups:
        for time in times:
            write(tmp_path / name, setup, time, ramp("u2", first=100 * setup + 1000 * time))
    for channel, setup in enumerate(setups):
        for index, time in enumerate(times):
            store = palpate.open_store(str(tmp_path / name), channel=channel, time=index)
            assert numpy.array_equal(store.read((0, 0, 0), (6, 4, 5)).array, ramp("u2", first=100 * setup + 1000 * time))
            assert any(f"is its timepoint {time}" in note for note in store.notes) == (time != index)
    for wrong in {"time": len(times)}, {"channel": len(setups)}:
        with pytest.raises(palpate.InputError, match="there is no"):
            palpate.open_store(str(tmp_path / name), **wrong)


@pytest.mark.parametrize("affine, is_noted", (("2 0 0 0 0 3 0 0 0 0 4 0", False), ("2 0 0 9 0 3 0 0 0 0 4 0", True)))
def test_registrations_of_big_data_viewer_that_move_are_noted(tmp_path, affine, is_noted):
    bdv_hdf5(tmp_path / "a.h5", 0, 0, ramp("u2"))
    (tmp_path / "a.xml").write_text(f"""<SpimData><SequenceDescription><ViewSetups><ViewSetup><id>0</id><voxelSize><unit>um
        </unit><size>2 3 4</size></voxelSize></ViewSetup></ViewSetups></SequenceDescription><ViewRegistrations>
        <ViewRegistration><ViewTransform type="affine"><affine>{affine}</affine></ViewTransform></ViewRegistration>
        </ViewRegistrations></SpimData>""")
    assert any("not applied" in note for note in palpate.open_store(str(tmp_path / "a.h5")).notes) == is_noted


JANELIA = {"axes": ["z", "y", "x"], "scale": [4, 3, 2], "translate": [40, 30, 20], "units": ["nm", "nm", "nm"]}
NGFF = [{"type": "scale", "scale": [2, 3, 4]}, {"type": "translation", "translation": [20, 30, 40]}]
NAMED_AXES = [{"name": name, "type": "space", "unit": "nanometer"} for name in "xyz"]


@pytest.mark.parametrize("image", ({"datasets": [{"path": "s0", "transform": JANELIA}]},
                                   {"axes": NAMED_AXES, "datasets": [{"path": "s0", "coordinateTransformations": NGFF}]}))
def test_multiscales_of_an_n5_group_place_its_levels(tmp_path, image):
    n5_array(tmp_path / "s0", ramp("u2"))
    n5_array(tmp_path / "s1", ramp("u2")[:3, :2, :3])  # not in the list
    (tmp_path / "attributes.json").write_text(json.dumps({"multiscales": [image]}))
    store = palpate.open_store(str(tmp_path))
    assert numpy.allclose(store.levels[0].spacing, (2e-6, 3e-6, 4e-6), rtol=1e-9, atol=0)
    assert numpy.allclose(store.levels[0].origin, (2e-5, 3e-5, 4e-5), rtol=1e-9, atol=0)
    assert numpy.allclose(store.levels[1].spacing, (4e-6, 6e-6, 8e-6), rtol=1e-9, atol=0) and not store.notes[:-1]


# Names of data files, and headers that are half filled ---------------------------------------------------


@pytest.mark.parametrize("name", ("50%.raw", "LISTEN.raw", "%.raw", "100%x.raw"))
def test_names_of_data_files_that_look_like_patterns(tmp_path, name):
    (tmp_path / name).write_bytes(ramp("<i2").tobytes())
    (tmp_path / "a.nhdr").write_text("NRRD0004\ntype: short\ndimension: 3\nsizes: 6 4 5\nendian: little\nencoding: raw\n"
                                     f"spacings: 1 1 1\ndata file: {name}\n")
    (tmp_path / "a.mhd").write_text(f"NDims = 3\nDimSize = 6 4 5\nElementType = MET_SHORT\nElementDataFile = {name}\n")
    for header in ("a.nhdr", "a.mhd"):
        assert numpy.array_equal(palpate.load(tmp_path / header).volume.array, ramp("i2"))


@pytest.mark.parametrize("name", ("90%.nhdr", "90%.mha", "LISTE.mhd", "LISTE.nhdr"))
def test_such_names_are_written_and_read_again(tmp_path, name):
    palpate.write(palpate.Volume(ramp("i2")), tmp_path / name)
    assert numpy.array_equal(palpate.load(tmp_path / name).volume.array, ramp("i2"))


def test_a_mhd_whose_name_would_mean_numbered_files_is_not_written(tmp_path):
    with pytest.raises((ValueError, palpate.OutputError), match="name it .mha"):
        palpate.write(palpate.Volume(ramp("i2")), tmp_path / "90%.mhd")


def test_a_nifti_whose_sform_is_empty_has_its_qform(tmp_path):
    image = nibabel.Nifti1Image(ramp("i2").T, numpy.diag([-2, -3, 4, 1]))
    image.set_qform(numpy.diag([-2, -3, 4, 1]), code=1)
    nibabel.save(image, path := tmp_path / "a.nii")
    data = bytearray(path.read_bytes())
    data[254:256], data[280:328] = struct.pack("<h", 1), bytes(48)
    path.write_bytes(data)
    geometry = noted(path, "qform was taken").geometry
    assert numpy.allclose(geometry.spacing, (2, 3, 4)) and geometry.oriented


# VTI ------------------------------------------------------------------------------------------------------

VTI = ('<?xml version="1.0"?><VTKFile type="ImageData" version="0.1" byte_order="LittleEndian"><ImageData '
       'WholeExtent="0 5 0 3 0 4" Origin="1 2 3" Spacing="1 2 3"><Piece Extent="0 5 0 3 0 4"><PointData Scalars="{active}">'
       '{arrays}</PointData></Piece></ImageData></VTKFile>')


def vti_array(name, data, components=1):
    kind = {"i2": "Int16", "u1": "UInt8"}[data.dtype.str[1:]]
    return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">'
            f'{" ".join(map(str, data.ravel()))}</DataArray>')


def test_a_vti_that_vtk_cannot_parse_is_refused_for_that(tmp_path):
    (tmp_path / "a.vti").write_text(VTI.format(active="a & b", arrays=vti_array("a & b", ramp("i2"))))
    for _ in range(3):
        refused(tmp_path / "a.vti", "damaged or no VTI file")


@pytest.mark.parametrize("active", ("vector", "", "density"))
def test_scalars_of_a_vti_are_found_beside_vectors_and_ghosts(tmp_path, active):
    arrays = (vti_array("vtkGhostType", numpy.zeros(SHAPE, "u1")) + vti_array("vector", numpy.zeros((120, 3), "i2"), 3) +
              vti_array("density", ramp("i2")))
    (tmp_path / "a.vti").write_text(VTI.format(active=active, arrays=arrays))
    assert numpy.array_equal(noted(tmp_path / "a.vti", "'density' was taken").array, ramp("i2"))


@pytest.mark.parametrize("change, words", (
    (('WholeExtent="0 5 0 3 0 4"', 'WholeExtent="0 5 0 3 0 8"'), "do not fill its WholeExtent"),
    (('Spacing="1 2 3"', 'Spacing="1 2"'), "Spacing has 2 numbers where 3 belong"),
    (('Origin="1 2 3"', 'Origin = "1 2 3 4"'), "Origin has 4 numbers where 3 belong")))
def test_a_vti_whose_header_does_not_fit_is_refused(tmp_path, change, words):
    text = VTI.format(active="", arrays=vti_array("density", ramp("i2")))
    (tmp_path / "a.vti").write_text(text.replace(*change))
    refused(tmp_path / "a.vti", words)


def test_a_vti_without_spacing_has_one_millimetre_and_that_is_noted(tmp_path):
    text = VTI.format(active="", arrays=vti_array("density", ramp("i2")))
    (tmp_path / "a.vti").write_text(text.replace(' Spacing="1 2 3"', ""))
    assert not noted(tmp_path / "a.vti", "1 mm was taken").geometry.measured
    (tmp_path / "a.vti").write_text(text)
    assert not palpate.load(tmp_path / "a.vti").notes


def test_pieces_of_a_vti_may_share_samples_and_fill_its_extent_together(tmp_path):
    low, high = (vti_array("density", ramp("i2")[part]) for part in (slice(0, 3), slice(2, 5)))
    piece = '<Piece Extent="0 5 0 3 {}"><PointData>{}</PointData></Piece>'
    start = VTI.split("<Piece")[0]
    (tmp_path / "a.vti").write_text(start + piece.format("0 2", low) + piece.format("2 4", high) + "</ImageData></VTKFile>")
    assert numpy.array_equal(palpate.load(tmp_path / "a.vti").volume.array, ramp("i2"))


@pytest.mark.parametrize("wide", (False, True))
def test_raw_samples_of_a_vti_that_a_transfer_as_text_changed_are_refused(tmp_path, wide):
    array = '<DataArray type="Int16" Name="density" format="appended" offset="0"/>'
    head = VTI.format(active="density", arrays=array).replace("</VTKFile>", '<AppendedData encoding="raw">_').encode()
    if wide:
        head = head.replace(b"<VTKFile", b'<VTKFile header_type="UInt64"')
    data = numpy.full(SHAPE, 0x0a0d, "<i2")
    data[-1, -1, -1] = 0x4141
    raw = struct.pack("<Q" if wide else "<I", data.nbytes) + data.tobytes()
    for end in (b"", b" ", b"\n  ", b"\n"):  # VTK's is the third
        end += b"</AppendedData>\n</VTKFile>\n"
        (tmp_path / "a.vti").write_bytes(head + raw + end)
        assert numpy.array_equal(palpate.load(tmp_path / "a.vti").volume.array, data)
    for blanks in (b"\n  ", b"\n"):
        end = blanks + b"</AppendedData>\n</VTKFile>\n"
        for before, after, count in ((b"\r\n", b"\n", 1), (b"\r\n", b"\n", 3), (b"\r\n", b"\n", 30), (b"\n", b"\r\n", 1)):
            (tmp_path / "a.vti").write_bytes(head + raw.replace(before, after, count) + end)
            refused(tmp_path / "a.vti", "transfer as text")


@pytest.mark.parametrize("names, order", (([None] * 3, None), (["x", None, "z"], "an unnamed axis as y")))
def test_dimensions_of_zarr_may_have_no_names(tmp_path, names, order):
    folder = tmp_path / "a.zarr"
    folder.mkdir()
    (folder / "zarr.json").write_text(json.dumps({
        "zarr_format": 3, "node_type": "array", "shape": SHAPE, "data_type": "int16", "fill_value": 0,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": SHAPE}}, "dimension_names": names,
        "chunk_key_encoding": {"name": "v2"}, "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]}))
    (folder / "0.0.0").write_bytes(ramp("i2").tobytes())
    told = program("info", folder)
    assert "6 x 4 x 5" in told if order is None else order in told
    assert ("taken by their order" in told) == (order is not None)


# Outputs over inputs ------------------------------------------------------------------------------------


def test_no_output_replaces_a_file_that_is_read(tmp_path):
    slices = folder(tmp_path / "slices", ["a1", "a2", "a3"])
    for number in range(2):
        nibabel.save(nibabel.Nifti1Image(ramp("i2"), numpy.eye(4)), tmp_path / f"beat_{number}.nii")
    (tmp_path / "hand.csv").write_text("t,x,y,z\n0,0,0,0\n")
    (tmp_path / "set.json").write_text('{"palpate_layers": 1, "layers": [{"name": "a", "level": 100}]}')
    (tmp_path / "points.csv").write_text("x,y,z\n0,0,1\n")
    replay = ("replay", "synthetic:sphere:16x16x16", "--trajectory", tmp_path / "hand.csv")
    layers, tool = ("--layers", tmp_path / "set.json"), ("--isovalue", "50%", "--tool", tmp_path / "points.csv")
    links = tmp_path / "links"
    links.mkdir()
    for number in range(2):
        (links / f"a{number + 1}.tif").symlink_to(slices / f"a{number + 1}.tif")
        (links / f"beat_{number}.nii").symlink_to(tmp_path / f"beat_{number}.nii")
    series = save(tmp_path / "series", stack(ramp("i2")))
    for file in sorted(series.iterdir()):
        file.rename(series / f"I.{file.stem}")
    for output, *words in ((slices / "a2.tif", "convert", slices, slices / "a2.tif"),
                           (series / "I.002", "replay", series, "--isovalue", "50%", *replay[2:], "--output",
                            series / "I.002"),
                           (tmp_path / "beat_1.nii", "convert", tmp_path / "beat_%d.nii", tmp_path / "beat_1.nii"),
                           (slices / "a2.tif", "convert", links, slices / "a2.tif"),
                           (slices / "a2.tif", "convert", links, links / "a2.tif"),
                           (tmp_path / "beat_1.nii", "convert", links / "beat_%d.nii", links / "beat_1.nii"),
                           (tmp_path / "set.json", *replay, *layers, "--output", tmp_path / "set.json"),
                           (tmp_path / "points.csv", *replay, *tool, "--output", tmp_path / "points.csv")):
        before = output.read_bytes()
        assert "is an input and would be replaced" in program(*words)
        assert output.read_bytes() == before
    for _ in range(2):  # other files of these folders may be written, also again
        for words in (("convert", slices, slices / "a.nrrd"), ("convert", tmp_path / "beat_%d.nii", tmp_path / "beat.nii"),
                      (*replay, *layers, "--output", tmp_path / "out.csv")):
            assert "would be replaced" not in program(*words)
            assert words[-1].exists()


def test_an_output_that_cannot_be_written_is_refused_before_the_work(tmp_path):
    (tmp_path / "hand.csv").write_text("t,x,y,z\n0,0,0,0\n")
    replay = ("replay", "synthetic:sphere:16x16x16", "-i", "50%", "--trajectory", tmp_path / "none.csv", "--output")
    assert "cannot be written: File name too long" in program(*replay, tmp_path / ("a" * 300))
    in_no_folder = 'mkdir gone && cd gone && rmdir ../gone && exec "$@"'
    done = subprocess.run(["sh", "-c", in_no_folder, "sh", os.environ["PALPATE"], *map(str, replay[:5]), "../hand.csv", "--output", "a"],
                          cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 5 and done.stderr.startswith("palpate: a: cannot be written"), done.stderr


# What to do instead -----------------------------------------------------------------------------------------


def test_messages_say_what_to_do(tmp_path):
    for name in ("a.hdr", "b.img"):
        (tmp_path / name).write_bytes(bytes(348))
        refused(tmp_path / name, "save the pair as one .nii file")
    tifffile.imwrite(tmp_path / "a.tif", ramp("f4")[:1], photometric="minisblack")
    data = bytearray((tmp_path / "a.tif").read_bytes())
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        struct.pack_into("<H", data, file.pages[0].tags["BitsPerSample"].valueoffset, 24)
    (tmp_path / "a.tif").write_bytes(data)
    refused(tmp_path / "a.tif", "24 bits", "as 32-bit float")


def test_a_space_of_absurd_dimensions_is_refused(tmp_path):
    path = tmp_path / "a.nrrd"
    path.write_bytes(b"NRRD0005\ntype: uint8\ndimension: 3\nspace dimension: 2000000000\nsizes: 2 2 2\nencoding: raw\n\n" + bytes(8))
    refused(path, "beyond 8")
