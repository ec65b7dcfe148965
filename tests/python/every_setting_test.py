"""Each number of the table of settings (settings.hpp) is wherever settings are shown, kept or changed. So a number that is added
to the table has to be there, too. The panel and session files have tests of their own, which walk the same table:
Forces.each_number_in_the_tables_has_a_row_with_words_of_its_own, SettingsTable.recordings_and_session_files_have_every_setting."""

import ast
import ctypes
import itertools
import json
import os
import pathlib
import subprocess

import pytest

import palpate

SOURCE, BUILD = (pathlib.Path(os.environ[name]) for name in ("PALPATE_SOURCE", "PALPATE_BUILD"))
CLASSES = {"force": palpate.ForceSettings, "force.magnet": palpate.Magnet, "force.texture": palpate.Texture,
           "friction": palpate.Friction, "limits": palpate.DeviceLimits}
WITHOUT_OPTION = {"force.stale_after", "force.torque_rate_limit"}
PAIRS = {"force.magnet": "--magnet", "force.texture": "--texture", "friction": "--friction"}
IN_FILES = {"static_coefficient": "static", "dynamic_coefficient": "dynamic", "limits": "device"}


class Setting(ctypes.Structure):
    _fields_ = [("size_of", ctypes.c_uint32), ("open", ctypes.c_int32), ("name", ctypes.c_char_p),
                ("unit", ctypes.c_char_p), ("about", ctypes.c_char_p), ("least", ctypes.c_double),
                ("most", ctypes.c_double), ("usual", ctypes.c_double)]


def table():
    library = ctypes.CDLL(next((BUILD / "lib").glob("libpalpate-c.so*")))
    library.palpate_setting_count.restype = ctypes.c_size_t
    for index in range(library.palpate_setting_count()):
        one = Setting(ctypes.sizeof(Setting))
        assert library.palpate_setting_describe(ctypes.c_size_t(index), ctypes.byref(one)) == 0
        yield one.name.decode(), one.unit.decode(), one.about.decode()


TABLE = list(table())
NAMES = [name for name, _, _ in TABLE]


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """The settings that `palpate touch --json` and `palpate replay --json` report."""
    folder, ball = tmp_path_factory.mktemp("reported"), "synthetic:sphere:16x16x16"
    (folder / "hand.csv").write_text("t,x,y,z\n0,0,0,9\n1,0,0,8\n", encoding="utf-8")
    calls = (["touch", ball, "--unpaced", "--seconds", "0.1"], ["replay", ball, "--trajectory", "hand.csv", "-o", "trace.csv"])
    return [json.loads(subprocess.run([os.environ["PALPATE"], *call, "--json"], check=True, text=True, cwd=folder,
                                      stdout=subprocess.PIPE).stdout)["settings"] for call in calls]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The settings at the head of a recording. Session files have the same."""
    path = tmp_path_factory.mktemp("recorded") / "run.csv"
    volume = palpate.scene("sphere:16x16x16").volume
    with palpate.Run(volume, palpate.Setup(isovalue="50%", real_time=False)) as run:
        run.record(path)
    run.stop_recording()
    lines = path.read_text(encoding="utf-8").splitlines()[1:]
    head = itertools.takewhile(lambda line: line.startswith("#"), lines)
    return json.loads("\n".join(line[1:] for line in head))["settings"]


def compact(text):
    return "".join(text.split())


HELP = compact(subprocess.run([os.environ["PALPATE"], "touch", "--help"], check=True, text=True,
                              stdout=subprocess.PIPE).stdout)
HEADER = (SOURCE / "include/palpate-c/palpate.h").read_text(encoding="utf-8")
TYPES = {node.name: {part.target.id for part in node.body if isinstance(part, ast.AnnAssign)}
         for node in ast.parse(pathlib.Path(palpate.__file__).with_suffix(".pyi").read_text("utf-8")).body
         if isinstance(node, ast.ClassDef)}


def test_the_numbers_of_python_are_those_of_the_table():
    numbers = [f"{group}.{field}" for group, kind in CLASSES.items() for field in kind._fields
               if not hasattr(type(getattr(kind(), field)), "_fields")]
    assert sorted(numbers) == sorted(NAMES) and len(NAMES) > 20


@pytest.mark.parametrize("name, unit, about", TABLE, ids=NAMES)
def test_each_setting_is_in(name, unit, about, recorded, reported):
    group, _, member = name.rpartition(".")
    kind = CLASSES[group]
    assert about in vars(kind)[member].__doc__ and (not unit or f"[{unit}]" in vars(kind)[member].__doc__)
    assert member in TYPES[kind.__name__]
    assert f"`{name}`" in HEADER
    for value in (recorded, *reported):
        for part in name.split("."):
            value = value[IN_FILES.get(part, part)]
        assert isinstance(float(value), float)
    if group in PAIRS:
        assert PAIRS[group] + member.split("_")[0].upper() in HELP or f",{member.split('_')[0].upper()}" in HELP
    elif group == "force":  # those of limits are the device's
        assert (compact(f"{about}[{unit}]") in HELP) != (name in WITHOUT_OPTION)
